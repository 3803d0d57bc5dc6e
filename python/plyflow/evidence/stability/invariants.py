"""The invariants as printed (I1, I3) beside the transverse form: where the one has no real value, the other has."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from plyflow.case.case import Case, driver_steps
from plyflow.driver.drive import History, drive
from plyflow.evidence.stability.bench import Bench, Column, statev_at_start
from plyflow.evidence.stability.cells import WHOLE, Check, Detail, Outcome, Task
from plyflow.evidence.stability.tensors import Array, rotation
from plyflow.run.case_run import case_controls
from plyflow.umat.library import CallResult

GROUP = "Printed invariants (Eqs. 13-14 in I1, I3)"
SWOLLEN = Check(
    GROUP,
    "C = (1 + d) I, d from 1e-8 to 0.1: printed form refused, transverse form answers",
    "states the transverse form does not answer",
    0,
)
GENERAL = Check(
    GROUP,
    "random strains of 1e-6 to 1e-2 about F = I: printed form refused or NaN in part, transverse form answers",
    "states the transverse form does not answer",
    0,
)
FIRST = Check(
    GROUP,
    "ramp-dwell programme: printed form stops in the first increment, transverse form ends",
    "programmes the transverse form does not end",
    0,
)


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    yield Task(SWOLLEN, WHOLE, partial(swollen, bench))
    yield Task(GENERAL, WHOLE, partial(general, bench))
    for column in bench.columns:
        yield Task(FIRST, column.label, partial(first_increment, bench, column))


def _printed(bench: Bench, ends: tuple[Array, Array], values: dict[str, float]) -> CallResult:
    """Answer of the printed form; not entered in the account, because it is here to fail."""
    library = bench.scene("printed").library
    return library.call(*ends, 1.0, bench.props(values), statev_at_start(False))


def _kind(answer: CallResult) -> str:
    if answer.messages:
        return "refused"
    finite = np.isfinite(answer.stress).all() and np.isfinite(answer.ddsdde).all()
    return "answered" if finite else "NaN"


def _apart(printed: CallResult, transverse: CallResult) -> float:
    """Difference of two stresses, relative; 0 where one of the forms gives none."""
    if _kind(printed) != "answered" or _kind(transverse) != "answered":
        return 0.0
    return float(np.abs(printed.stress - transverse.stress).max() / np.abs(transverse.stress).max())


def _compare(bench: Bench, check: Check, cases: list[tuple[Array, Array]], values: dict[str, float]) -> Outcome:
    pairs = [(_printed(bench, ends, values), bench.call(*ends, 1.0, values)) for ends in cases]
    printed = [_kind(one) for one, _ in pairs]
    unanswered = sum(_kind(transverse) != "answered" for _, transverse in pairs)
    counts: dict[str, Detail] = {f"printed_{kind}": printed.count(kind) for kind in ("refused", "NaN", "answered")}
    if counts["printed_answered"] == len(cases):
        return check.fail("the printed form answered everywhere: the comparison shows nothing", **counts)
    return check.judge(unanswered, **counts, largest_difference=max(_apart(*pair) for pair in pairs))


def swollen(bench: Bench) -> Outcome:
    """Equal stretches: (I1 - 1)^2 - 4 I3 is -3 d^2 to leading order."""
    values = bench.values(bench.columns[0])
    sizes = np.geomspace(1e-8, 0.1, 15)
    cases = [(np.eye(3) * np.sqrt(1.0 + size), np.eye(3) * np.sqrt(1.0 + 1.001 * size)) for size in sizes]
    return _compare(bench, SWOLLEN, cases, values)


def general(bench: Bench) -> Outcome:
    """Small strains in any direction, with rotations, on a ply that was at rest."""
    rng, values, cases = bench.generator(3), bench.values(bench.columns[0]), []
    for size in np.geomspace(1e-6, 1e-2, 50 if bench.quick else 200):
        turn = rotation(int(rng.integers(3)), float(rng.uniform(0, 360)))
        cases.append((turn, turn @ (np.eye(3) + size * rng.uniform(-1.0, 1.0, (3, 3)))))
    return _compare(bench, GENERAL, cases, values)


def first_increment(bench: Bench, column: Column) -> Outcome:
    """The same programme on both forms."""
    case = Case(column.material, column.temperature, "BP", 15.0)
    values, steps = bench.values(column), driver_steps(case.load_programme)
    printed: History = drive(bench.scene("printed").library, bench.props(values), 8, steps, case_controls())
    transverse = bench.drive(values, steps, case_controls())
    if printed.completed:
        return FIRST.fail("the printed form ended: the comparison shows nothing")
    unfinished = int(not transverse.completed)
    return FIRST.judge(unfinished, f"printed form: {printed.message}", printed_increments=printed.increments)
