"""Histories of many cases of the one-dimensional law as one table, with the comparison laws beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from plyflow.case.case import Case
from plyflow.law import LawHistory, LawParameters, LoadProgramme, batch, integrate_batch
from plyflow.law.comparison import PowerSqueeze, matched
from plyflow.provenance import package_version

FloatArray = NDArray[np.float64]
MATCH_FRACTION = 0.2
MOST_CORNERS = 2000
COMPARISON = {"rogers": "Rogers (1989), Newtonian", "wang_gutowski": "Wang and Gutowski (1991), n = a + 1"}


@dataclass(frozen=True)
class CaseHistory:
    """One case over t times: its law and solution; comparison laws by name, met at match_time [s]."""

    case: Case
    law: LawParameters
    solution: LawHistory
    comparison: Mapping[str, PowerSqueeze]
    match_time: float

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
        }
        for name, law in self.comparison.items():
            columns[f"thickness_ratio_{name}"] = np.exp(law.eps(self.case.load_programme, solution.time))
        return pd.DataFrame(columns)

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
    laws = [case.law() for case in cases]
    groups: dict[tuple[str, float], list[int]] = {}
    for place, case in enumerate(cases):
        groups.setdefault((case.load, case.width), []).append(place)
    found: dict[int, CaseHistory] = {}
    for places in groups.values():
        load = cases[places[0]].load_programme
        group = batch([laws[place] for place in places])
        fractions = np.array([cases[place].fibre_fraction for place in places])
        solution = integrate_batch(group, load, default_times(load, every), fractions)
        meeting = MATCH_FRACTION * load.end if match_time is None else match_time
        met = integrate_batch(group, load, [meeting]).eps[:, 0] if load.peak > 0.0 else np.zeros(len(places))
        for row, place in enumerate(places):
            comparison = _comparison(laws[place], load, meeting, float(met[row])) if load.peak > 0.0 else {}
            found[place] = CaseHistory(cases[place], laws[place], solution.row(row), comparison, meeting)
    return [found[place] for place in range(len(cases))]


def _comparison(law: LawParameters, load: LoadProgramme, time: float, eps: float) -> dict[str, PowerSqueeze]:
    exponents = {"rogers": 1.0, "wang_gutowski": law.a + 1.0}
    return {name: matched(law, n, load, time, eps) for name, n in exponents.items()}
