"""The invariants as printed (I1, I3) beside the transverse form: where the one has no real value, the other has."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from plyflow.case.case import driver_steps
from plyflow.driver.drive import drive
from plyflow.evidence.stability.cells import Check, Detail, Outcome
from plyflow.evidence.stability.subject import Column, Subject
from plyflow.evidence.stability.tensors import Array, rotation
from plyflow.run.case_run import case_controls
from plyflow.umat.library import CallResult


def _kind(answer: CallResult) -> str:
    if answer.messages:
        return "refused"
    finite = np.isfinite(answer.stress).all() and np.isfinite(answer.ddsdde).all()
    return "answered" if finite else "NaN"


def _compare(check: Check, subject: Subject, increments: Iterable[tuple[Array, Array]]) -> Outcome:
    """Both forms; the printed one is not entered in the account, because it is here to fail."""
    values, library = subject.values(subject.columns[0]), subject.scene("printed")[0]
    kinds, apart = [], 0.0
    for ends in increments:
        printed = library.call(*ends, 1.0, subject.props(values), subject.statev(scene="printed"))
        transverse = subject.call(*ends, 1.0, values)
        kinds.append((_kind(printed), _kind(transverse)))
        if kinds[-1] == ("answered", "answered"):
            size = np.abs(transverse.stress).max()
            apart = max(apart, float(np.abs(printed.stress - transverse.stress).max() / size))
    forms = [printed_kind for printed_kind, _ in kinds]
    counts: dict[str, Detail] = {f"printed_{kind}": forms.count(kind) for kind in ("refused", "NaN", "answered")}
    if counts["printed_answered"] == len(kinds):
        return check.fail("the printed form answered everywhere: the comparison shows nothing", **counts)
    return check.judge(sum(kind != "answered" for _, kind in kinds), **counts, largest_difference=apart)


def swollen(check: Check, subject: Subject) -> Outcome:
    """Equal stretches: (I1 - 1)^2 - 4 I3 is -3 d^2 to leading order."""
    sizes = np.geomspace(1e-8, 0.1, 15)
    ends = [(np.eye(3) * np.sqrt(1.0 + size), np.eye(3) * np.sqrt(1.0 + 1.001 * size)) for size in sizes]
    return _compare(check, subject, ends)


def general(check: Check, subject: Subject) -> Outcome:
    """Small strains in any direction, with rotations, on a ply that was at rest."""
    rng, ends = subject.generator(3), []
    for size in np.geomspace(1e-6, 1e-2, 50 if subject.quick else 200):
        turn = rotation(int(rng.integers(3)), float(rng.uniform(0, 360)))
        ends.append((turn, turn @ (np.eye(3) + size * rng.uniform(-1.0, 1.0, (3, 3)))))
    return _compare(check, subject, ends)


def first_increment(check: Check, subject: Subject, column: Column) -> Outcome:
    """The same programme on both forms."""
    case, values = column.case(), subject.values(column)
    (library, manifest), steps = subject.scene("printed"), driver_steps(case.load_programme)
    printed = drive(library, subject.props(values), len(manifest["statev"]), steps, case_controls())
    unfinished = int(not subject.drive_case(case, values).history.completed)
    if printed.completed:
        return check.fail("the printed form ended: the comparison shows nothing")
    return check.judge(unfinished, f"printed form: {printed.message}", printed_increments=printed.increments)
