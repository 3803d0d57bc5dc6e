"""The load clock of many laws at once: theta(t) = integral of (p/p_peak)^m dt for each exponent m."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from plyflow.law.load import LoadProgramme, power_duration, power_integral

FloatArray = NDArray[np.float64]


class BatchClock:
    """Clocks of one load programme for n exponents.

    Parameters
    ----------
    load : LoadProgramme
        Pressure over time, its peak above 0.
    exponents : (n,)
        Powers m > 0 of the pressure.
    """

    def __init__(self, load: LoadProgramme, exponents: FloatArray) -> None:
        self._times = np.array(load.times)
        self._ratios = np.array(load.pressures) / load.peak
        self._slopes = np.diff(self._ratios) / np.diff(self._times)
        self._exponents = exponents
        gains = self._gain(np.diff(self._times), self._ratios[:-1], self._ratios[1:])
        self._readings = np.concatenate([np.zeros((exponents.size, 1)), np.cumsum(gains, axis=1)], axis=1)

    @property
    def total(self) -> FloatArray:
        """Reading (n,) [s] at the end of the programme."""
        return self._readings[:, -1]

    def at(self, times: ArrayLike) -> FloatArray:
        """Readings (n, t) [s] at times (t,) [s] within the programme."""
        wanted = np.asarray(times, dtype=float)
        piece = np.clip(np.searchsorted(self._times, wanted, side="right") - 1, 0, self._slopes.size - 1)
        passed = wanted - self._times[piece]
        first = self._ratios[piece]
        last = np.maximum(first + self._slopes[piece] * passed, 0.0)
        return self._readings[:, piece] + self._gain(passed, first, last)

    def time(self, readings: FloatArray, cases: NDArray[np.intp]) -> FloatArray:
        """Times (c,) [s] at which the clocks of some cases (c,) show readings (c,); the end of the programme beyond."""
        return np.array([self._one_time(case, reading) for case, reading in zip(cases, readings, strict=True)])

    def _one_time(self, case: np.intp, reading: float) -> float:
        marks = self._readings[case]
        if reading >= marks[-1]:
            return float(self._times[-1])
        piece = int(np.searchsorted(marks, reading, side="right")) - 1
        exponent = float(self._exponents[case])
        start = float(self._ratios[piece]), float(self._slopes[piece])
        passed = power_duration(float(reading - marks[piece]), *start, exponent)
        return float(min(self._times[piece] + passed, self._times[piece + 1]))

    def _gain(self, durations: Any, first: Any, last: Any) -> FloatArray:
        exponents: Any = self._exponents[:, None]
        return power_integral(durations, first, last, exponents)
