"""Rounding: the stress in double against the same source in quadruple precision, and the condition of the problem."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from plyflow.evidence.stability.bench import Bench, statev_at_start
from plyflow.evidence.stability.tensors import EPSILON, Array

WELL_CONDITIONED = 1e3


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


def measure_rounding(
    bench: Bench,
    ends: tuple[Array, Array],
    dt: float,
    values: Mapping[str, float],
    locked: bool | Array = False,
    scene: str = "default",
) -> Rounding:
    """Rounding of one call; arguments as in `Bench.call`."""
    statev = locked if isinstance(locked, np.ndarray) else statev_at_start(locked)
    found = bench.call(*ends, dt, values, statev, scene)
    exact = bench.quad(scene).call_quad(*ends, dt, bench.props(values), statev)
    size = np.abs(exact.stress[:, 0]).max()
    stress = np.abs(difference(exact.stress, found.stress)).max() / size
    tangent = np.abs(difference(exact.ddsdde, found.ddsdde)).max() / np.abs(exact.ddsdde[..., 0]).max()
    return Rounding(float(stress), float(tangent), _condition(bench, ends, dt, values, (statev, exact.stress), scene))


def difference(pair: Array, other: Array) -> Array:
    """A quadruple number, given as the sum of two doubles along the last axis, minus a double."""
    return np.asarray((pair[..., 0] - other) + pair[..., 1])


def _condition(
    bench: Bench,
    ends: tuple[Array, Array],
    dt: float,
    values: Mapping[str, float],
    base: tuple[Array, Array],
    scene: str,
) -> float:
    statev, stress = base
    inputs = [*(np.array(end, dtype=float) for end in ends), bench.props(values)]
    movement = np.zeros(6)
    for which, array in enumerate(inputs):
        for index in zip(*np.nonzero(array), strict=True):
            moved = [part.copy() for part in inputs]
            moved[which][index] = np.nextafter(array[index], np.inf)
            step = abs(moved[which][index] / array[index] - 1.0)
            answer = bench.quad(scene).call_quad(moved[0], moved[1], dt, moved[2], statev).stress
            movement += np.abs((answer[:, 0] - stress[:, 0]) + (answer[:, 1] - stress[:, 1])) / step
    return float(movement.max() / np.abs(stress[:, 0]).max())
