"""The one-dimensional law, Eqs. 1-5, symbolically: what the potentials have to give back in pure compaction."""

from __future__ import annotations

import sympy as sp

from umatgen.notation import sym

EPS = sp.Symbol("eps", real=True)
RATE = sp.Symbol("compaction_rate", positive=True)


def eta_ply(stage: str) -> sp.Expr:
    """Ply-scale viscosity factor, Eq. 4a (`squeeze`) or 4b (`bleed`)."""
    w0, h0, root_chi_l = sym("w0", "h0", "root_chi_l")
    if stage == "squeeze":
        return 2 * (w0 / h0) ** 2 * sp.exp(-4 * EPS)
    return 2 * (w0 / h0) ** 2 * sp.exp(-2 * EPS) * root_chi_l**2


def eta_micro(stage: str) -> sp.Expr:
    """Fibre-scale viscosity factor without the resin viscosity, Eq. 5a or 5b."""
    k, chi_f, root_chi_l, l0_over_d = sym("k_gap", "chi_f", "root_chi_l", "l0_over_d")
    closeness = k / (sp.sqrt(chi_f) * sp.exp(EPS) - k)
    if stage == "squeeze":
        return 2 * root_chi_l * sp.exp(EPS) * k * (closeness**2 + 3)
    return 2 * l0_over_d**2 * k * closeness**2


def compressive_stress(stage: str) -> sp.Expr:
    """Magnitude of the compressive Cauchy stress, Eqs. 1-3, at strain EPS and compaction rate RATE = -d(EPS)/dt > 0."""
    a, b = sym("a_rate", "b_log")
    return eta_micro(stage) * eta_ply(stage) * sp.exp(b) * RATE ** (a + 1)
