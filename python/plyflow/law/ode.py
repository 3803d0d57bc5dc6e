"""Integration of the one-dimensional law under a load programme; the lock is an event.

Variables. The load clock theta (see `load`) makes the law autonomous, d eps/d theta = -exp(m (ln p_peak -
ln eta)), and takes the load's corners out of the integration. At the start of a stage the creep is faster
than at its end by tens of orders of magnitude. With  theta = theta_0 (exp(w) - 1), theta_0 the time in which
the creep rate falls by the factor e, and  y = ln(eps - eps_limit), the equation for y(w) is smooth, of
order one and not stiff; nothing overflows and the compaction limit cannot be crossed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

from plyflow.errors import InputError, RunError
from plyflow.law.equations import LawParameters, Stage, log_viscosity, log_viscosity_slope
from plyflow.law.load import LoadClock, LoadProgramme

FloatArray = NDArray[np.float64]
RELATIVE_TOLERANCE = 1e-13
LARGEST_STEP = 0.5
FIBRE_FRACTION_INITIAL = 0.5


@dataclass(frozen=True)
class LawHistory:
    """Solution of the one-dimensional law at n times.

    time (n,) [s]; pressure (n,) [MPa]; eps (n,) [-]; thickness_ratio = h/h0, width_ratio = w/w0,
    fibre_fraction (n,) [-]; locked (n,) whether the ply has locked; lock_time [s], None if it never locks.
    """

    time: FloatArray
    pressure: FloatArray
    eps: FloatArray
    thickness_ratio: FloatArray
    width_ratio: FloatArray
    fibre_fraction: FloatArray
    locked: NDArray[np.bool_]
    lock_time: float | None


@dataclass(frozen=True)
class _StageRun:
    """One stage: eps as a function of time from its start, and when it locked."""

    start: float
    eps_at: Callable[[FloatArray], FloatArray]
    lock_time: float | None


def integrate(
    law: LawParameters,
    load: LoadProgramme,
    times: ArrayLike | None = None,
    fibre_fraction: float = FIBRE_FRACTION_INITIAL,
) -> LawHistory:
    """Compaction of one ply under a load programme (Eqs. 1 to 6).

    Parameters
    ----------
    law : LawParameters
        Constants of the law.
    load : LoadProgramme
        Pressure over time.
    times : array_like (n,), optional
        Times [s] within the programme at which the solution is wanted; default 601 equal steps.
    fibre_fraction : float
        Initial fibre volume fraction [-].

    Raises
    ------
    InputError
        A time is outside the programme.
    RunError
        The integrator could not reach the end.
    """
    wanted = (
        np.linspace(0.0, load.end, 601) if times is None else np.atleast_1d(np.asarray(times, dtype=float))
    )
    if not np.all((wanted >= 0.0) & (wanted <= load.end)):
        raise InputError(f"times must lie within the load programme, 0 to {load.end:g} s")
    squeeze = _run_stage(law, load, Stage.SQUEEZE, 0.0, 0.0)
    lock_time = squeeze.lock_time
    if lock_time is None:
        return _history(law, load, wanted, squeeze.eps_at(wanted), None, fibre_fraction=fibre_fraction)
    bleed = _run_stage(law, load, Stage.BLEED, law.eps_lock, lock_time)
    eps = np.where(
        wanted < lock_time,
        squeeze.eps_at(np.minimum(wanted, lock_time)),
        bleed.eps_at(np.maximum(wanted, lock_time)),
    )
    return _history(law, load, wanted, eps, lock_time, fibre_fraction=fibre_fraction)


def _run_stage(
    law: LawParameters, load: LoadProgramme, stage: Stage, eps_start: float, start: float
) -> _StageRun:
    clock = LoadClock(load, law.rate_exponent, start)
    total = clock.at(load.end) if load.peak > 0.0 else np.zeros(())
    if total == 0.0:
        return _StageRun(start, lambda times: np.full(times.shape, eps_start), None)
    log_peak = law.rate_exponent * math.log(load.peak)
    log_theta_0 = (
        law.rate_exponent * log_viscosity(eps_start, law, stage)
        - log_peak
        - math.log(-law.rate_exponent * log_viscosity_slope(eps_start, law, stage))
    )

    def scaled(theta: FloatArray) -> FloatArray:
        with np.errstate(divide="ignore"):
            return np.asarray(np.logaddexp(0.0, np.log(theta) - log_theta_0), dtype=float)

    def slope(w: float, y: FloatArray) -> list[float]:
        gap = math.exp(y[0])
        resistance = law.rate_exponent * log_viscosity(law.eps_limit + gap, law, stage)
        return [-math.exp(w + log_theta_0 + log_peak - resistance) / gap]

    solution = _solve(law, slope, float(scaled(total)), math.log(eps_start - law.eps_limit), stage)

    def eps_at(times: FloatArray) -> FloatArray:
        return np.asarray(law.eps_limit + np.exp(solution.sol(scaled(clock.at(times)))[0]), dtype=float)

    lock_time = None
    if stage is Stage.SQUEEZE and solution.t_events[0].size:
        w_lock = float(solution.t_events[0][0])
        lock_time = clock.time(math.exp(log_theta_0 + w_lock + math.log(-math.expm1(-w_lock))))
    return _StageRun(start, eps_at, lock_time)


def _solve(
    law: LawParameters, slope: Callable[..., list[float]], end: float, y_start: float, stage: Stage
) -> Any:
    y_lock = math.log(law.eps_lock - law.eps_limit)

    def above_lock(w: float, y: FloatArray) -> float:
        return float(y[0]) - y_lock

    above_lock.terminal = True  # type: ignore[attr-defined]
    solution = solve_ivp(
        slope,
        (0.0, end),
        [y_start],
        method="DOP853",
        rtol=RELATIVE_TOLERANCE,
        atol=RELATIVE_TOLERANCE,
        max_step=LARGEST_STEP,
        dense_output=True,
        events=above_lock if stage is Stage.SQUEEZE else None,
    )
    if not solution.success:
        raise RunError(f"the one-dimensional law could not be integrated: {solution.message}")
    return solution


def _history(
    law: LawParameters,
    load: LoadProgramme,
    times: FloatArray,
    eps: FloatArray,
    lock_time: float | None,
    *,
    fibre_fraction: float,
) -> LawHistory:
    locked = np.zeros(times.shape, dtype=bool) if lock_time is None else times >= lock_time
    squeezed = np.where(locked, law.eps_lock, eps)
    return LawHistory(
        time=times,
        pressure=load.pressure(times),
        eps=eps,
        thickness_ratio=np.exp(eps),
        width_ratio=np.exp(-squeezed),
        fibre_fraction=fibre_fraction / np.exp(eps - squeezed),
        locked=locked,
        lock_time=lock_time,
    )
