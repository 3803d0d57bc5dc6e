"""Rate of C at the end of an increment: one-step (the paper's) and two-step formulas of variable step size.

With r = (C1 - C0)/dt, r' the same over the increment before, dt' its length, and theta = dt/(dt + dt'):

    bdf1      Cdot = r
    bdf2      Cdot = (1 + theta) r - theta r'                       the variable-step BDF2
    bdf2log   Cdot = m [(1 + theta) r - theta s r'],  s = (|r|/|r'|), m = s^theta

`bdf2log` extrapolates the magnitude of the rate in its logarithm and only its direction linearly. The order is the same, two;
but Cdot vanishes with r and never turns against it, as bdf2 does where a load falls, and a rate that decays like a power of
time is met with less error. |r|^2 = 2 J stands for r:r, with the floor of J2 added on both sides, so nothing is 0/0.

The increment before counts only where the rate is smooth: not in the first increment of a step, not across the lock, and not
after an increment at rest (rate below the floor), from which `bdf2log` would take the rate far too high: m = s^theta.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from umatgen.notation import sym

GROWTH, RATIO = sp.symbols("growth rate_ratio", positive=True)


@dataclass(frozen=True)
class RateFormula:
    """Cdot = gain * r - back * r' of an integrator, and its derivative by r: slope * dr + turn * (Cdot - growth r) (r:dr).

    gain, back, slope [-], turn [s^2]; zero `turn`: the formula is linear in r.
    """

    gain: sp.Expr
    back: sp.Expr
    slope: sp.Expr
    turn: sp.Expr


def rate_formula(integrator: str) -> RateFormula:
    """Coefficients of an integrator in `history` (theta), `growth` (m), `rate_ratio` (s) and the floored J of r."""
    theta, j2_mean, j2_floor = sym("history", "j2_mean", "j2_floor")
    if integrator == "bdf2":
        return RateFormula(1 + theta, theta, 1 + theta, sp.S.Zero)
    if integrator == "bdf2log":
        gain = GROWTH * (1 + theta)
        return RateFormula(gain, GROWTH * theta * RATIO, gain, (1 + theta) / (2 * (j2_mean + j2_floor)))
    return RateFormula(sp.S.One, sp.S.Zero, sp.S.One, sp.S.Zero)


def ratio_of_rates() -> sp.Expr:
    """S, with the floor on both sides."""
    j2_mean, j2_before, j2_floor = sym("j2_mean", "j2_before", "j2_floor")
    return sp.sqrt((j2_mean + j2_floor) / (j2_before + j2_floor))


def growth_of_rate() -> sp.Expr:
    """Value of m."""
    (theta,) = sym("history")
    return RATIO**theta


def floor() -> sp.Expr:
    """Floor of J2 in 1/s^2, which keeps the tangent finite at zero rate: the larger of the two floors, squared."""
    rate_floor, strain_floor, per_time = sym("rate_floor", "strain_floor", "per_time")
    return sp.Max(rate_floor, strain_floor * per_time) ** 2
