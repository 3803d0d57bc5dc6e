"""The width held after the lock (sec. 4.4, "no further transverse expansion"): A exp(eps_lock) <= 1, as a one-sided penalty.

With A the in-plane area ratio, excess = max(ln A + eps_lock, 0) is how far the ply is wider than at its lock, as a strain, and

    U = kappa (excess^2/2 - w excess + w^2 ln(1 + excess/w)),   dU/dexcess = kappa excess^2/(excess + w).

The force and its slope grow from zero: nothing is felt at the lock's own width or below it, and a Newton iteration sees no
kink. Far above w the slope is kappa, so a width is held to p/kappa + w under a pressure p. In space the stress is
dU/dexcess (I - n n)/J, n the unit normal of the deformed ply: a tension in its plane that nothing feels along its normal.
"""

from __future__ import annotations

import sympy as sp

from umatgen.model.chain import Chain, Definition
from umatgen.notation import sym

SMOOTHING = sp.Rational(1, 10000)  # w [-]


def excess() -> Definition:
    """Strain by which the ply is wider than at its lock; its slope is only used where it is not zero."""
    excess, area, eps_lock = sym("excess", "area", "eps_lock")
    return Definition(excess, sp.Max(sp.log(area) + eps_lock, 0), "sec. 4.4", partials={area: 1 / area})


def potential() -> sp.Expr:
    """U in MPa; `kappa_held` is kappa after the lock and 0 before it."""
    excess, kappa_held = sym("excess", "kappa_held")
    w = SMOOTHING
    return kappa_held * (excess**2 / 2 - w * excess + w**2 * sp.log(1 + excess / w))


def chain() -> Chain:
    """What the potential is differentiated through."""
    return Chain([excess()])
