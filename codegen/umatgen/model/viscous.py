"""Viscous potential psi_v = f(C) J2^((a+2)/2), Eqs. 13 and 14 as they follow from Eqs. 1-5, and the factor g of Eq. 15.

f sees C as a parameter, so S_v = 2 d psi_v/d Cdot = g Cdot with g = 2 d psi_v/d J2 (because dJ2/dCdot = Cdot).
"""

from __future__ import annotations

import sympy as sp

from umatgen.model.chain import Definition
from umatgen.notation import sym

STAGES = ("squeeze", "bleed")
EQUATION = {"squeeze": "13", "bleed": "14"}


def law_definitions() -> list[Definition]:
    """Aspect ratios at lock and limit, stretch at the compaction limit, and the gap to it (below Eq. 5)."""
    eps_lock, chi_ratio, k = sym("eps_lock", "chi_ratio", "k_gap")
    root_chi_l, chi_l, chi_f = sym("root_chi_l", "chi_l", "chi_f")
    stretch, stretch_limit, gap = sym("stretch", "stretch_limit", "gap")
    return [
        Definition(root_chi_l, sp.exp(-eps_lock), "5 (chi_l)"),
        Definition(chi_l, root_chi_l**2, "5 (chi_l)"),
        Definition(chi_f, chi_l / chi_ratio, "5 (chi_f)"),
        Definition(stretch_limit, k / sp.sqrt(chi_f), "13"),
        Definition(gap, stretch - stretch_limit, "13"),
    ]


def factor_f(stage: str) -> sp.Expr:
    """F of psi_v = f J2^((a+2)/2): Eq. 13 (`squeeze`) or Eq. 14 (`bleed`), misprints corrected, in A's invariants."""
    w0, h0, l0_over_d, k, a, b = sym("w0", "h0", "l0_over_d", "k_gap", "a_rate", "b_log")
    root_chi_l, chi_l, chi_f = sym("root_chi_l", "chi_l", "chi_f")
    det_f, stretch, gap = sym("det_f", "stretch", "gap")
    common = 4 * det_f * k * sp.exp(b) / (a + 2)
    rate = normaliser(stage) ** (-(a + 2) / 2)
    if stage == "squeeze":
        ply = (w0 / h0) ** 2 * root_chi_l / chi_f * stretch ** (-3)
        return common * ply * ((k / gap) ** 2 + 3 * chi_f) * rate
    ply = (l0_over_d * w0 / h0) ** 2 * chi_l / chi_f * stretch ** (-2)
    return common * ply * (k / gap) ** 2 * rate


def normaliser(stage: str) -> sp.Expr:
    """J2 over the square of the compaction rate, as the law has it in its own states: 2 A:A before the lock, 2 x^2 after it."""
    stretch, a_norm2 = sym("stretch", "a_norm2")
    return 2 * a_norm2 if stage == "squeeze" else 2 * stretch**4


def floored_j2() -> sp.Expr:
    """J2 with its floor in 1/s^2."""
    j2, j2_floor = sym("j2", "j2_floor")
    return j2 + j2_floor


def power() -> sp.Expr:
    """Viscous power per reference volume in MPa/s: S_v : Cdot/2 = g J2."""
    g, j2 = sym("g_visc", "j2")
    return g * j2


def ratio_of_secants() -> sp.Expr:
    """Viscous factor at the last converged rate over the one at the present rate."""
    j2_eff, a = sym("j2_eff", "a_rate")
    return (sp.Symbol("j2_last", real=True) / j2_eff) ** (a / 2)


def potential(stage: str) -> sp.Expr:
    """Viscous potential psi_v in MPa/s, with the floored J2."""
    a, j2_eff = sym("a_rate", "j2_eff")
    return factor_f(stage) * j2_eff ** ((a + 2) / 2)


def log_viscous_factor(stage: str) -> sp.Expr:
    """Ln g with g = 2 d psi_v/d J2 (Eq. 15), as a sum of logarithms: what is differentiated and what is emitted."""
    (j2_eff,) = sym("j2_eff")
    g = sp.simplify(2 * sp.diff(potential(stage), j2_eff))
    return sp.expand(sp.expand_log(sp.log(g), force=True))
