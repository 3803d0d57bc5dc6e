"""Rounding: the stress in double against the same source in quadruple precision, and the condition of the problem."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.states import random_increment
from plyflow.evidence.stability.subject import Column, Subject
from plyflow.evidence.stability.tensors import EPSILON, Array

WELL_CONDITIONED = 1e3
ALLOWED = 1e-12
SAMPLES = 12
INEXACT = "error above 1e-12 where the condition is below 1e3"


@dataclass(frozen=True)
class Rounding:
    """Errors of one call relative to the largest component, and the condition of its stress.

    condition : relative change of the stress per relative change of F0, F1 and PROPS, each entry's effect taken
        at its worst; measured by moving every entry by one unit in the last place in quadruple precision.
    """

    stress: float
    tangent: float
    condition: float

    @property
    def share(self) -> float:
        """Error of the stress in units of condition times the rounding of a double."""
        return self.stress / (EPSILON * max(self.condition, 1.0))

    @property
    def well_conditioned(self) -> bool:
        """Whether the condition is below 1e3."""
        return self.condition < WELL_CONDITIONED

    @property
    def inexact(self) -> bool:
        """Whether the error is above 1e-12 although the condition is good."""
        return self.well_conditioned and self.stress > ALLOWED


def measure_rounding(
    subject: Subject,
    start: Array,
    end: Array,
    dt: float,
    values: Mapping[str, float],
    locked: bool | Array = False,
    scene: str = "default",
) -> Rounding:
    """Rounding of one call; arguments as in `Subject.call`."""
    statev = subject.statev(locked, scene)
    found = subject.call(start, end, dt, values, statev, scene)
    inputs = [np.array(start, dtype=float), np.array(end, dtype=float), subject.props(values)]

    def exact(first: Array, last: Array, props: Array) -> tuple[Array, Array]:
        answer = subject.quad(scene).call_quad(first, last, dt, props, statev)
        return answer.stress, answer.ddsdde

    stress, tangent = exact(*inputs)
    movement = np.zeros(6)
    for which, array in enumerate(inputs):
        for index in zip(*np.nonzero(array), strict=True):
            moved = [part.copy() for part in inputs]
            moved[which][index] = np.nextafter(array[index], np.inf)
            step = abs(moved[which][index] / array[index] - 1.0)
            answer, _ = exact(*moved)
            movement += np.abs((answer[:, 0] - stress[:, 0]) + (answer[:, 1] - stress[:, 1])) / step
    size = np.abs(stress[:, 0]).max()
    return Rounding(
        float(np.abs(difference(stress, found.stress)).max() / size),
        float(np.abs(difference(tangent, found.ddsdde)).max() / np.abs(tangent[..., 0]).max()),
        float(movement.max() / size),
    )


def difference(pair: Array, other: Array) -> Array:
    """A quadruple number, given as the sum of two doubles along the last axis, minus a double."""
    return np.asarray((pair[..., 0] - other) + pair[..., 1])


def along(check: Check, subject: Subject, column: Column, scene: str) -> Outcome:
    """Increments spread over a programme, both stages, with the constants as shipped."""
    run = subject.drive_case(column.case(), subject.values(column), scene).ended()
    history, found = run.history, []
    for row in np.linspace(1, history.increments, 4 if subject.quick else SAMPLES).astype(int):
        start, end = history.deformation_gradient[row - 1 : row + 1]
        dt, statev = float(history.increment[row]), history.statev[row - 1]
        found.append(measure_rounding(subject, start, end, dt, run.values, statev, scene))
    return _judge(check, found, max(one.share for one in found))


def drawn(check: Check, subject: Subject, column: Column) -> Outcome:
    """Random increments of 1e-4 to 1e-1 of strain, both stages."""
    rng = subject.generator(int(1000 + subject.columns.index(column)))
    values, found = subject.values(column, kappa=1.0, E_L=1.0), []
    for number in range(6 if subject.quick else 30):
        found.append(measure_rounding(subject, *random_increment(values, number % 2 == 1, rng)))
    return _judge(check, found, max((one.stress for one in found if one.well_conditioned), default=float("nan")))


def _judge(check: Check, found: list[Rounding], measured: float) -> Outcome:
    good = [one.stress for one in found if one.well_conditioned]
    details = {
        "calls": len(found),
        "conditioned_below_1e3": len(good),
        "error_below_1e3": max(good, default=0.0),
        "error_above_1e3": max((one.stress for one in found if not one.well_conditioned), default=0.0),
        "condition_least": min(one.condition for one in found),
        "condition_largest": max(one.condition for one in found),
        "error_of_tangent": max(one.tangent for one in found),
    }
    if any(one.inexact for one in found):
        return check.fail(INEXACT, measured, **details)
    return check.judge(measured, **details)
