"""Histories of many cases of the one-dimensional law as one table, with the comparison laws beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from plyflow.case.case import Case
from plyflow.case.solution import final_law, laws_of, left_to_limit, solve
from plyflow.law import LawHistory, LawParameters, LoadProgramme
from plyflow.law.comparison import PowerSqueeze, matched
from plyflow.provenance import package_version

FloatArray = NDArray[np.float64]
MATCH_FRACTION = 0.2
MOST_CORNERS = 2000
COMPARISON = {"rogers": "Rogers (1989), Newtonian", "wang_gutowski": "Wang and Gutowski (1991), n = a + 1"}


@dataclass(frozen=True)
class CaseHistory:
    """One case over t times: its law (at the end of a cycle) and solution; comparison laws by name, met at match_time [s].

    left (t,) [s]: how long from each moment to within 1 % of the limit thickness; see `plyflow.law.time_left`.
    """

    case: Case
    law: LawParameters
    solution: LawHistory
    comparison: Mapping[str, PowerSqueeze]
    match_time: float
    left: FloatArray

    @property
    def stack(self) -> float:
        """Thickness [mm] of the whole specimen before the test."""
        return self.case.blocks * self.law.h0

    def assumption_lines(self) -> list[str]:
        """List what the history rests on, one sentence each: the case, and how its load was read."""
        return [*self.case.law_assumptions(), *self.case.load_programme.notes]

    def table(self) -> pd.DataFrame:
        """Time [s], pressure [MPa], ratios [-], thickness of the specimen and width [mm], fibre fraction, stage."""
        solution = self.solution
        columns: dict[str, Any] = {
            "time_s": solution.time,
            "pressure_MPa": solution.pressure,
            "eps": solution.eps,
            "thickness_ratio": solution.thickness_ratio,
            "thickness_mm": self.stack * solution.thickness_ratio,
            "width_ratio": solution.width_ratio,
            "width_mm": self.law.w0 * solution.width_ratio,
            "fibre_fraction": solution.fibre_fraction,
            "stage": np.where(solution.locked, "bleed", "squeeze"),
            "time_left_s": np.where(np.isfinite(self.left), self.left, np.nan),
        }
        if self.case.is_cycle:
            columns |= {"temperature_degC": self.temperatures, "thickness_ratio_limit": self.limits()}
        for name, law in self.comparison.items():
            columns[f"thickness_ratio_{name}"] = np.exp(law.eps(self.case.load_programme, solution.time))
        return pd.DataFrame(columns)

    @property
    def temperatures(self) -> FloatArray:
        """Temperature (t,) [degC] of a cycle."""
        return self.case.load_programme.temperature(self.solution.time)

    def limits(self) -> FloatArray:
        """h/h0 (t,) at the compaction limit of the moment, in a cycle."""
        return np.asarray(np.exp(laws_of([self.case])(self.temperatures).eps_limit[0]), dtype=float)

    def summary(self) -> dict[str, Any]:
        """Plain data of the case at the end of the load, ready for JSON."""
        case, solution, load = self.case, self.solution, self.case.load_programme
        return {
            "material": case.material,
            "temperature": case.temperature,
            "layup": case.layup,
            "width": case.width,
            "thickness_ratio_final": float(solution.thickness_ratio[-1]),
            "thickness_final_mm": self.stack * float(solution.thickness_ratio[-1]),
            "thickness_ratio_limit": float(np.exp(self.law.eps_limit)),
            "width_ratio_final": float(solution.width_ratio[-1]),
            "fibre_fraction_final": float(solution.fibre_fraction[-1]),
            "stage_final": "bleed" if solution.locked[-1] else "squeeze",
            "lock_time": solution.lock_time,
            "time_left_s": float(self.left[-1]) if np.isfinite(self.left[-1]) else None,
            "limit_passed_at": solution.still_time,
            "temperature_range": self.case.temperature_range,
            "match_time": self.match_time,
            "constants": vars(self.law) | {"eps_limit": self.law.eps_limit},
            "comparison": {
                name: {
                    "law": COMPARISON[name],
                    "n": law.n,
                    "log_viscosity": law.log_viscosity,
                    "thickness_ratio_final": float(np.exp(law.eps(load, [load.end])[0])),
                }
                for name, law in self.comparison.items()
            },
            "assumptions": self.assumption_lines(),
            "plyflow_version": package_version(),
        }


def default_times(load: LoadProgramme, every: float | None = None) -> FloatArray:
    """Times [s] of a history: each `every` seconds, else 601 equal steps; with the load's corners and its end."""
    spaced = np.linspace(0.0, load.end, 601) if every is None else np.arange(0.0, load.end, every)
    corners = load.times if len(load.times) <= MOST_CORNERS and every is None else (load.end,)
    return np.unique(np.concatenate([spaced, corners]))


def histories(cases: Sequence[Case], every: float | None = None, match_time: float | None = None) -> list[CaseHistory]:
    """Integrate many cases, all of one load at once.

    Parameters
    ----------
    cases : sequence of Case
        In the order wanted.
    every : float, optional
        Spacing of the history [s]; see `default_times`.
    match_time : float, optional
        Time [s] at which the comparison laws have the model's thickness; default a fifth of the programme, the end of
        the first level of the ramp-dwell test.

    Raises
    ------
    InputError
        A case cannot be set up, or nothing has moved at the time to match.
    """
    laws = [final_law(case, case.load_programme) for case in cases]
    groups: dict[tuple[str, float], list[int]] = {}
    for place, case in enumerate(cases):
        groups.setdefault((case.load, case.width), []).append(place)
    found: dict[int, CaseHistory] = {}
    for places in groups.values():
        load = cases[places[0]].load_programme
        together = [cases[place] for place in places]
        solution = solve(together, load, default_times(load, every))
        meeting = MATCH_FRACTION * load.end if match_time is None else match_time
        compared = load.peak > 0.0 and not load.temperatures
        met = solve(together, load, np.array([meeting])).eps[:, 0] if compared else np.zeros(len(places))
        for row, place in enumerate(places):
            own, law = solution.row(row), laws[place]
            comparison = _comparison(law, load, meeting, float(met[row])) if compared else {}
            left = left_to_limit(cases[place], load, own)
            found[place] = CaseHistory(cases[place], law, own, comparison, meeting, left)
    return [found[place] for place in range(len(cases))]


def _comparison(law: LawParameters, load: LoadProgramme, time: float, eps: float) -> dict[str, PowerSqueeze]:
    exponents = {"rogers": 1.0, "wang_gutowski": law.a + 1.0}
    return {name: matched(law, n, load, time, eps) for name, n in exponents.items()}
