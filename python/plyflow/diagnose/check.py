"""Drive a UMAT, compare its DDSDDE with differences along the path, and say which mistake fits."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from plyflow.diagnose.case import Case, IncrementStart
from plyflow.diagnose.mistakes import Point, catalogue, difference
from plyflow.diagnose.slopes import certainly_wrong
from plyflow.diagnose.wanted import advice
from plyflow.driver.drive import DriverError, History, run_case_file
from plyflow.errors import InputError
from plyflow.umat.library import UmatLibrary

Array = NDArray[np.float64]
RIGHT = 1e-5  # differences of a smooth stress agree to about 1e-8 of the largest component
FITS = 1e-2
CLEARLY_BETTER = 20.0
AS_GOOD = 3.0
MOST_CHECKS = 40
COMPONENTS = ("11", "22", "33", "12", "13", "23")


@dataclass(frozen=True)
class TangentPoint:
    """One increment checked: its row in the history, time in s at its end, difference, largest at (row, column)."""

    row: int
    time: float
    difference: float
    entry: tuple[str, str]
    given: float
    right: float
    point: Point


@dataclass(frozen=True)
class Diagnosis:
    """What the comparison says.

    Parameters
    ----------
    history : of the whole programme.
    points : increments checked; differences are relative to the largest component of the right tangent.
    right : whether DDSDDE is the right tangent in all of them.
    mistakes : sentences of the mistakes that fit, best first; none if it is right or nothing known fits.
    fit : difference that is left with the best of them.
    undecided : increments left out of `points` because the stress has two slopes there (see `plyflow.diagnose.slopes`).
    """

    history: History
    points: Sequence[TangentPoint]
    right: bool
    mistakes: Sequence[str]
    fit: float | None
    undecided: int = 0

    @property
    def worst(self) -> TangentPoint:
        """The increment that differs most."""
        return max(self.points, key=lambda point: point.difference)

    def as_dict(self) -> dict[str, Any]:
        """Plain data, ready for JSON."""
        worst = self.worst
        return {
            "completed": self.history.completed,
            "message": self.history.message,
            "increments": self.history.increments,
            "iterations": self.history.total_iterations,
            "cutbacks": self.history.cutbacks,
            "increments_checked": len(self.points),
            "increments_undecided": self.undecided,
            "tangent_right": self.right,
            "largest_difference": worst.difference,
            "at_time_s": worst.time,
            "component": list(worst.entry),
            "ddsdde_MPa": worst.given,
            "by_differences_MPa": worst.right,
            "mistakes": list(self.mistakes),
            "difference_left": self.fit,
        }


def diagnose(library: UmatLibrary, case: Case) -> Diagnosis:
    """Run a case with a UMAT and judge its DDSDDE.

    Raises
    ------
    InputError
        The case cannot be run, or no increment of it could be checked.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        history = _run_case(folder, library, case)
        checked = [point for point in (_check(folder, library, case, history, row) for row in _rows(history)) if point]
        points, mistakes, fit = _judged(folder, library, case, history, checked)
        if not points:
            raise InputError(_why_none(folder, library, case, history))
    right = all(point.difference <= RIGHT for point in points)
    return Diagnosis(history, points, right, mistakes, fit, len(checked) - len(points))


def _why_none(folder: Path, library: UmatLibrary, case: Case, history: History) -> str:
    """Why no increment could be checked."""
    said = advice(history.message, case, lambda other: _run_case(folder, library, other).message)
    if said:
        return said
    text = (
        f"no increment could be checked: either none was accepted ({history.message or 'the case has none'}), or no two "
        "steps of the differences agree, or the stress has two slopes everywhere"
    )
    if case.from_file:
        return text
    return f"{text}; if the UMAT takes constants or state variables, give them with --props and --n-statev"


def _run_case(folder: Path, library: UmatLibrary, case: Case) -> History:
    """The whole case; what the driver refuses is named by its place in the user's file."""
    path = folder / "case.txt"
    try:
        return _run(path, case.text(library.path))
    except DriverError as error:
        where = re.compile(re.escape(str(path)) + r"(?::(\d+))?")
        raise DriverError(where.sub(lambda found: case.place(int(found[1] or 0)), str(error))) from None


def _judged(
    folder: Path, library: UmatLibrary, case: Case, history: History, points: Sequence[TangentPoint]
) -> tuple[Sequence[TangentPoint], Sequence[str], float | None]:
    """Points without those that differences cannot decide; the mistakes that fit and what the best of them leaves."""
    worst = max((point.difference for point in points), default=0.0)
    if worst <= RIGHT:
        return points, (), None
    mistakes, fit = fitting_mistakes([point.point for point in points], worst)
    if mistakes:
        return points, mistakes, fit
    certain = [p for p in points if p.difference <= RIGHT or _certain(folder, library, case, history, p)]
    return certain, (), None


def _certain(folder: Path, library: UmatLibrary, case: Case, history: History, checked: TangentPoint) -> bool:
    """Whether DDSDDE is wrong by one-sided differences too."""
    start, end = _start(history, checked.row)

    def stress_at(gradient: Array) -> Array | None:
        single = _run(folder / "moved.txt", case.increment_text(library.path, start, gradient))
        return np.asarray(single.stress[-1]) if single.completed else None

    increment = float(np.abs(end @ np.linalg.inv(start.deformation_gradient) - np.eye(3)).max())
    return certainly_wrong(checked.point, stress_at, increment, RIGHT)


def _run(path: Path, text: str) -> History:
    path.write_text(text, encoding="utf-8")
    return run_case_file(path)


def _rows(history: History) -> list[int]:
    """Rows of the increments to check: all, or about `MOST_CHECKS` evenly spread, and one that failed at the end."""
    rows = list(range(1, history.increments + 1))
    step = max(1, -(-len(rows) // MOST_CHECKS))
    chosen = rows[step - 1 :: step]
    return chosen + ([history.increments + 1] if history.failure is not None else [])


def _check(folder: Path, library: UmatLibrary, case: Case, history: History, row: int) -> TangentPoint | None:
    start, end = _start(history, row)
    single = _run(folder / "increment.txt", case.increment_text(library.path, start, end))
    check = single.tangent_check
    if check is None:
        return None
    i, j = check.entry
    point = Point(end, single.stress[-1], check.numerical, check.ddsdde)
    return TangentPoint(
        row=row,
        time=start.total_time + start.size,
        difference=check.difference,
        entry=(COMPONENTS[i], COMPONENTS[j]),
        given=float(check.ddsdde[i, j]),
        right=float(check.numerical[i, j]),
        point=point,
    )


def _start(history: History, row: int) -> tuple[IncrementStart, Array]:
    failure = history.failure
    if failure is not None and row > history.increments:
        start = IncrementStart(
            failure.deformation_gradient_start,
            failure.stress,
            failure.strain,
            failure.energies,
            failure.statev,
            failure.step_time,
            failure.total_time,
            failure.step,
            failure.increment,
            failure.increment_size,
        )
        return start, failure.deformation_gradient_end
    same_step = history.step[row] == history.step[row - 1]
    start = IncrementStart(
        history.deformation_gradient[row - 1],
        history.stress[row - 1],
        history.strain[row - 1],
        history.energies[row - 1],
        history.statev[row - 1],
        float(history.step_time[row - 1]) if same_step else 0.0,
        float(history.time[row - 1]),
        int(history.step[row]),
        int(history.increment_number[row]) - 1,
        float(history.increment[row]),
    )
    return start, history.deformation_gradient[row]


def fitting_mistakes(points: Sequence[Point], as_given: float) -> tuple[list[str], float | None]:
    """Sentences of the mistakes that explain DDSDDE in all points, best first, and what the best leaves.

    Several are named when they cannot be told apart by these points.
    """
    ranked = sorted(
        (max(difference(mistake.tangent(point), point.given) for point in points), number, mistake.sentence)
        for number, mistake in enumerate(catalogue())
    )
    best = ranked[0][0]
    if best > FITS or best * CLEARLY_BETTER > as_given:
        return [], None
    as_good = [sentence for left, _, sentence in ranked if left <= max(AS_GOOD * best, RIGHT)]
    simplest = min(sentence.count("; and ") for sentence in as_good)
    return [sentence for sentence in as_good if sentence.count("; and ") == simplest], best
