"""The seventeen PROPS of the default scene, and the elastic constants they imply."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from mpmath import mp
from numpy.typing import NDArray

from oracle.algebra import Real, inverse, tensor


@dataclass(frozen=True)
class Properties:
    """PROPS in their order; lengths in mm, moduli in MPa, ``b`` so that exp(b) is in MPa s^(a+1)."""

    w0: Real
    h0: Real
    l0_over_d: Real
    k: Real
    a: Real
    b_squeeze: Real
    b_bleed: Real
    eps_lock: Real
    chi_ratio: Real
    E_L: Real
    E_T: Real
    nu_LT: Real  # noqa: N815
    nu_TT: Real  # noqa: N815
    G_LT: Real
    kappa: Real
    rate_floor: Real
    strain_floor: Real

    @classmethod
    def of(cls, values: "Sequence[Any] | NDArray[np.float64] | Properties") -> "Properties":
        """Take the 17 values in order, exactly as they are."""
        if isinstance(values, Properties):
            return values
        return cls(*(v if isinstance(v, mp.mpf) else mp.mpf(float(v)) for v in values))

    @property
    def chi_l(self) -> Real:
        """Aspect ratio of the unit cell at the lock."""
        return mp.exp(-2 * self.eps_lock)

    @property
    def chi_f(self) -> Real:
        """Aspect ratio of the unit cell at the compaction limit: chi_l = chi_ratio chi_f."""
        return self.chi_l / self.chi_ratio

    @property
    def limit_stretch(self) -> Real:
        """Stretch of the compaction limit, k / sqrt(chi_f)."""
        return self.k / mp.sqrt(self.chi_f)


PROPERTY_NAMES = tuple(field.name for field in fields(Properties))


@dataclass(frozen=True)
class ElasticConstants:
    """Constants of the corrected Bonet-Burton potential (Eq. 10), MPa."""

    mu_T: Real  # noqa: N815
    mu_L: Real  # noqa: N815
    lam: Real
    alpha: Real
    beta: Real


def normal_compliance(p: Properties) -> tuple[tuple[Real, ...], ...]:
    """Return the normal block of the transversely isotropic compliance, 1/MPa."""
    along, across = 1 / p.E_L, 1 / p.E_T
    minor, transverse = -p.nu_LT / p.E_L, -p.nu_TT / p.E_T
    return (along, minor, minor), (minor, across, transverse), (minor, transverse, across)


def elastic_constants(p: Properties) -> ElasticConstants:
    """Match the tangent at F = I to the inverse of the compliance."""
    stiffness = inverse(tensor(normal_compliance(p)))
    mu_T = p.E_T / (2 * (1 + p.nu_TT))
    mu_L = p.G_LT
    lam = stiffness[1][2]
    alpha = stiffness[0][1] - lam
    beta = stiffness[0][0] - lam - 2 * alpha - 4 * mu_L + 2 * mu_T
    return ElasticConstants(mu_T, mu_L, lam, alpha, beta)
