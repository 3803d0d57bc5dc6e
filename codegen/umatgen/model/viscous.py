"""Viscous potential psi_v = f(C) J2^((a+2)/2), Eqs. 13 and 14 as they follow from Eqs. 1-5, and the factor g of Eq. 15.

f sees C as a parameter, so S_v = 2 d psi_v/d Cdot = g Cdot with g = 2 d psi_v/d J2 (because dJ2/dCdot = Cdot).
"""

from __future__ import annotations

import sympy as sp

from umatgen.model.chain import Definition
from umatgen.notation import sym

STAGES = ("squeeze", "bleed")
EQUATION = {"squeeze": "13", "bleed": "14"}


def root_aspect() -> sp.Expr:
    """Square root of chi_l, which is also the width of the ply at the lock."""
    (eps_lock,) = sym("eps_lock")
    return sp.exp(-eps_lock)


def law_definitions() -> list[Definition]:
    """Aspect ratios at lock and limit, stretch at the compaction limit, and the gap to it (below Eq. 5)."""
    chi_ratio, k = sym("chi_ratio", "k_gap")
    root_chi_l, chi_l, chi_f = sym("root_chi_l", "chi_l", "chi_f")
    stretch, stretch_limit, gap = sym("stretch", "stretch_limit", "gap")
    return [
        Definition(root_chi_l, root_aspect(), "5 (chi_l)"),
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


def factors(stage: str) -> list[Definition]:
    """The factors of g = J ply micro rate/j2_unit, with Eqs. 4a and 5a (`squeeze`) or 4b and 5b (`bleed`) and exp(eps) = stretch."""
    w0, h0, l0_over_d, k, a, b = sym("w0", "h0", "l0_over_d", "k_gap", "a_rate", "b_log")
    root_chi_l, chi_l, stretch, limit, gap, j2_eff = sym("root_chi_l", "chi_l", "stretch", "stretch_limit", "gap", "j2_eff")
    closeness, ply, micro, j2_unit, rate = sym("closeness", "ply", "micro", "j2_unit", "rate")
    common = [
        Definition(closeness, limit / gap, "5", partials={limit: 1 / gap, gap: -closeness / gap}),
        Definition(j2_unit, normaliser(stage), EQUATION[stage]),
        Definition(rate, sp.exp(b) * (j2_eff / j2_unit) ** (a / 2), "3"),
    ]
    if stage == "squeeze":
        return [
            common[0],
            Definition(ply, 2 * (w0 / h0) ** 2 / stretch**4, "4a", stable=2 * _square(w0 / (h0 * stretch**2))),
            Definition(micro, 2 * root_chi_l * stretch * k * (closeness**2 + 3), "5a"),
            *common[1:],
        ]
    return [
        common[0],
        Definition(ply, 2 * (w0 / h0) ** 2 * chi_l / stretch**2, "4b", stable=2 * chi_l * _square(w0 / (h0 * stretch))),
        Definition(micro, 2 * l0_over_d**2 * k * closeness**2, "5b", stable=2 * k * _square(l0_over_d * closeness)),
        *common[1:],
    ]


def _square(ratio: sp.Expr) -> sp.Expr:
    """A square that stays one, for the printed form."""
    return sp.Pow(ratio, 2, evaluate=False)


def viscous_factor() -> sp.Expr:
    """G = 2 d psi_v/d J2 (Eq. 15) in its factors: S_v = g Cdot."""
    det_f, ply, micro, j2_unit, rate = sym("det_f", "ply", "micro", "j2_unit", "rate")
    return det_f * ply * micro * rate / j2_unit


def log_viscous_factor(stage: str) -> sp.Expr:
    """Ln g as a sum of logarithms of what it depends on, with `closeness` by name: what is differentiated."""
    product = viscous_factor()
    for definition in reversed(factors(stage)[1:]):
        product = product.subs(definition.symbol, definition.expr)
    return sp.expand(sp.expand_log(sp.log(product), force=True))
