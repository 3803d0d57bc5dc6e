"""Compaction of plies while the temperature changes: the law is separable over short stretches of one temperature.

Each stretch has the constants of the temperature in its middle, so the scheme is exact at constant temperature and of second
order in the change over a stretch. The lock is judged at the current eps_lock, for good once it is passed. Cooling raises the
compaction limit; a ply beyond it stands still, as the viscosity there is unbounded.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from plyflow.law.equations import LawBatch, Stage
from plyflow.law.integration import FIBRE_FRACTION_INITIAL, LARGEST_LOG, LawHistory, law_history, times_within
from plyflow.law.load import LoadProgramme, power_duration, power_integral
from plyflow.law.stage_curve import curve_to, curve_until

FloatArray = NDArray[np.float64]
LawsAt = Callable[[FloatArray], LawBatch]  # constants (n, t) of n laws at temperatures (t,) [degC]
LARGEST_CHANGE = 0.125  # K in a stretch; h/h0 is then right to 4e-6 while heated by 3 K a minute, and to 4e-7 after it
LEAST_GAP = 1e-12


@dataclass
class _Course:
    """Where n laws are: eps, locked, eps and time [s] at the lock, first time [s] beyond the limit; all (n,)."""

    eps: FloatArray
    locked: NDArray[np.bool_]
    lock_eps: FloatArray
    lock_time: FloatArray
    still_time: FloatArray


def stretches(load: LoadProgramme, largest_change: float = LARGEST_CHANGE) -> FloatArray:
    """Times (m + 1,) [s] between which the temperature of a cycle is taken as one."""
    times, values = np.array(load.times), np.array(load.temperatures)
    passed = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(values)))])
    count = math.ceil(passed[-1] / largest_change - 1e-9)
    if count == 0:
        return times[[0, -1]]
    rising = np.flatnonzero(np.diff(passed) > 0.0)
    marks = np.interp(np.linspace(0.0, passed[-1], count + 1), *_strict(passed, times, rising))
    # A dwell is a stretch of its own: its temperature is known.
    held = np.flatnonzero((np.diff(values) == 0.0) & (np.diff(times) > 0.0))
    ends = np.concatenate([times[held], times[held + 1]])
    return np.unique(np.concatenate([times[[0, -1]], marks, ends[_at_edges(ends)]]))


def _strict(passed: FloatArray, times: FloatArray, rising: NDArray[np.intp]) -> tuple[FloatArray, FloatArray]:
    """The points of a course that never falls without those inside its rests, for the inverse."""
    kept = np.unique(np.concatenate([rising, rising + 1]))
    return passed[kept], times[kept]


def _at_edges(ends: FloatArray) -> NDArray[np.bool_]:
    """Which ends of held pieces are ends of dwells: those that occur once."""
    values, counts = np.unique(ends, return_counts=True)
    return np.isin(ends, values[counts == 1])


def integrate_cycle(
    laws_at: LawsAt,
    load: LoadProgramme,
    times: ArrayLike | None = None,
    fibre_fraction: float | FloatArray = FIBRE_FRACTION_INITIAL,
    largest_change: float = LARGEST_CHANGE,
) -> LawHistory:
    """Compaction of n plies under a cycle of pressure and temperature (Eqs. 1 to 6, A.1 at the current temperature).

    Parameters
    ----------
    laws_at : callable
        Constants (n, t) of n laws at temperatures (t,) [degC].
    load : LoadProgramme
        Pressure and temperature over time.
    times : array_like (t,), optional
        Times [s] within the cycle; default its end only.
    fibre_fraction : float or (n,)
        Initial fibre volume fraction [-].
    largest_change : float
        Change of the temperature [K] over a stretch.

    Raises
    ------
    InputError
        A time is outside the cycle.
    RunError
        A law could not be followed to the end.
    """
    wanted = times_within(load, times)
    marks = stretches(load, largest_change)
    laws = laws_at(load.temperature(0.5 * (marks[:-1] + marks[1:])))
    count = len(laws.k)
    course = _Course(np.zeros(count), np.zeros(count, dtype=bool), *np.full((3, count), np.nan))
    eps = np.zeros((count, wanted.size))
    for place, (begin, end) in enumerate(pairwise(marks.tolist())):
        inside = np.flatnonzero((wanted > begin) & (wanted <= end))
        stretch = np.unique(np.concatenate([[begin], load.times, wanted[inside], [end]]))
        stretch = stretch[(stretch >= begin) & (stretch <= end)]
        found = _stretch(laws.each(lambda values, at=place: values[:, at]), load, stretch, course)  # type: ignore[misc]
        eps[:, inside] = found[:, np.searchsorted(stretch, wanted[inside])]
    return law_history(load, wanted, eps, course.lock_eps, course.lock_time, fibre_fraction, course.still_time)


def _stretch(law: LawBatch, load: LoadProgramme, times: FloatArray, course: _Course) -> FloatArray:
    """Compaction (n, t) at times (t,) of a stretch, the first its start; the course goes to its end."""
    ratios = load.pressure(times) / (load.peak or 1.0)
    gains = power_integral(np.diff(times), ratios[:-1], ratios[1:], law.rate_exponent[:, None])
    readings = np.concatenate([np.zeros((law.k.size, 1)), np.cumsum(gains, axis=1)], axis=1)
    arrived = ~course.locked & (course.eps <= law.eps_lock)  # the lock came to the ply
    _lock(course, np.flatnonzero(arrived), np.full(law.k.size, times[0]), course.eps)
    eps = np.repeat(course.eps[:, None], times.size, axis=1)
    beyond = course.eps - law.eps_limit <= LEAST_GAP
    course.still_time = np.where(beyond & np.isnan(course.still_time), times[0], course.still_time)
    moving = ~beyond & (readings[:, -1] > 0.0)
    clock = _Clock(times, ratios, readings, law.rate_exponent)
    for stage, chosen in ((Stage.SQUEEZE, moving & ~course.locked), (Stage.BLEED, moving & course.locked)):
        rows = np.flatnonzero(chosen)
        if rows.size:
            _run_stage(stage, law, load, clock, course, eps, rows, np.zeros(rows.size))
    course.eps = eps[:, -1].copy()
    return eps


@dataclass(frozen=True)
class _Clock:
    """Times (t,) [s] of a stretch, pressure over the peak (t,), clock readings (n, t) [s], exponents (n,)."""

    times: FloatArray
    ratios: FloatArray
    readings: FloatArray
    exponents: FloatArray

    def time(self, row: int, reading: float) -> float:
        """Time [s] at which the clock of a law shows a reading [s]."""
        place = int(np.searchsorted(self.readings[row], reading, side="right")) - 1
        place = min(place, self.times.size - 2)
        slope = (self.ratios[place + 1] - self.ratios[place]) / (self.times[place + 1] - self.times[place])
        rest = float(reading - self.readings[row, place])
        passed = power_duration(rest, float(self.ratios[place]), float(slope), float(self.exponents[row]))
        return float(min(self.times[place] + passed, self.times[place + 1]))


def _run_stage(
    stage: Stage,
    law: LawBatch,
    load: LoadProgramme,
    clock: _Clock,
    course: _Course,
    eps: FloatArray,
    rows: NDArray[np.intp],
    since: FloatArray,
) -> None:
    """Fill eps (n, t) of some laws from the clock readings `since` on; what passes the lock goes on in the bleed stage."""
    own = law.each(lambda values: values[rows])
    log_peak = np.full(rows.size, math.log(load.peak))
    start = np.log(course.eps[rows] - own.eps_limit)
    rest = clock.readings[rows] - since[:, None]
    curve = curve_until(own, stage, log_peak, start, np.log(np.maximum(rest[:, -1], 1e-300)))
    found = np.minimum(curve.eps_at(np.maximum(rest, 0.0)), course.eps[rows, None])
    eps[rows] = np.where(rest > 0.0, found, eps[rows])
    if stage is Stage.BLEED:
        return
    passing = np.flatnonzero(found[:, -1] < own.eps_lock)
    if not passing.size:
        return
    locking, crossed = own.each(lambda values: values[passing]), rows[passing]
    to_lock = curve_to(locking, stage, log_peak[passing], start[passing], np.log(locking.eps_lock - locking.eps_limit))
    reading = np.exp(np.minimum(to_lock.log_theta[:, -1], LARGEST_LOG)) + since[passing]
    moments = np.full(law.k.size, np.nan)
    moments[crossed] = [clock.time(row, float(one)) for row, one in zip(crossed, reading, strict=True)]
    course.eps[crossed] = locking.eps_lock
    _lock(course, crossed, moments, course.eps)
    eps[crossed] = np.maximum(eps[crossed], locking.eps_lock[:, None])
    late = crossed[clock.readings[crossed, -1] > reading]
    if late.size:
        left = reading[clock.readings[crossed, -1] > reading]
        _run_stage(Stage.BLEED, law, load, clock, course, eps, late, left)


def _lock(course: _Course, rows: NDArray[np.intp], moments: FloatArray, eps: FloatArray) -> None:
    """Lock some laws at times [s] and compactions given for all."""
    course.locked = course.locked.copy()
    course.locked[rows], course.lock_time[rows], course.lock_eps[rows] = True, moments[rows], eps[rows]

