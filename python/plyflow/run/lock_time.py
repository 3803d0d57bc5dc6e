"""When a ply locked, inside the increment in which its UMAT did."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from plyflow.driver.drive import History
from plyflow.law.equations import LawParameters, Stage, batch
from plyflow.law.load import LoadClock, LoadProgramme
from plyflow.law.stage_curve import curve_to


def lock_time(history: History, locked: NDArray[np.bool_], law: LawParameters, load: LoadProgramme) -> float | None:
    """Time [s] at which a run reached the lock, None if it did not.

    The clock theta = integral of (p/p_peak)^m dt is shared out over the crossing increment as the law shares it out over
    the run's own compaction there: by the integral of eta^m, squeezing down to eps_lock and bleeding from it on (Eqs. 1 to 6).

    Parameters
    ----------
    history : the driver's.
    locked : (n,) whether the ply has locked, by the UMAT, at each row of it.
    law, load : the law's constants and the load of the case.
    """
    if not locked.any():
        return None
    row = max(int(np.argmax(locked)), 1)
    start, end = np.log(np.asarray(history.deformation_gradient[row - 1 : row + 1, 2, 2], dtype=float))
    clock = LoadClock(load, law.rate_exponent)
    begin, finish = clock.at(np.minimum(history.time[row - 1 : row + 1], load.end))[0]
    lock, peak = law.eps_lock, math.log(load.peak)
    squeezing = _log_theta(law, Stage.SQUEEZE, peak, start, lock)
    bleeding = _log_theta(law, Stage.BLEED, peak, lock, end)
    part = math.exp(squeezing - np.logaddexp(squeezing, bleeding)) if squeezing > -math.inf else 0.0
    return float(clock.time(begin + part * (finish - begin))[0])


def _log_theta(law: LawParameters, stage: Stage, log_peak: float, start: float, end: float) -> float:
    """Logarithm of the clock reading [ln s] that compaction from start to end takes; -inf where there is none."""
    if not start > end:
        return -math.inf
    places = (np.array([math.log(eps - law.eps_limit)]) for eps in (start, end))
    return float(curve_to(batch([law]), stage, np.array([log_peak]), *places).log_theta[0, -1])
