"""Superposed rotations: stress and DDSDDE turn with the body, whatever the basis they are given in."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from plyflow.evidence.stability.bench import Bench, Column, Values
from plyflow.evidence.stability.cells import Check, Outcome, Task
from plyflow.evidence.stability.precision import WELL_CONDITIONED, measure_rounding
from plyflow.evidence.stability.states import STAGES, stage_increment
from plyflow.evidence.stability.tensors import EPSILON, Array, rotation, turned_stress, turned_tangent

GROUP = "Superposed rotations"
BOUND = 1e-12
BOTH, END_ONLY = "both ends turned, moderate stiffness", "only the end turned, moderate stiffness"
STIFF = "volume kept, Table 4 and kappa as shipped"
TURNED = {
    name: Check(GROUP, f"0 to 360 degrees about three axes, {name}: stress and DDSDDE turn with it", measures, bound)
    for name, measures, bound in (
        (BOTH, "largest difference, relative [-]", BOUND),
        (END_ONLY, "largest difference, relative [-]", BOUND),
        (STIFF, "largest difference / (condition x rounding) [-]", 8.0),
    )
}
RIGID = Check(
    GROUP,
    "rotation alone in one increment: flow below a thousandth of that at the strain floor",
    "viscous stress / that of a strain increment at the floor [-]",
    1e-3,
)
MODERATE = 1.0


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    for column in bench.columns:
        for name, check in TURNED.items():
            yield Task(check, column.label, partial(turned, bench, column, name))
        yield Task(RIGID, column.label, partial(rigid, bench, column))


def angles(bench: Bench) -> Array:
    """Angles in degrees: every 15 (quick: 45), and three that are no fraction of a turn."""
    return np.array([*np.arange(0, 361, 45 if bench.quick else 15), 1e-6, 1.0, 123.456])


def _sheared_increment(values: Values, locked: bool, isochoric: bool) -> tuple[Array, Array]:
    """Compaction with shears in all planes and some fibre stretch, so that no component vanishes."""
    mixed = np.array([[1.0005, 0.06, -0.04], [0.02, 1.0, 0.08], [0.04, -0.02, 1.0]])
    start, end = stage_increment(values, locked, 3e-2)
    end = mixed @ end
    if isochoric:
        start, end = (matrix / np.cbrt(np.linalg.det(matrix)) for matrix in (start, end))
    return start, end


def turned(bench: Bench, column: Column, name: str) -> Outcome:
    """Difference between the turned answer and the answer to the turned increment."""
    check, stiff = TURNED[name], name == STIFF
    values = bench.values(column, **({} if stiff else {"kappa": MODERATE, "E_L": MODERATE}))
    worst, conditions, stress_error, tangent_error = 0.0, [], 0.0, 0.0
    for locked in STAGES.values():
        start, end = _sheared_increment(values, locked, stiff)
        rounding = measure_rounding(bench, (start, end), 1.0, values, locked)
        conditions.append(rounding.condition)
        plain = bench.call(start, end, 1.0, values, locked)
        for axis in range(3):
            for angle in angles(bench):
                turn = rotation(axis, float(angle))
                first = start if name == END_ONLY else turn @ start
                answer = bench.call(first, turn @ end, 1.0, values, locked)
                errors = _differences(plain.stress, plain.ddsdde, answer.stress, answer.ddsdde, turn)
                stress_error, tangent_error = max(stress_error, errors[0]), max(tangent_error, errors[1])
                scale = EPSILON * rounding.condition if stiff else 1.0
                worst = max(worst, max(errors) / scale)
    condition = max(conditions)
    if not stiff and condition > WELL_CONDITIONED:
        return check.fail(f"the state is conditioned worse than 1e3: {condition:.3g}", worst)
    return check.judge(worst, stress=stress_error, tangent=tangent_error, condition=condition)


def _differences(stress: Array, tangent: Array, stress_t: Array, tangent_t: Array, turn: Array) -> tuple[float, float]:
    wanted, wanted_tangent = turned_stress(stress, turn), turned_tangent(tangent, turn)
    return (
        float(np.abs(stress_t - wanted).max() / np.abs(stress).max()),
        float(np.abs(tangent_t - wanted_tangent).max() / np.abs(tangent).max()),
    )


def rigid(bench: Bench, column: Column) -> Outcome:
    """A body at rest but for a rotation: rounding in F must not pass for flow."""
    values, worst = bench.values(column, kappa=0.0), 0.0
    for locked in STAGES.values():
        _, end = _sheared_increment(values, locked, False)
        still = bench.call(end, end, 1.0, values, locked).stress
        floor = values["strain_floor"]
        creeping = np.abs(bench.call(end * (1.0 - floor), end, 1.0, values, locked).stress - still).max()
        for axis in range(3):
            for angle in angles(bench):
                turn = rotation(axis, float(angle))
                found = bench.call(end, turn @ end, 1.0, values, locked).stress
                difference = np.abs(found - turned_stress(still, turn)).max()
                rounding = 100.0 * EPSILON * np.abs(still).max()
                worst = max(worst, float(max(difference - rounding, 0.0) / creeping))
    return RIGID.judge(worst)
