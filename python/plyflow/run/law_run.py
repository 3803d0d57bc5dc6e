"""Histories of many cases of the one-dimensional law as one table, with the comparison laws beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from plyflow.case.assumptions import assume
from plyflow.case.law_case import LawCase
from plyflow.law import LawParameters, LoadProgramme
from plyflow.law.batch import batch
from plyflow.law.comparison import PowerSqueeze, matched
from plyflow.law.integration import BatchHistory, integrate_batch
from plyflow.provenance import package_version

FloatArray = NDArray[np.float64]
MATCH_FRACTION = 0.2
MOST_CORNERS = 2000
COMPARISON = {"rogers": "Rogers (1989), Newtonian", "wang_gutowski": "Wang and Gutowski (1991), n = a + 1"}


@dataclass(frozen=True)
class CaseHistory:
    """One case over t times: its law, load and rows of the solution; comparison laws by name, met at match_time [s]."""

    case: LawCase
    law: LawParameters
    load: LoadProgramme
    solution: BatchHistory
    row: int
    comparison: Mapping[str, PowerSqueeze]
    match_time: float

    def assumption_lines(self) -> list[str]:
        """List what the history rests on, one sentence each: the case, and how its load was read."""
        return [*self.case.assumption_lines(), *self.load.notes]

    def table(self) -> pd.DataFrame:
        """Time [s], pressure [MPa], ratios [-], thickness of the specimen and width [mm], fibre fraction, stage."""
        solution, row = self.solution, self.row
        stack = self.case.stack_thickness(self.law.h0)
        columns: dict[str, Any] = {
            "time_s": solution.time,
            "pressure_MPa": solution.pressure,
            "eps": solution.eps[row],
            "thickness_ratio": solution.thickness_ratio[row],
            "thickness_mm": stack * solution.thickness_ratio[row],
            "width_ratio": solution.width_ratio[row],
            "width_mm": self.law.w0 * solution.width_ratio[row],
            "fibre_fraction": solution.fibre_fraction[row],
            "stage": np.where(solution.locked[row], "bleed", "squeeze"),
        }
        for name, law in self.comparison.items():
            columns[f"thickness_ratio_{name}"] = np.exp(law.eps(self.load, solution.time))
        return pd.DataFrame(columns)

    def summary(self) -> dict[str, Any]:
        """Plain data of the case at the end of the load, ready for JSON."""
        solution, row = self.solution, self.row
        lock = float(solution.lock_time[row])
        return {
            "material": self.case.material,
            "temperature": self.case.temperature,
            "layup": self.case.layup,
            "width": self.case.width,
            "thickness_ratio_final": float(solution.thickness_ratio[row, -1]),
            "thickness_final_mm": self.case.stack_thickness(self.law.h0) * float(solution.thickness_ratio[row, -1]),
            "thickness_ratio_limit": float(np.exp(self.law.eps_limit)),
            "width_ratio_final": float(solution.width_ratio[row, -1]),
            "fibre_fraction_final": float(solution.fibre_fraction[row, -1]),
            "stage_final": "bleed" if solution.locked[row, -1] else "squeeze",
            "lock_time": None if np.isnan(lock) else lock,
            "match_time": self.match_time,
            "constants": vars(self.law) | {"eps_limit": self.law.eps_limit},
            "comparison": {
                name: {
                    "law": COMPARISON[name],
                    "n": law.n,
                    "log_viscosity": law.log_viscosity,
                    "thickness_ratio_final": float(np.exp(law.eps(self.load, [self.load.end])[0])),
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


def histories(
    cases: Sequence[LawCase],
    loads: Mapping[float, LoadProgramme],
    every: float | None = None,
    match_time: float | None = None,
) -> list[CaseHistory]:
    """Integrate many cases, all of one width at once.

    Parameters
    ----------
    cases : sequence of LawCase
        In the order wanted.
    loads : mapping
        Load programme by width [mm].
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
    found: dict[int, CaseHistory] = {}
    for width, load in loads.items():
        places = [place for place, case in enumerate(cases) if case.width == width]
        if not places:
            continue
        times = default_times(load, every)
        group = batch([laws[place] for place in places])
        fractions = [assume(cases[place].settings)["fibre_fraction_initial"].value for place in places]
        solution = integrate_batch(group, load, times, np.array(fractions))
        meeting = MATCH_FRACTION * load.end if match_time is None else match_time
        met = integrate_batch(group, load, [meeting]).eps[:, 0] if load.peak > 0.0 else np.zeros(len(places))
        for row, place in enumerate(places):
            law = laws[place]
            comparison = _comparison(law, load, meeting, float(met[row])) if load.peak > 0.0 else {}
            found[place] = CaseHistory(cases[place], law, load, solution, row, comparison, meeting)
    return [found[place] for place in range(len(cases))]


def _comparison(law: LawParameters, load: LoadProgramme, time: float, eps: float) -> dict[str, PowerSqueeze]:
    exponents = {"rogers": 1.0, "wang_gutowski": law.a + 1.0}
    return {name: matched(law, n, load, time, eps) for name, n in exponents.items()}
