"""When a ply locked, inside the increment in which its UMAT did."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from plyflow.case.case import Case, law_parameters
from plyflow.case.solution import law_at
from plyflow.driver.drive import History
from plyflow.law.equations import LawParameters, Stage, batch
from plyflow.law.integration import LARGEST_LOG
from plyflow.law.load import LoadClock, LoadProgramme
from plyflow.law.stage_curve import curve_to


def case_lock_time(
    case: Case, values: Mapping[str, float], load: LoadProgramme, history: History, locked: NDArray[np.bool_]
) -> float | None:
    """Time [s] at which a run of a case reached the lock, see `lock_time`; of a cycle by the law in the middle of the increment.

    values: its PROPS by name.
    """
    if not (load.temperatures and locked.any()):
        return lock_time(history, locked, law_parameters(values), load) if locked.any() else None
    row = max(int(np.argmax(locked)), 1)
    middle = min(float(history.time[row - 1 : row + 1].mean()), load.end)
    return lock_time(history, locked, law_at(case, float(load.temperature(middle))), load)


def lock_time(history: History, locked: NDArray[np.bool_], law: LawParameters, load: LoadProgramme) -> float | None:
    """Time [s] at which a run reached the lock, None if it did not.

    Within the increment in which the UMAT says that it has locked: from the run's own compaction at the start of it the law
    under the load takes so long to the lock (Eqs. 1 to 6, by quadrature). An increment from the very start gives the law's time.

    Parameters
    ----------
    history : the driver's.
    locked : (n,) whether the ply has locked, by the UMAT, at each row of it.
    law, load : the law's constants and the load of the case.
    """
    if not locked.any():
        return None
    row = max(int(np.argmax(locked)), 1)
    begin, end = np.minimum(history.time[row - 1 : row + 1], load.end)
    eps = math.log(history.deformation_gradient[row - 1, 2, 2])
    if eps <= law.eps_lock:
        return float(begin)
    start, finish = (np.array([math.log(one - law.eps_limit)]) for one in (eps, law.eps_lock))
    squeeze = curve_to(batch([law]), Stage.SQUEEZE, np.array([math.log(load.peak)]), start, finish)
    clock = LoadClock(load, law.rate_exponent)
    reading = clock.at(begin)[:, 0] + np.exp(np.minimum(squeeze.log_theta[:, -1], LARGEST_LOG))
    return float(np.clip(clock.time(reading)[0], begin, end))
