"""The witness of the law's quadrature: the creep law stepped by an ODE solver, the lock as an event.

The load clock theta makes the law autonomous. With theta = theta_0 (exp(w) - 1), theta_0 the time in which the creep rate
falls by the factor e, and y = ln(eps - eps_limit), the equation for y(w) is smooth, of order one and not stiff.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from plyflow.law import LawParameters, LoadClock, LoadProgramme, Stage, log_viscosity
from plyflow.law.equations import log_viscosity_slope

FloatArray = NDArray[np.float64]
TOLERANCE, LARGEST_STEP = 1e-13, 0.5


def stepwise(law: LawParameters, load: LoadProgramme, times: FloatArray) -> tuple[FloatArray, float]:
    """Compaction (t,) at times (t,) [s], and the lock time [s], NaN if the ply never locks."""
    squeeze, lock_time = run_stage(law, load, Stage.SQUEEZE, 0.0)
    if math.isnan(lock_time):
        return squeeze(times), lock_time
    later = times > lock_time
    rest = (0.0, *(time - lock_time for time in load.times if time > lock_time))
    remaining = LoadProgramme(rest, tuple(load.pressure(lock_time + np.array(rest))))
    eps = squeeze(np.minimum(times, lock_time))
    eps[later] = run_stage(law, remaining, Stage.BLEED, law.eps_lock)[0](times[later] - lock_time)
    return eps, lock_time


def run_stage(
    law: LawParameters, load: LoadProgramme, stage: Stage, start: float
) -> tuple[Callable[[FloatArray], FloatArray], float]:
    """Compaction by time from the start of a stage, and when it locked."""
    m, clock, log_peak = law.rate_exponent, LoadClock(load, law.rate_exponent), math.log(load.peak)
    log_theta_0 = m * (log_viscosity(start, law, stage) - log_peak) - math.log(-m * log_viscosity_slope(start, law, stage))

    def scaled(theta: FloatArray) -> Any:
        with np.errstate(divide="ignore"):
            return np.logaddexp(0.0, np.log(theta) - log_theta_0)

    def slope(w: float, y: FloatArray) -> list[float]:
        gap = math.exp(y[0])
        return [-math.exp(w + log_theta_0 + m * (log_peak - log_viscosity(law.eps_limit + gap, law, stage))) / gap]

    def above_lock(w: float, y: FloatArray) -> float:
        return float(y[0]) - math.log(law.eps_lock - law.eps_limit)

    above_lock.terminal = True  # type: ignore[attr-defined]
    solution = solve_ivp(
        slope,
        (0.0, float(scaled(clock.total)[0])),
        [math.log(start - law.eps_limit)],
        method="DOP853",
        rtol=TOLERANCE,
        atol=TOLERANCE,
        max_step=LARGEST_STEP,
        dense_output=True,
        events=above_lock if stage is Stage.SQUEEZE else None,
    )
    assert solution.success, solution.message
    lock_time = math.nan
    if stage is Stage.SQUEEZE and solution.t_events[0].size:
        w_lock = float(solution.t_events[0][0])
        lock_time = float(clock.time(math.exp(log_theta_0 + w_lock + math.log(-math.expm1(-w_lock))))[0])

    def eps_at(wanted: FloatArray) -> FloatArray:
        return np.asarray(law.eps_limit + np.exp(solution.sol(scaled(clock.at(wanted)[0]))[0]), dtype=float)

    return eps_at, lock_time
