"""Compaction rates out of readings: the points of the paper's log-log diagram.

Under a held load the compaction runs nearly straight over the logarithm of the time since the load changed, so rates
come from lines over that logarithm, with a bend, over stretches just long enough for the slope to stand out of the noise.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plyflow.identify.force import steady_stretches
from plyflow.identify.specimen import Specimen

FloatArray = NDArray[np.float64]
STRETCH = 1.7
FEWEST_IN_STRETCH = 5
FEWEST_FOR_BEND = 8
WANTED_RATE_ERROR, LARGEST_RATE_ERROR = 0.15, 0.5


@dataclass(frozen=True)
class CreepPoints:
    """Points (n,): eps [-], rate = -d eps/dt > 0 [1/s], pressure [MPa]; standard errors of eps and ln(rate)."""

    eps: FloatArray
    rate: FloatArray
    pressure: FloatArray
    eps_error: FloatArray
    log_rate_error: FloatArray

    @property
    def size(self) -> int:
        """Number of points."""
        return int(self.eps.size)

    def take(self, chosen: NDArray[np.bool_]) -> CreepPoints:
        """The chosen points."""
        return CreepPoints(**{name: value[chosen] for name, value in vars(self).items()})


def creep_points(specimen: Specimen) -> CreepPoints:
    """Points of a specimen whose rate is known to better than half of it."""
    time, eps, pressure = specimen.time, specimen.eps, specimen.pressure
    rows = []
    for start, stop in steady_stretches(pressure):
        elapsed = time[start:stop] - time[max(start - 1, 0)]
        for first, last, line in _stretches(elapsed, eps[start:stop]):
            load = float(np.mean(pressure[start + first : start + last]))
            if load > 0.0:
                rows.append((*line, load))
    table = np.array(rows).reshape(-1, 5)
    points = CreepPoints(table[:, 0], table[:, 1], table[:, 4], table[:, 2], table[:, 3])
    return points.take((points.rate > 0.0) & (points.log_rate_error < LARGEST_RATE_ERROR))


def _stretches(elapsed: FloatArray, eps: FloatArray) -> Iterator[tuple[int, int, tuple[float, ...]]]:
    """Index ranges and their lines, each over a factor in time or as much more as the noise asks for."""
    first = int(np.searchsorted(elapsed, 0.0, side="right"))
    while elapsed.size - first >= FEWEST_IN_STRETCH:
        last = max(int(np.searchsorted(elapsed, STRETCH * elapsed[first], side="right")), first + FEWEST_IN_STRETCH)
        last = elapsed.size if elapsed.size - last < FEWEST_IN_STRETCH else last
        line = _line(elapsed[first:last], eps[first:last])
        while last < elapsed.size and not (line[1] > 0.0 and line[3] < WANTED_RATE_ERROR):
            last = min(int(1.3 * last) + 1, elapsed.size)
            line = _line(elapsed[first:last], eps[first:last])
        yield first, last, line
        first = last


def _line(elapsed: FloatArray, eps: FloatArray) -> tuple[float, float, float, float]:
    """Compaction and rate in the middle of a stretch, and the errors of compaction and ln(rate).

    With enough readings a bend is fitted along, so that it does not tilt the line.
    """
    logs = np.log(elapsed)
    middle = 0.5 * float(logs[0] + logs[-1])
    powers = 2 if eps.size < FEWEST_FOR_BEND else 3
    terms = np.vander(logs - middle, powers, increasing=True)
    inverse = np.linalg.inv(terms.T @ terms)
    constant, slope = (inverse @ terms.T @ eps)[:2]
    residual = eps - terms @ (inverse @ terms.T @ eps)
    variance = float(residual @ residual) / (eps.size - powers)
    constant_error, slope_error = np.sqrt(variance * np.diag(inverse)[:2])
    relative = slope_error / abs(slope) if slope != 0.0 else np.inf
    return float(constant), -float(slope) / float(np.exp(middle)), float(constant_error), float(relative)
