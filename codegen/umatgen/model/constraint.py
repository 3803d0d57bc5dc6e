"""Incompressibility before locking (sec. 4.4), as a penalty: U = (kappa/2)(J - 1)^2, so S_vol = kappa (J - 1) J C^-1."""

from __future__ import annotations

import sympy as sp

from umatgen.notation import sym


def penalty_potential() -> sp.Expr:
    """U(J) in MPa; `kappa_eff` is kappa before locking and 0 after it."""
    kappa_eff, det_f = sym("kappa_eff", "det_f")
    return kappa_eff * (det_f - 1) ** 2 / 2


def pressure() -> sp.Expr:
    """Pressure of the constraint in MPa, compression positive: -dU/dJ."""
    (det_f,) = sym("det_f")
    return -sp.factor(sp.diff(penalty_potential(), det_f))
