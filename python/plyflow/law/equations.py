"""The one-dimensional compaction law, Eqs. 1 to 6 of Belnoue et al. (2016).

    sigma = -eta_micro(eps) eta_ply(eps) exp(b) (-d eps/dt)^(a+1),     eps = ln(h/h0) < 0 in compaction

The viscosities are formed as logarithms, because the creep rate raises them to the power 1/(a+1), between
4 and 22 for the published materials. They depend on the distance to the compaction limit,
z = eps - eps_limit > 0, through  k/(sqrt(chi_f) exp(eps) - k) = 1/(exp(z) - 1).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from plyflow.errors import InputError

FloatArray = NDArray[np.float64]
Value = TypeVar("Value", float, FloatArray)


LEAST_LOCK = -1e-4  # the UMAT's bound of eps_lock too
LEAST_SHEAR = 3.0  # deg, below it an angle is taken for one in radians


class Stage(Enum):
    """Flow stage: squeeze before locking (incompressible), bleed after (no further widening)."""

    SQUEEZE = 0
    BLEED = 1


@dataclass(frozen=True)
class LawConstants(Generic[Value]):
    """What Eqs. 1 to 5 need, of one law (`LawParameters`) or of n (`LawBatch`).

    w0, h0 [mm] width and thickness of the ply; l0_over_d [-]; k, a [-]; b_squeeze, b_bleed
    [ln(MPa s^(a+1))]; eps_lock [-] < 0; chi_ratio [-] = chi_l / chi_f.
    """

    w0: Value
    h0: Value
    l0_over_d: Value
    k: Value
    a: Value
    b_squeeze: Value
    b_bleed: Value
    eps_lock: Value
    chi_ratio: Value

    @property
    def eps_limit(self) -> Value:
        """Compaction limit: sqrt(chi_f) exp(eps_limit) = k, where the viscosity is unbounded."""
        limit: Value = np.log(self.k) + 0.5 * np.log(self.chi_ratio) + self.eps_lock
        return limit

    @property
    def rate_exponent(self) -> Value:
        """1/(a+1): the creep rate goes as this power of the pressure."""
        exponent: Value = 1.0 / (self.a + 1.0)
        return exponent


@dataclass(frozen=True)
class LawParameters(LawConstants[float]):
    """Constants of one law, each a number.

    Raises
    ------
    InputError
        A value is not finite or outside its bounds.
    """

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not math.isfinite(value):
                raise InputError(f"{name} = {value} must be a finite number")
        for name in ("w0", "h0", "l0_over_d", "k", "chi_ratio"):
            if getattr(self, name) <= 0.0:
                raise InputError(f"{name} = {getattr(self, name):g} must be above 0")
        if self.a <= -1.0:
            raise InputError(f"a = {self.a:g} must be above -1: at -1 the creep rate is unbounded")
        if self.eps_lock > LEAST_LOCK:
            raise InputError(
                f"eps_lock = {self.eps_lock + 0.0:g} must be below 0 by at least {-LEAST_LOCK:g} (compaction is negative): "
                "raise gamma_lock, lower the width or the initial fibre fraction, or set eps_lock"
            )
        check_limit(self.k, self.chi_ratio)

    @property
    def chi_lock(self) -> float:
        """Aspect ratio of the unit cell at locking, chi_l = exp(-2 eps_lock)."""
        return math.exp(-2.0 * self.eps_lock)

    @property
    def chi_limit(self) -> float:
        """Aspect ratio of the unit cell at the compaction limit, chi_f = chi_l / chi_ratio."""
        return self.chi_lock / self.chi_ratio


@dataclass(frozen=True)
class LawBatch(LawConstants[FloatArray]):
    """Constants of n laws, each an array (n,); build it with `batch`, which has the bounds checked law by law."""

    def each(self, change: Callable[[FloatArray], FloatArray]) -> LawBatch:
        """The laws with every array of constants changed."""
        return LawBatch(**{name: change(values) for name, values in vars(self).items()})

    def against(self, axes: int) -> LawBatch:
        """The same laws with so many axes of length 1 appended, to broadcast against arrays (n, ...)."""
        return self.each(lambda values: values.reshape(-1, *(1,) * axes))


def batch(laws: Sequence[LawParameters]) -> LawBatch:
    """Collect laws into arrays (n,).

    Raises
    ------
    InputError
        There is none, or one has a >= 1: it would reach the compaction limit in a finite time.
    """
    if not laws:
        raise InputError("no laws given: give at least one")
    steepest = max(law.a for law in laws)
    if steepest >= 1.0:
        raise InputError(f"a = {steepest:g} must be below 1: above, the compaction limit is reached in a finite time")
    return LawBatch(**{name: np.array([getattr(law, name) for law in laws], dtype=float) for name in vars(laws[0])})


def lock_strain(h0: float, w0: float, gamma_lock: float, eps_lock_bulk: float) -> float:
    """Compaction eps_lock [-] at which the fibres lock (Eq. 6), negative if the flow can squeeze at all.

    h0, w0 [mm] thickness and width of the ply; gamma_lock [deg] largest shear angle at its edge, from 3 to below 90;
    eps_lock_bulk [-] compaction of the bulk at which fibres touch.

    Raises
    ------
    InputError
        A value is outside its bounds.
    """
    for name, value in (("h0", h0), ("w0", w0)):
        if not value > 0.0:
            raise InputError(f"{name} = {value:g} mm must be above 0")
    if not LEAST_SHEAR <= gamma_lock < 90.0:
        remedy = ""
        if 0.0 < gamma_lock < LEAST_SHEAR:
            remedy = f": give it in degrees, {gamma_lock:g} radians are {math.degrees(gamma_lock):.4g} degrees"
        raise InputError(f"gamma_lock = {gamma_lock:g} deg must be from {LEAST_SHEAR:g} to below 90{remedy}")
    edge = -0.5 * math.log1p(2.0 / 3.0 * h0 / w0 * math.tan(math.radians(gamma_lock)))
    return max(edge, 2.0 / 3.0 * eps_lock_bulk)


def check_limit(k: float, chi_ratio: float) -> None:
    """Refuse a k [-] whose compaction limit comes before the lock, given chi_ratio [-] = chi_l / chi_f."""
    if k > 0.0 and k**2 * chi_ratio >= 1.0:
        raise InputError(
            f"k = {k:g} must be below 1/sqrt(chi_ratio) = {chi_ratio**-0.5:g}, else the "
            "compaction limit comes before the lock: lower k or chi_ratio"
        )


def edge_shear(k: float, fibre_fraction: float) -> float:
    """Largest shear angle gamma_lock [deg] at the ply edge (Eq. A.1): the fibres of a cell touch and form columns.

        tan(gamma_lock) = (s - d cos(alpha)) / (d sin(alpha)),   s = 2 A0 / (d sin(alpha))
        alpha = arcsin((A0/Af) sin(alpha_f)),   alpha_f = A0/(A0 + Af) arctan(d^2 / (4 Af))
        A0 = pi r^2 / (2 V0),   Af = pi r^2 / (2 Vf),   Vf = k^2,   d = 2 r

    The paper prints arcsin for the outer function and d for d^2. The argument is the ratio of two legs of the cell, a
    parallelogram of sides s and d, and above 1 for every published k, so that an arcsine has no solution; d / (4 Af) has
    a unit.

    k [-] of the temperature; fibre_fraction [-] the initial V0.

    Raises
    ------
    InputError
        A value is outside its bounds, or k is so large that no cell of this fraction has its fibres in contact.
    """
    _check_fraction(fibre_fraction)
    if not k > 0.0:
        raise InputError(f"k = {k:g} must be above 0")
    sine = cell_sine(k, fibre_fraction)
    if sine > 1.0:
        raise InputError(
            f"Eq. A.1 gives no gamma_lock for k = {k:g} and fibre_fraction_initial = {fibre_fraction:g}: lower k, or set "
            "gamma_lock or eps_lock"
        )
    legs = math.pi / (4.0 * fibre_fraction) - sine * math.sqrt(1.0 - sine**2), sine**2  # over d / sin(alpha)
    return min(math.degrees(math.atan2(*legs)), math.nextafter(90.0, 0.0))


def cell_sine(k: float, fibre_fraction: float) -> float:
    """sin(alpha) of Eq. A.1, see `edge_shear`; it grows with k, and above 1 there is no such cell."""
    ratio = k**2 / fibre_fraction  # A0 / Af
    return ratio * math.sin(ratio / (1.0 + ratio) * math.atan(2.0 * k**2 / math.pi))


def bulk_lock_strain(fibre_fraction: float) -> float:
    """Strain ln sqrt(4 V0 / pi): square-packed round fibres of fraction V0 [-] pressed into contact."""
    _check_fraction(fibre_fraction)
    return 0.5 * math.log(4.0 * fibre_fraction / math.pi)


def _check_fraction(fibre_fraction: float) -> None:
    if not 0.0 < fibre_fraction < 1.0:
        raise InputError(f"fibre_fraction_initial = {fibre_fraction:g} must be between 0 and 1")


def log_eta_ply(eps: Any, law: LawConstants[Any], stage: Stage) -> Any:
    """Logarithm of the ply-scale factor eta_ply [-] (Eq. 4a squeeze, 4b bleed)."""
    scale = math.log(2.0) + 2.0 * np.log(law.w0 / law.h0)
    if stage is Stage.SQUEEZE:
        return scale - 4.0 * eps
    return scale - 2.0 * (eps + law.eps_lock)


def log_eta_micro(eps: Any, law: LawConstants[Any], stage: Stage) -> Any:
    """Logarithm of the fibre-scale factor eta_micro / eta_resin [-] (Eq. 5a squeeze, 5b bleed).

    The resin viscosity is part of b. Needs eps > eps_limit.
    """
    gap_ratio = 1.0 / np.expm1(eps - law.eps_limit)
    if stage is Stage.SQUEEZE:
        return np.log(2.0 * law.k) - law.eps_lock + eps + np.log(gap_ratio**2 + 3.0)
    return np.log(2.0 * law.k) + 2.0 * np.log(law.l0_over_d) + 2.0 * np.log(gap_ratio)


def log_viscosity(eps: Any, law: LawConstants[Any], stage: Stage) -> Any:
    """Logarithm ln(eta_ply eta_micro exp(b)) of the viscosity [MPa s^(a+1)] within one stage."""
    b = law.b_squeeze if stage is Stage.SQUEEZE else law.b_bleed
    return log_eta_ply(eps, law, stage) + log_eta_micro(eps, law, stage) + b


def log_viscosity_slope(eps: Any, law: LawConstants[Any], stage: Stage) -> Any:
    """Slope d log_viscosity / d eps [-], negative: the viscosity grows as the ply is compacted."""
    gap_ratio = 1.0 / np.expm1(eps - law.eps_limit)
    growth = -2.0 * (1.0 + gap_ratio)
    if stage is Stage.SQUEEZE:
        return -3.0 + growth * gap_ratio**2 / (gap_ratio**2 + 3.0)
    return -2.0 + growth


def compaction_stress(eps: ArrayLike, eps_rate: ArrayLike, law: LawParameters) -> FloatArray:
    """Cauchy stress [MPa], negative in compaction (Eqs. 1 to 3), for eps_rate <= 0 [1/s]; the stage is that of eps."""
    strain, rate = np.asarray(eps, dtype=float), np.asarray(eps_rate, dtype=float)
    if not np.all(strain > law.eps_limit):
        raise InputError(
            f"eps = {np.min(strain):.6g} is at or beyond the compaction limit {law.eps_limit:.6g}: "
            "the law has no stress there"
        )
    if np.any(rate > 0.0):
        raise InputError(f"eps_rate = {np.max(rate):g} 1/s must not be above 0: the law describes compaction")
    squeeze, bleed = (log_viscosity(strain, law, stage) for stage in (Stage.SQUEEZE, Stage.BLEED))
    viscosity = np.exp(np.where(strain > law.eps_lock, squeeze, bleed))
    return np.asarray(-viscosity * (-rate) ** (law.a + 1.0), dtype=float)
