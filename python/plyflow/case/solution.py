"""The one-dimensional law of cases under the load that they share, at one temperature or through a cycle."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from plyflow.case.case import Case
from plyflow.law import LawBatch, LawHistory, LawParameters, LoadProgramme, batch, integrate_batch
from plyflow.law.cycle import integrate_cycle
from plyflow.law.time_left import time_left

FloatArray = NDArray[np.float64]


def solve(cases: Sequence[Case], load: LoadProgramme, times: FloatArray | None = None) -> LawHistory:
    """Compaction of n cases under one load, at times (t,) [s] or its end; see `integrate_batch` and `integrate_cycle`.

    Raises
    ------
    InputError
        A case cannot be set up, or a time is outside the load.
    RunError
        A law could not be followed to the end.
    """
    fractions = np.array([case.fibre_fraction for case in cases])
    if not load.temperatures:
        return integrate_batch(batch([case.law() for case in cases]), load, times, fractions)
    return integrate_cycle(laws_of(cases), load, times, fractions)


def laws_of(cases: Sequence[Case]) -> Callable[[FloatArray], LawBatch]:
    """Constants (n, t) of n cases as a function of temperatures (t,) [degC]; each case and temperature once."""

    def laws_at(temperatures: FloatArray) -> LawBatch:
        once, places = np.unique(temperatures, return_inverse=True)
        found = [case.laws_at(once) for case in cases]
        return LawBatch(**{name: np.array([vars(one)[name] for one in found])[:, places] for name in vars(found[0])})

    return laws_at


def law_at(case: Case, temperature: float) -> LawParameters:
    """The law of a case at a temperature [degC]."""
    return LawParameters(**{name: float(values[0]) for name, values in vars(case.laws_at([temperature])).items()})


def final_law(case: Case, load: LoadProgramme) -> LawParameters:
    """The law of a case at the end of its load: of a cycle that of the last temperature."""
    return law_at(case, load.temperatures[-1]) if load.temperatures else case.law()


def left_to_limit(case: Case, load: LoadProgramme, solution: LawHistory) -> FloatArray:
    """Time (t,) [s] from each moment of a solution (t,) to within 1 % of the limit thickness; see `time_left`."""
    temperatures = load.temperature(solution.time) if load.temperatures else np.full(solution.time.size, case.temperature)
    laws = laws_of([case])(temperatures).each(lambda values: values[0])
    return time_left(laws, solution.eps, solution.locked, solution.pressure)
