"""Compaction of plies under a load programme, by quadrature of the separable law; the lock is where one stage ends.

No time stepping, so the cost of a case is that of a few hundred viscosities, whatever the times asked for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from plyflow.errors import InputError
from plyflow.law.equations import LawBatch, LawParameters, Stage, batch
from plyflow.law.load import LoadClock, LoadProgramme
from plyflow.law.stage_curve import curve_to, curve_until

FloatArray = NDArray[np.float64]
FIBRE_FRACTION_INITIAL = 0.5
LARGEST_LOG = 700.0


@dataclass(frozen=True)
class LawHistory:
    """Solution of one law at t times, or of n laws, then with a row a law.

    time (t,) [s]; pressure (t,) [MPa]; eps, thickness_ratio = h/h0, width_ratio = w/w0, fibre_fraction (t,) or (n, t)
    [-]; locked whether the ply has locked; lock_time [s], None if it never locks, of n laws (n,), NaN if never; still_time
    [s] likewise: when cooling first brought the compaction limit past the ply, which stands still from there.
    """

    time: FloatArray
    pressure: FloatArray
    eps: FloatArray
    thickness_ratio: FloatArray
    width_ratio: FloatArray
    fibre_fraction: FloatArray
    locked: NDArray[np.bool_]
    lock_time: Any
    still_time: Any = math.nan

    def row(self, place: int) -> LawHistory:
        """The solution of one of n laws."""
        shared, moments = ("time", "pressure"), ("lock_time", "still_time")
        own: dict[str, Any] = {name: values[place] for name, values in vars(self).items() if name not in (*shared, *moments)}
        for name in moments:
            moment = float(np.broadcast_to(getattr(self, name), len(self.eps))[place])
            own[name] = None if math.isnan(moment) else moment
        return replace(self, **own)


def integrate(
    law: LawParameters,
    load: LoadProgramme,
    times: ArrayLike | None = None,
    fibre_fraction: float = FIBRE_FRACTION_INITIAL,
) -> LawHistory:
    """Compaction of one ply under a load programme; as `integrate_batch`, but by default at 601 equal steps of time."""
    wanted = np.linspace(0.0, load.end, 601) if times is None else times
    return integrate_batch(batch([law]), load, wanted, fibre_fraction).row(0)


def integrate_batch(
    law: LawBatch,
    load: LoadProgramme,
    times: ArrayLike | None = None,
    fibre_fraction: float | FloatArray = FIBRE_FRACTION_INITIAL,
) -> LawHistory:
    """Compaction of n plies under one load programme (Eqs. 1 to 6).

    Parameters
    ----------
    law : LawBatch
        Constants (n,).
    load : LoadProgramme
        Pressure over time.
    times : array_like (t,), optional
        Times [s] within the programme; default its end only.
    fibre_fraction : float or (n,)
        Initial fibre volume fraction [-].

    Raises
    ------
    InputError
        A time is outside the programme.
    RunError
        A law could not be followed to the end.
    """
    wanted = times_within(load, times)
    eps, lock_time = np.zeros((law.k.size, wanted.size)), np.full(law.k.size, np.nan)
    if load.peak > 0.0:
        _compact(law, load, wanted, eps, lock_time)
    return law_history(load, wanted, eps, law.eps_lock, lock_time, fibre_fraction)


def times_within(load: LoadProgramme, times: ArrayLike | None) -> FloatArray:
    """The times (t,) [s] wanted of a load programme, its end where none are given.

    Raises
    ------
    InputError
        A time is outside the programme.
    """
    wanted = np.array([load.end]) if times is None else np.atleast_1d(np.asarray(times, dtype=float))
    if not np.all((wanted >= 0.0) & (wanted <= load.end)):
        raise InputError(f"times must lie within the load programme, 0 to {load.end:g} s")
    return wanted


def law_history(
    load: LoadProgramme,
    times: FloatArray,
    eps: FloatArray,
    lock_eps: FloatArray,
    lock_time: FloatArray,
    fibre_fraction: float | FloatArray,
    still_time: Any = math.nan,
) -> LawHistory:
    """What follows from the compaction eps (n, t) of n laws, and from compaction [-] and time [s] (n,) at which each locks."""
    locked = times >= lock_time[:, None]
    squeezed = np.where(locked, lock_eps[:, None], eps)
    initial = np.broadcast_to(np.asarray(fibre_fraction, dtype=float), lock_time.shape)[:, None]
    return LawHistory(
        time=times,
        pressure=load.pressure(times),
        eps=eps,
        thickness_ratio=np.exp(eps),
        width_ratio=np.exp(-squeezed),
        fibre_fraction=np.asarray(initial / np.exp(eps - squeezed), dtype=float),
        locked=locked,
        lock_time=lock_time,
        still_time=still_time,
    )


def _compact(law: LawBatch, load: LoadProgramme, times: FloatArray, eps: FloatArray, lock_time: FloatArray) -> None:
    """Fill eps (n, t) and lock_time (n,)."""
    clock = LoadClock(load, law.rate_exponent)
    log_peak = np.full(law.k.size, math.log(load.peak))
    y_lock = np.log(law.eps_lock - law.eps_limit)
    squeeze = curve_to(law, Stage.SQUEEZE, log_peak, np.log(-law.eps_limit), y_lock)
    readings = clock.at(times)
    lock_reading = np.exp(np.minimum(squeeze.log_theta[:, -1], LARGEST_LOG))
    locks = np.flatnonzero(clock.total > lock_reading)
    early = np.any(readings <= lock_reading[:, None], axis=0)
    eps[:, early] = squeeze.eps_at(np.minimum(readings[:, early], lock_reading[:, None]))
    if locks.size == 0:
        return
    bleeding, rest = law.each(lambda values: values[locks]), clock.total[locks] - lock_reading[locks]
    bleed = curve_until(bleeding, Stage.BLEED, log_peak[locks], y_lock[locks], np.log(rest))
    beyond = readings[locks] - lock_reading[locks, None]
    late = np.any(beyond > 0.0, axis=0)
    bled = bleed.eps_at(np.maximum(beyond[:, late], 0.0))
    eps[np.ix_(locks, late)] = np.where(beyond[:, late] >= 0.0, bled, eps[np.ix_(locks, late)])
    lock_time[locks] = clock.time(lock_reading)[locks]
