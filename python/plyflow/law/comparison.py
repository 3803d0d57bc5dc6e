"""The comparison laws of the paper's Table 1: squeezing without a compaction limit.

    Rogers (1989), Newtonian:           sigma = eta (w0/h0)^2 exp(-2 eps) rate
    Wang and Gutowski (1991), power n:  sigma = eta f(n) (w0/h0)^(n+1) exp(-(n+1) eps) rate^n

Both are those of a fluid that fills the gap between plates of constant width w0, no slip. The paper leaves f(n) open;
lubrication theory gives f(n) = ((2n+1)/n)^n / (n+2), so f(1) = 1 and the second becomes the first. (The table says of
Rogers' law that the volume under the plates stays constant; that would make the exponent -4, as in Eq. 4a.)

Under a pressure p(t) both have closed forms: with q = (n+1)/n,
    exp(-q eps) = 1 + q integral of (p / (eta f (w0/h0)^(n+1)))^(1/n) dt.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from plyflow.errors import InputError
from plyflow.law.equations import LawParameters
from plyflow.law.load import LoadClock, LoadProgramme

FloatArray = NDArray[np.float64]


def power_law_factor(n: float) -> float:
    """f(n) of Wang and Gutowski's law for squeezing between parallel plates; 1 for n = 1."""
    if not n > 0.0:
        raise InputError(f"n = {n:g} must be above 0")
    return float(((2.0 * n + 1.0) / n) ** n / (n + 2.0))


@dataclass(frozen=True)
class PowerSqueeze:
    """A comparison law: exponent n [-], log_viscosity = ln of eta_micro [ln(MPa s^n)], w0 and h0 [mm]."""

    n: float
    log_viscosity: float
    w0: float
    h0: float

    @property
    def log_resistance(self) -> float:
        """Logarithm of eta f(n) (w0/h0)^(n+1)."""
        return self.log_viscosity + math.log(power_law_factor(self.n)) + (self.n + 1.0) * math.log(self.w0 / self.h0)

    def eps(self, load: LoadProgramme, times: ArrayLike) -> FloatArray:
        """Compaction (t,) [-] at times (t,) [s] under a load programme."""
        wanted = np.atleast_1d(np.asarray(times, dtype=float))
        if load.peak == 0.0:
            return np.zeros(wanted.shape)
        readings = LoadClock(load, 1.0 / self.n).at(wanted)[0]
        power = (self.n + 1.0) / self.n
        with np.errstate(divide="ignore"):
            log_gain = np.log(power * readings) + (math.log(load.peak) - self.log_resistance) / self.n
        return np.asarray(-np.logaddexp(0.0, log_gain) / power, dtype=float)


def matched(law: LawParameters, n: float, load: LoadProgramme, time: float, eps: float) -> PowerSqueeze:
    """The comparison law of exponent n that reaches a compaction eps < 0 at a time [s] under the load.

    Raises
    ------
    InputError
        Nothing has moved at that time, so there is nothing to match.
    """
    if not eps < 0.0:
        raise InputError(
            f"at {time:g} s the ply is not compacted yet: choose a later time to match the comparison laws"
        )
    reading = float(LoadClock(load, 1.0 / n).at(time)[0, 0])
    power = (n + 1.0) / n
    log_gain = -power * eps + math.log(-math.expm1(power * eps))  # ln(exp(-q eps) - 1)
    log_resistance = math.log(load.peak) + n * (math.log(power * reading) - log_gain)
    unit = PowerSqueeze(n, 0.0, law.w0, law.h0)
    return PowerSqueeze(n, log_resistance - unit.log_resistance, law.w0, law.h0)
