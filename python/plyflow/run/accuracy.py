"""Increments for a wanted error: ever finer runs until two in a row, by the scheme's order, say that it is small enough."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from plyflow.errors import InputError, RunError

Result = TypeVar("Result")
BOUNDS = (1e-7, 0.1)  # of the wanted error; below the first the driver's own tolerance shows
MOST_INCREMENTS = 50_000  # of one run


@dataclass(frozen=True)
class Reached(Generic[Result]):
    """The finest run and what it took.

    wanted, estimate: error of the final thickness ratio from the increments [-], asked for and estimated; refinement: factor on
    the increments of `plyflow.run.case_run.case_controls`; runs, increments, umat_calls: in all, coarser runs included.
    """

    result: Result
    wanted: float
    estimate: float
    refinement: float
    runs: int
    increments: int
    umat_calls: int


def reach(
    wanted: float,
    order: int,
    coarsest: float,
    run: Callable[[float], Result],
    read: Callable[[Result], tuple[float, int, int]],
) -> Reached[Result]:
    """Halve the increments until the error of the final thickness is estimated to be at most `wanted`.

    Parameters
    ----------
    wanted : error [-], 1e-7 to 0.1.
    order : by which the error falls with the increments, see `estimated`.
    coarsest : refinement of the first run.
    run : the run at a refinement. One coarser than 1 may fail; the next finer one then starts anew.
    read : final thickness ratio [-], increments and UMAT calls of a result.

    Raises
    ------
    InputError
        The wanted error is outside its bounds.
    RunError
        The wanted error would take more than 50,000 increments; or a run failed.
    """
    low, high = BOUNDS
    if not low <= wanted <= high:
        raise InputError(f"accuracy {wanted:g} must lie between {low:g} and {high:g}: it is the error of the final thickness ratio")
    refinement, ends, spent = coarsest, list[float](), (0, 0, 0)
    while True:
        try:
            result = run(refinement)
        except RunError:
            if refinement >= 1.0:
                raise
            refinement, ends = 2.0 * refinement, []
            continue
        end, increments, calls = read(result)
        ends.append(end)
        spent = (spent[0] + 1, spent[1] + increments, spent[2] + calls)
        estimate = estimated(ends, order)
        if estimate <= wanted:
            return Reached(result, wanted, estimate, refinement, *spent)
        if 2 * increments > MOST_INCREMENTS:
            raise RunError(
                f"accuracy {wanted:g} is not reached with {increments} increments (estimated error {estimate:.1e}): ask for "
                "less, or take a scene with integrator 'creep'"
            )
        refinement *= 2.0


def estimated(ends: Sequence[float], order: int) -> float:
    """Error [-] of the last of some results, each with half the increments of the one before; infinite for fewer than two.

    The last difference d is what the error fell by. Falling on as the differences do, by a factor f from one to the next, it
    has d / (f - 1) to go. f is taken between 2 and 2^order, and 2 where it is not known: coarse runs need not show the order.
    """
    if len(ends) < 2:
        return math.inf
    last, before = (abs(later - earlier) for earlier, later in (ends[-2:], ends[-3:-1] if len(ends) > 2 else ends[-2:]))
    factor = min(max(before / last, 2.0), 2.0**order) if last > 0.0 else 2.0
    return last / (factor - 1.0)
