"""Drive a UMAT, compare its DDSDDE with differences along the path, and say which mistake fits."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from plyflow.diagnose.case import Case, props_lines
from plyflow.diagnose.mistakes import COMPONENTS, RIGHT, Point, fitting_mistakes
from plyflow.diagnose.slopes import certainly_wrong
from plyflow.driver.drive import DriverError, FailedIncrement, History, run_case_file
from plyflow.errors import InputError
from plyflow.umat.library import UmatLibrary

Array = NDArray[np.float64]
MOST_CHECKS = 40
_REFUSED = re.compile(r"(NPROPS|NSTATV) value\s+(\S+), bound\s+([^\s,;]+)")
# By the UMAT's argument: what it counts, and how a case file and the command line say it.
_COUNTS = {
    "NPROPS": ("constants", "{} numbers in props", "--props with {} numbers"),
    "NSTATV": ("state variables", "n_statev = {}", "--n-statev {}"),
}


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


def diagnose(library: UmatLibrary, case: Case) -> Diagnosis:
    """Run a case with a UMAT and judge its DDSDDE.

    Raises
    ------
    InputError
        The case cannot be run, or no increment of it could be checked.
    """
    with tempfile.TemporaryDirectory() as folder:
        runs = _Runs(Path(folder) / "case.txt", library.path, case)
        history = runs.whole(case)
        checked = [point for row in _rows(history) if (point := runs.check(history, row))]
        worst = max((point.difference for point in checked), default=0.0)
        mistakes, fit = fitting_mistakes([p.point for p in checked], worst) if worst > RIGHT else ([], None)
        points = checked
        if not mistakes:
            points = [p for p in checked if p.difference <= RIGHT or runs.is_certain(history, p)]
        if not points:
            raise InputError(runs.why_none(history.message))
    right = all(point.difference <= RIGHT for point in points)
    return Diagnosis(history, points, right, mistakes, fit, len(checked) - len(points))


def _rows(history: History) -> list[int]:
    """Rows of the increments to check: all, or about `MOST_CHECKS` evenly spread, and one that failed at the end."""
    rows = list(range(1, history.increments + 1))
    step = max(1, -(-len(rows) // MOST_CHECKS))
    return rows[step - 1 :: step] + ([history.increments + 1] if history.failure is not None else [])


def _increment(history: History, row: int) -> FailedIncrement:
    """One increment from the state at its start, accepted or not."""
    if row > history.increments and history.failure is not None:
        return history.failure
    before, same_step = row - 1, history.step[row] == history.step[row - 1]
    return FailedIncrement(
        deformation_gradient_start=history.deformation_gradient[before],
        deformation_gradient_end=history.deformation_gradient[row],
        stress=history.stress[before],
        strain=history.strain[before],
        statev=history.statev[before],
        energies=history.energies[before],
        step_time=float(history.step_time[before]) if same_step else 0.0,
        total_time=float(history.time[before]),
        increment_size=float(history.increment[row]),
        step=int(history.step[row]),
        increment=int(history.increment_number[row]) - 1,
        outcome="", props=np.zeros(0), temperature=0.0, temperature_increment=0.0, material_name="",
    )  # fmt: skip


@dataclass(frozen=True)
class _Runs:
    """Runs of a UMAT through a case, whole or one increment of it, by way of a file."""

    path: Path
    library: Path
    case: Case

    def whole(self, case: Case) -> History:
        """The whole case; what the driver refuses is named by its place in the user's file."""
        try:
            return self._run(case.text(self.library))
        except DriverError as error:
            where = re.compile(re.escape(str(self.path)) + r"(?::(\d+))?")
            raise DriverError(where.sub(lambda found: case.place(int(found[1] or 0)), str(error))) from None

    def _run(self, text: str) -> History:
        self.path.write_text(text, encoding="utf-8")
        return run_case_file(self.path)

    def check(self, history: History, row: int) -> TangentPoint | None:
        """DDSDDE beside differences at the end of an increment; None where no two steps of the differences agree."""
        increment = _increment(history, row)
        single = self._run(self.case.increment_text(self.library, increment))
        check = single.tangent_check
        if check is None:
            return None
        i, j = check.entry
        return TangentPoint(
            row=row,
            time=increment.total_time + increment.increment_size,
            difference=check.difference,
            entry=(COMPONENTS[i], COMPONENTS[j]),
            given=float(check.ddsdde[i, j]),
            right=float(check.numerical[i, j]),
            point=Point(increment.deformation_gradient_end, single.stress[-1], check.numerical, check.ddsdde),
        )

    def is_certain(self, history: History, checked: TangentPoint) -> bool:
        """Whether DDSDDE is wrong by one-sided differences too."""
        increment = _increment(history, checked.row)

        def stress_at(gradient: Array) -> Array | None:
            moved = replace(increment, deformation_gradient_end=gradient)
            single = self._run(self.case.increment_text(self.library, moved))
            return np.asarray(single.stress[-1]) if single.completed else None

        start, end = increment.deformation_gradient_start, increment.deformation_gradient_end
        size = float(np.abs(end @ np.linalg.inv(start) - np.eye(3)).max())
        return certainly_wrong(checked.point, stress_at, size, RIGHT)

    def why_none(self, message: str) -> str:
        """Why no increment could be checked; where the UMAT refused its counts, what it wants.

        A UMAT that refuses the number of constants says nothing yet of its state variables; it is asked again with so
        many zeros.
        """
        case, said = self.case, refused_counts(message)
        if "NPROPS" in said:
            others = [line for line in case.lines if not line.startswith("props")]
            zeros = props_lines([0.0] * said["NPROPS"][1])
            said |= refused_counts(self.whole(replace(case, lines=[*zeros, *others])).message)
        if said:
            wants = " and ".join(f"{wanted} {_COUNTS[name][0]} ({given} given)" for name, (given, wanted) in said.items())
            form = 1 if case.from_file else 2
            remedy = " and ".join(_COUNTS[name][form].format(wanted) for name, (_, wanted) in said.items())
            return f"the UMAT wants {wants}: give {remedy}" + (f" in {case.name}" if case.from_file else "")
        text = (
            f"no increment could be checked: either none was accepted ({message or 'the case has none'}), or no two "
            "steps of the differences agree, or the stress has two slopes everywhere"
        )
        if case.from_file:
            return text
        return f"{text}; if the UMAT takes constants or state variables, give them with --props and --n-statev"


def refused_counts(message: str) -> dict[str, tuple[int, int]]:
    """Given and wanted number by the UMAT's argument; none if the message names none."""
    try:
        return {name: (int(float(given)), int(float(wanted))) for name, given, wanted in _REFUSED.findall(message)}
    except (ValueError, OverflowError):
        return {}
