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

FloatArray = NDArray[np.float64]
# Above this ratio of what a piece gathers to what its first value stands for, 1 + ratio is ratio.
LARGEST_RATIO = 1e18


@dataclass(frozen=True)
class LoadProgramme:
    """Pressure [MPa] at increasing times [s], the first 0, linear in between; notes on how they were read.

    temperatures [degC] at the same times make it a cycle; without them the temperature is the case's.

    Raises
    ------
    InputError
        Fewer than two points, times that do not start at 0 and increase, a pressure below 0.
    """

    times: tuple[float, ...]
    pressures: tuple[float, ...]
    notes: tuple[str, ...] = field(default=(), compare=False)
    temperatures: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if len(self.times) != len(self.pressures) or len(self.times) < 2:
            raise InputError(
                f"a load programme needs at least two times and as many pressures: got {len(self.times)} "
                f"and {len(self.pressures)}"
            )
        if self.temperatures and len(self.temperatures) != len(self.times):
            raise InputError(f"a cycle needs a temperature for each time: got {len(self.temperatures)} for {len(self.times)}")
        if not all(math.isfinite(value) for value in self.times + self.pressures + self.temperatures):
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

    def pressure(self, times: ArrayLike) -> FloatArray:
        """Pressure [MPa] at times [s]."""
        return np.asarray(np.interp(np.asarray(times, dtype=float), self.times, self.pressures), dtype=float)

    def temperature(self, times: ArrayLike) -> FloatArray:
        """Temperature [degC] of a cycle at times [s]."""
        return np.asarray(np.interp(np.asarray(times, dtype=float), self.times, self.temperatures), dtype=float)

    def pieces(self) -> Iterator[tuple[float, float, float, float]]:
        """Start time, end time [s], start pressure, end pressure [MPa] of each linear piece."""
        points = zip(self.times, self.pressures, strict=True)
        for (start, first), (end, last) in pairwise(points):
            yield start, end, first, last


def power_integral(duration: ArrayLike, first: ArrayLike, last: ArrayLike, exponent: float | FloatArray) -> FloatArray:
    """Integral of (linear function)^exponent over a duration [s], without cancellation; all may be arrays.

    first, last: values >= 0 of the function at the ends; the exponent is above 0.
    """
    low, high = np.minimum(first, last), np.maximum(first, last)
    with np.errstate(divide="ignore", invalid="ignore"):
        gap = (high - low) / high
        mean = -np.expm1((exponent + 1.0) * np.log1p(-gap)) / ((exponent + 1.0) * gap)
    mean = np.where(gap > 0.0, mean, 1.0)
    return np.asarray(np.asarray(duration, dtype=float) * high**exponent * mean, dtype=float)


def power_duration(integral: float, first: float, slope: float, exponent: float) -> float:
    """Duration [s] in which first + slope t, slope [1/s], gathers an integral [s] of its power; inverse of `power_integral`."""
    if slope == 0.0:
        return integral / math.pow(first, exponent)
    gain = (exponent + 1.0) * slope * integral
    whole = math.pow(first, exponent + 1.0)
    if abs(gain) < LARGEST_RATIO * whole:
        return first * math.expm1(math.log1p(max(gain / whole, -1.0)) / (exponent + 1.0)) / slope
    return (math.pow(whole + gain, 1.0 / (exponent + 1.0)) - first) / slope


class LoadClock:
    """Clocks theta(t) [s] of a load programme for n exponents: integral of (p/p_peak)^m from 0; they never run backwards.

    Parameters
    ----------
    load : LoadProgramme
        Pressure over time, its peak above 0.
    exponents : (n,) or float
        Powers m > 0 of the pressure.
    """

    def __init__(self, load: LoadProgramme, exponents: ArrayLike) -> None:
        self._times = np.array(load.times)
        self._ratios = np.array(load.pressures) / load.peak
        self._slopes = np.diff(self._ratios) / np.diff(self._times)
        self._exponents = np.atleast_1d(np.asarray(exponents, dtype=float))
        gains = self._gain(np.diff(self._times), self._ratios[:-1], self._ratios[1:])
        self._readings = np.concatenate([np.zeros((len(gains), 1)), np.cumsum(gains, axis=1)], axis=1)

    @property
    def total(self) -> FloatArray:
        """Readings (n,) [s] at the end of the programme."""
        return self._readings[:, -1]

    def at(self, times: ArrayLike) -> FloatArray:
        """Readings (n, t) [s] at times (t,) [s] within the programme."""
        wanted = np.atleast_1d(np.asarray(times, dtype=float))
        piece = np.clip(np.searchsorted(self._times, wanted, side="right") - 1, 0, self._slopes.size - 1)
        passed = wanted - self._times[piece]
        first = self._ratios[piece]
        last = np.maximum(first + self._slopes[piece] * passed, 0.0)
        return self._readings[:, piece] + self._gain(passed, first, last)

    def time(self, readings: ArrayLike) -> FloatArray:
        """Times (n,) [s] at which the clocks show readings (n,) [s]; the end of the programme beyond."""
        wanted = np.atleast_1d(np.asarray(readings, dtype=float))
        return np.array([self._one_time(row, float(reading)) for row, reading in enumerate(wanted)])

    def _one_time(self, row: int, reading: float) -> float:
        marks = self._readings[row]
        if reading >= marks[-1]:
            return float(self._times[-1])
        piece = int(np.searchsorted(marks, reading, side="right")) - 1
        start = float(self._ratios[piece]), float(self._slopes[piece])
        passed = power_duration(float(reading - marks[piece]), *start, float(self._exponents[row]))
        return float(min(self._times[piece] + passed, self._times[piece + 1]))

    def _gain(self, durations: FloatArray, first: FloatArray, last: FloatArray) -> FloatArray:
        return power_integral(durations, first, last, self._exponents[:, None])
