"""Rounding: the stress in double against the same source in quadruple precision, and the condition of the problem."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from plyflow.evidence.stability.subject import Subject, statev_at_start
from plyflow.evidence.stability.tensors import EPSILON, Array

WELL_CONDITIONED = 1e3
ALLOWED = 1e-12
SHARE = ("error against quadruple precision / (condition x rounding) [-]", 4.0)
"""What is measured where a stress must be as exact as its input, and the bound."""
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
    statev = statev_at_start(locked)
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
