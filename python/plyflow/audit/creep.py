"""Final thickness of the reference case with any resistance: the law is separable, so one integral decides.

    d eps/d theta = -(p_peak/R(eps))^m,  m = 1/(a+1)   =>   integral of (R/p_peak)^m d eps from eps to 0 = theta

with the load clock theta of `plyflow.law`. R may jump at locking and be changed by any factor.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from plyflow.case.case import Case, law_parameters, property_values
from plyflow.law import LawParameters, LoadClock, LoadProgramme, Stage, log_viscosity
from plyflow.umat.prepare import generate_scene

FloatArray = NDArray[np.float64]
LogFactor = Callable[[FloatArray, Stage], FloatArray]
_NODES = 40001
_CLOSEST = 1.0e-9


@dataclass(frozen=True)
class Reference:
    """The reference case: constants of the law and load."""

    label: str
    law: LawParameters
    load: LoadProgramme


def reference_case() -> Reference:
    """IM7-8552 at 70 C, BP, 15 mm, ramp-dwell, with the declared assumptions."""
    case = Case("IM7-8552", 70.0, "BP", 15.0)
    _, manifest, _ = generate_scene("default")
    return Reference(case.label, law_parameters(property_values(case, manifest)), case.load_programme)


@dataclass(frozen=True)
class Outcome:
    """End of the reference case: compaction strain, and the time [s] of locking (infinite when it does not lock)."""

    strain: float
    lock_time: float

    @property
    def thickness(self) -> float:
        """Final h/h0."""
        return math.exp(self.strain)


def compact(
    reference: Reference,
    log_factor: LogFactor = lambda eps, stage: np.zeros_like(eps),
    *,
    limit: float | None = None,
    lock: float | None = None,
    end_time: float | None = None,
    swapped: bool = False,
) -> Outcome:
    """Compaction under the load.

    Parameters
    ----------
    log_factor : logarithm of what multiplies the resistance, by strain and stage.
    limit : strain that cannot be reached, when it is not that of the law.
    lock : another strain at locking; the law's other constants go with it.
    end_time : earlier end of the load [s].
    swapped : bleeding before locking, squeezing after.
    """
    law = reference.law if lock is None else replace(reference.law, eps_lock=lock)
    closest = law.eps_limit if limit is None else max(limit, law.eps_limit)
    bounds = [math.log(-closest), math.log(max(law.eps_lock - closest, 2 * _CLOSEST)), math.log(_CLOSEST)]
    stages = (Stage.BLEED, Stage.SQUEEZE) if swapped else (Stage.SQUEEZE, Stage.BLEED)
    distance, pieces = [], []
    for stage, start, end in zip(stages, bounds[:-1], bounds[1:], strict=True):
        y = np.linspace(start, end, _NODES)
        eps = closest + np.exp(y)
        with np.errstate(all="ignore"):
            log_r = log_viscosity(eps, law, stage) + log_factor(eps, stage) - math.log(reference.load.peak)
        integrand = law.rate_exponent * log_r + y
        distance.append(y[1:])
        pieces.append(np.logaddexp(integrand[1:], integrand[:-1]) + math.log((start - end) / (2 * (_NODES - 1))))
    total = np.logaddexp.accumulate(np.concatenate(pieces))
    clock = LoadClock(reference.load, law.rate_exponent)
    reading = math.log(float(clock.at(reference.load.end if end_time is None else end_time)[0, 0]))
    strain = closest + math.exp(float(np.interp(reading, total, np.concatenate(distance))))
    log_lock = float(total[_NODES - 2])
    return Outcome(strain, float(clock.time(math.exp(log_lock))[0]) if log_lock <= reading else math.inf)
