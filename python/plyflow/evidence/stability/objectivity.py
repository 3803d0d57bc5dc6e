"""Superposed rotations: stress and DDSDDE turn with the body, whatever the basis they are given in."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.rounding import measure_rounding
from plyflow.evidence.stability.states import STAGES, stage_increment
from plyflow.evidence.stability.subject import Column, Subject, Values
from plyflow.evidence.stability.tensors import EPSILON, Array, rotation, turned_stress, turned_tangent
from plyflow.umat.library import CallResult

MIXED = np.array([[1.0005, 0.06, -0.04], [0.02, 1.0, 0.08], [0.04, -0.02, 1.0]])


def turns(subject: Subject) -> Iterator[Array]:
    """Rotations about three axes: every 15 degrees (quick: 45), and three angles that are no fraction of a turn."""
    for axis in range(3):
        for angle in (*np.arange(0, 361, 45 if subject.quick else 15), 1e-6, 1.0, 123.456):
            yield rotation(axis, float(angle))


def turned_errors(still: CallResult, moved: CallResult, turn: Array) -> tuple[float, float]:
    """Differences of stress and tangent of a turned answer from those of the still one turned, relative."""
    stress = np.abs(moved.stress - turned_stress(still.stress, turn)).max() / np.abs(still.stress).max()
    tangent = np.abs(moved.ddsdde - turned_tangent(still.ddsdde, turn)).max() / np.abs(still.ddsdde).max()
    return float(stress), float(tangent)


def _sheared_increment(values: Values, locked: bool, isochoric: bool) -> tuple[Array, Array]:
    """Compaction with shears in all planes and some fibre stretch, so that no component vanishes."""
    start, end = stage_increment(values, locked, 3e-2)
    end = MIXED @ end
    if isochoric:
        start, end = (matrix / np.cbrt(np.linalg.det(matrix)) for matrix in (start, end))
    return start, end


def turned(check: Check, subject: Subject, column: Column, way: str) -> Outcome:
    """Difference between the turned answer and the answer to the turned increment."""
    stiff = way == "volume kept"  # Table 4 and kappa as shipped
    values = subject.values(column, **({} if stiff else {"kappa": 1.0, "E_L": 1.0}))
    worst, conditions, stress_error, tangent_error = 0.0, [], 0.0, 0.0
    for locked in STAGES.values():
        start, end = _sheared_increment(values, locked, stiff)
        rounding = measure_rounding(subject, start, end, 1.0, values, locked)
        conditions.append(rounding.condition)
        still = subject.call(start, end, 1.0, values, locked)
        for turn in turns(subject):
            moved = subject.call(
                start if way == "only the end turned" else turn @ start, turn @ end, 1.0, values, locked
            )
            errors = turned_errors(still, moved, turn)
            stress_error, tangent_error = max(stress_error, errors[0]), max(tangent_error, errors[1])
            worst = max(worst, max(errors) / (EPSILON * rounding.condition if stiff else 1.0))
        if not (stiff or rounding.well_conditioned):
            return check.fail(f"the state is conditioned worse than 1e3: {rounding.condition:.3g}", worst)
    return check.judge(worst, stress=stress_error, tangent=tangent_error, condition=max(conditions))


def rigid(check: Check, subject: Subject, column: Column) -> Outcome:
    """A body at rest but for a rotation: rounding in F must not pass for flow."""
    values, worst = subject.values(column, kappa=0.0), 0.0
    for locked in STAGES.values():
        _, end = _sheared_increment(values, locked, False)
        still = subject.call(end, end, 1.0, values, locked).stress
        slow = subject.call(end * (1.0 - values["strain_floor"]), end, 1.0, values, locked).stress
        creeping, rounding = np.abs(slow - still).max(), 100.0 * EPSILON * np.abs(still).max()
        for turn in turns(subject):
            found = subject.call(end, turn @ end, 1.0, values, locked).stress
            difference = np.abs(found - turned_stress(still, turn)).max()
            worst = max(worst, float(max(difference - rounding, 0.0) / creeping))
    return check.judge(worst)
