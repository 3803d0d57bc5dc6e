"""Is a difference between DDSDDE and central differences certain? One-sided differences on both sides leave a range.

Where the stress has a kink (two transverse stretches that coincide, the onset of yielding) or is curved within the
step of the differences, the slopes to both sides differ, and central differences are no tangent. A component is
wrong for certain only if it lies outside the range between them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from plyflow.diagnose.mistakes import VOIGT, Point

Array = NDArray[np.float64]
StressAt = Callable[[Array], Array | None]
STEP_OF_INCREMENT, SMALLEST_STEP = 1e-4, 1e-10  # of strain


def certainly_wrong(point: Point, stress_at: StressAt, increment: float, allowed: float) -> bool:
    """Whether a component of DDSDDE lies outside the one-sided slopes of the Kirchhoff stress, divided by J.

    Parameters
    ----------
    point
        The checked end of an increment.
    stress_at
        Cauchy stress (6,) in MPa of the same increment with another deformation gradient (3, 3) at its end; None if
        the UMAT cannot evaluate it.
    increment
        Largest component of the strain increment.
    allowed
        How far outside, relative to the largest component of the tangent.
    """
    step = max(STEP_OF_INCREMENT * increment, SMALLEST_STEP)
    slack = allowed * float(np.abs(point.right).max())
    for column in range(6):
        above, below = (_slope(point, stress_at, column, sign * step) for sign in (1.0, -1.0))
        if above is None or below is None:
            continue
        low, high = np.minimum(above, below), np.maximum(above, below)
        given = point.given[:, column]
        if bool(np.any((given < low - slack) | (given > high + slack))):
            return True
    return False


def _slope(point: Point, stress_at: StressAt, column: int, step: float) -> Array | None:
    """One-sided (1/J) d tau / d eps (6,) of a column, in MPa."""
    f, stretch = point.deformation_gradient, np.eye(3)
    i, j = VOIGT[column]
    stretch[i, j] += step / 2
    stretch[j, i] += step / 2
    moved = stress_at(stretch @ f)
    if moved is None:
        return None
    ratio = float(np.linalg.det(stretch))
    return np.asarray((ratio * moved - point.stress) / step)
