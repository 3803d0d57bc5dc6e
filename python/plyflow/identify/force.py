"""The load behind noisy readings of force: straight pieces, as few as the noise allows.

Rates go as the 4th to 22nd power of the pressure, so noise of the force sensor, taken as load, would make the ply creep
faster than it did. Readings without noise are kept as they are.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

FloatArray = NDArray[np.float64]
ACCEPTED = 0.999
MEDIAN_TO_DEVIATION = 0.6745
LEAST_NOISE = 1e-9
STEADY = 0.03
FEWEST_STEADY = 5


def noise_of(readings: FloatArray) -> float:
    """Standard deviation of the noise by the median of second differences, which a smooth course hardly touches."""
    second = np.diff(readings, n=2)
    return float(np.median(np.abs(second - np.median(second)))) / MEDIAN_TO_DEVIATION / math.sqrt(6.0)


def smoothed_force(time: FloatArray, force: FloatArray) -> FloatArray:
    """Force (n,) [N] without its noise, from readings (n,) at times (n,) [s]."""
    noise = noise_of(force)
    if noise <= LEAST_NOISE * float(np.max(np.abs(force))):
        return force
    smooth = force.copy()
    open_pieces = [(0, force.size)]
    while open_pieces:
        start, stop = open_pieces.pop()
        values, misfit = _line(time[start:stop], force[start:stop])
        if stop - start <= 2 or misfit <= noise**2 * chi2.ppf(ACCEPTED, stop - start - 2):
            smooth[start:stop] = values
        else:
            middle = start + _best_split(time[start:stop], force[start:stop])
            open_pieces += [(start, middle), (middle, stop)]
    return smooth


def steady_stretches(force: FloatArray) -> list[tuple[int, int]]:
    """Index ranges over which the force stays within a few percent of its peak, and the noise, of where it began."""
    band = STEADY * float(force.max()) + 4.0 * noise_of(force)
    edges, first = [0], float(force[0])
    for place, value in enumerate(force.tolist()):
        if abs(value - first) > band:
            edges.append(place)
            first = value
    edges.append(force.size)
    return [(start, stop) for start, stop in pairwise(edges) if stop - start >= FEWEST_STEADY]


def _line(x: FloatArray, y: FloatArray) -> tuple[FloatArray, float]:
    """Values (n,) on the regression line, and the sum of squares about it."""
    if x.size == 1:
        return y, 0.0
    from_mean = x - x.mean()
    values = y.mean() + from_mean * float(from_mean @ y) / float(from_mean @ from_mean)
    return np.asarray(values, dtype=float), float(np.sum((y - values) ** 2))


def _best_split(x: FloatArray, y: FloatArray) -> int:
    """Where two separate lines fit best: number of readings on the first."""
    forward = _running_misfit(x, y)
    backward = _running_misfit(x[::-1], y[::-1])[::-1]
    return int(np.argmin(forward[:-1] + backward[1:])) + 1


def _running_misfit(x: FloatArray, y: FloatArray) -> FloatArray:
    """Sums of squares (n,) about the line through the first 1, 2, ... n readings."""
    count = np.arange(1.0, x.size + 1.0)
    x, y = x - x[0], y - y.mean()
    sums = [np.cumsum(value) for value in (x, y, x * x, x * y, y * y)]
    xx = sums[2] - sums[0] ** 2 / count
    xy = sums[3] - sums[0] * sums[1] / count
    yy = sums[4] - sums[1] ** 2 / count
    with np.errstate(invalid="ignore", divide="ignore"):
        misfit = yy - np.where(xx > 0.0, xy**2 / xx, 0.0)
    return np.maximum(misfit, 0.0)
