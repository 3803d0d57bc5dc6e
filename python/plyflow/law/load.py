"""Plate pressure over time, piecewise linear, and the load clock that makes the creep law autonomous.

Under d eps/dt = -(p/(eta exp(b)))^m the load enters only through  theta(t) = integral of (p/p_max)^m dt,
which is known in closed form on every linear piece.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from plyflow.errors import InputError

# Above this ratio of what a piece gathers to what its first value stands for, 1 + ratio is ratio.
LARGEST_RATIO = 1e18


@dataclass(frozen=True)
class LoadProgramme:
    """Pressure [MPa] at increasing times [s], the first 0, linear in between; notes on how they were read.

    Raises
    ------
    InputError
        Fewer than two points, times that do not start at 0 and increase, a pressure below 0.
    """

    times: tuple[float, ...]
    pressures: tuple[float, ...]
    notes: tuple[str, ...] = field(default=(), compare=False)

    def __post_init__(self) -> None:
        if len(self.times) != len(self.pressures) or len(self.times) < 2:
            raise InputError(
                f"a load programme needs at least two times and as many pressures: got {len(self.times)} "
                f"and {len(self.pressures)}"
            )
        if not all(math.isfinite(value) for value in self.times + self.pressures):
            raise InputError("a load programme must consist of finite numbers")
        if self.times[0] != 0.0 or any(later <= earlier for earlier, later in pairwise(self.times)):
            raise InputError("the times of a load programme must start at 0 s and increase strictly")
        if min(self.pressures) < 0.0:
            raise InputError(f"pressure {min(self.pressures):g} MPa must not be below 0")

    @property
    def end(self) -> float:
        """Last time [s]."""
        return self.times[-1]

    @property
    def peak(self) -> float:
        """Largest pressure [MPa]."""
        return max(self.pressures)

    def pressure(self, times: ArrayLike) -> NDArray[np.float64]:
        """Pressure [MPa] at times [s]."""
        return np.asarray(np.interp(np.asarray(times, dtype=float), self.times, self.pressures), dtype=float)

    def pieces(self) -> Iterator[tuple[float, float, float, float]]:
        """Start time, end time [s], start pressure, end pressure [MPa] of each linear piece."""
        points = zip(self.times, self.pressures, strict=True)
        for (start, first), (end, last) in pairwise(points):
            yield start, end, first, last


def power_integral(
    duration: ArrayLike, first: ArrayLike, last: ArrayLike, exponent: float
) -> NDArray[np.float64]:
    """Integral of (linear function)^exponent over a duration, without cancellation.

    Parameters
    ----------
    duration : array_like
        Length of the piece [s].
    first, last : array_like
        Values >= 0 at its ends.
    exponent : float
        Power, above 0.
    """
    low, high = np.minimum(first, last), np.maximum(first, last)
    with np.errstate(divide="ignore", invalid="ignore"):
        gap = (high - low) / high
        mean = -np.expm1((exponent + 1.0) * np.log1p(-gap)) / ((exponent + 1.0) * gap)
    mean = np.where(gap > 0.0, mean, 1.0)
    return np.asarray(np.asarray(duration, dtype=float) * high**exponent * mean, dtype=float)


def power_duration(integral: float, first: float, slope: float, exponent: float) -> float:
    """Duration [s] in which a linear function gathers an integral of its power; inverse of `power_integral`.

    Parameters
    ----------
    integral : float
        Integral of (first + slope t)^exponent from 0 [s].
    first, slope : float
        Value >= 0 at the start, and its rate [1/s].
    exponent : float
        Power, above 0.
    """
    if slope == 0.0:
        return integral / math.pow(first, exponent)
    gain = (exponent + 1.0) * slope * integral
    whole = math.pow(first, exponent + 1.0)
    if abs(gain) < LARGEST_RATIO * whole:
        return first * math.expm1(math.log1p(max(gain / whole, -1.0)) / (exponent + 1.0)) / slope
    return (math.pow(whole + gain, 1.0 / (exponent + 1.0)) - first) / slope


@dataclass(frozen=True)
class LoadClock:
    """Clock theta(t) [s]: integral from `start` of (p/p_peak)^exponent; grows wherever the load is not 0."""

    load: LoadProgramme
    exponent: float
    start: float = 0.0

    def at(self, times: ArrayLike) -> NDArray[np.float64]:
        """Clock reading theta [s] at times [s]; 0 up to the start."""
        wanted = np.asarray(times, dtype=float)
        total = np.zeros(wanted.shape)
        for piece in self.load.pieces():
            total += self._within(*piece, wanted)
        return total

    def time(self, theta: float) -> float:
        """Time [s] at which the clock shows theta [s], from 0 to its reading at the end of the load."""
        passed = 0.0
        for begin, end, first, last in self.load.pieces():
            gain = float(self._within(begin, end, first, last, end))
            if gain > 0.0 and passed + gain >= theta:
                low = max(begin, self.start)
                slope = (last - first) / (end - begin)
                ratios = (first + slope * (low - begin)) / self.load.peak, slope / self.load.peak
                return min(low + power_duration(max(theta - passed, 0.0), *ratios, self.exponent), end)
            passed += gain
        return self.load.end

    def _within(
        self, begin: float, end: float, first: float, last: float, times: ArrayLike
    ) -> NDArray[np.float64]:
        low = min(max(begin, self.start), end)
        high = np.clip(times, low, end)
        slope = (last - first) / (end - begin)
        values = first + slope * (low - begin), first + slope * (high - begin)
        peak = self.load.peak
        return power_integral(high - low, values[0] / peak, values[1] / peak, self.exponent)
