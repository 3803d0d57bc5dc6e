"""The creep-exact increment: the power mean of the viscosity over the strain path in place of its value at the end.

Under constant load the law separates: with m = 1/(a+1) the integral of eta^m over the strain of an increment is p^m dt. So

    s = [(1/dt) integral of eta^m d|eps|]^(1/m)

is the exact stress of an increment of pure compaction whatever its length, the lock inside it included. The factor R brings
g of the backward difference there: it exchanges eta(eps1) for the mean, and the increments of C33 and C22 for that of eps.

A load that changes in the increment leaves s behind its end value. Where it rises it is taken as linear over this increment and
the last, from p_last through p0 to p1 = p0 (1 + e) with p_last = p0 (1 - r e), r = dt_last/dt. Of such a load both means are known,

    s = p0 P(-e)^(1/m),  s_last = p0 P(r e)^(1/m),  P(z) = [1 - max(0, 1 - z)^(m+1)]/((m+1) z),

and from s/s_last follows e, and p1/s. So a linear load is met exactly, whatever the increments, a smooth one to second order, and no
error of an end value comes back, as it would where p1 were found from s and p0. Where the load falls, p1/s = (s/s_last)^(1/(1+r)),
the same to first order. In the first increment of a step, where loads may kink, and where the compaction rests or turns, the load
counts as constant; s_last is then its end value, and r = 0 in the next increment.
"""

from __future__ import annotations

import sympy as sp

from umatgen.model.chain import Definition
from umatgen.notation import sym

PATH = {"squeeze": (3, 3), "bleed": (0, 2)}  # ply micro = constant (closeness^2 + plus)/stretch^power
PANELS, ROUNDS = 3, 4
SMALL_STEP, SMALL_STRAIN, SMALL_REACH = 0.05, 1.0e-8, 0.01  # below them series stand for quotients that cancel
LONGEST_LAST = 10.0  # of r: the last increment counts as at most so many times the length of this one
LARGEST_ORDER = 500.0  # of (m + 1) ln(s/s_last): beyond it p1/s has long reached its bound (m + 1)^(1/m)

S, GAP, PLUS, POWER, EXPONENT = sp.symbols("s gap plus power exponent", positive=True)
STEP = sp.Symbol("step", real=True)
DELTA, QUOTIENT, ACROSS = sp.symbols("delta quotient across", real=True)
U33, U22, FIRST, SECOND = sp.symbols("u33 u22 first second", real=True)
MEAN = sp.Symbol("mean", real=True)
ORDER, REACH, PART = sp.symbols("order reach part", real=True)
LOG_RISE, RATIO, Y, EXCESS, BY_Y = sp.symbols("log_rise ratio y excess by_y", real=True)
AHEAD, BEHIND = sp.symbols("ahead behind", positive=True)
AHEAD_SLOPE, BEHIND_SLOPE = sp.symbols("ahead_slope behind_slope", real=True)


def shape() -> sp.Expr:
    """What of ply micro depends on the stretch."""
    (limit,) = sym("stretch_limit")
    return ((limit / (S - limit)) ** 2 + PLUS) / S**POWER


def log_integrand() -> sp.Expr:
    """ln(shape^m (s - limit)/s) less ln(s - limit): almost linear in ln(s - limit), over which is integrated."""
    (limit,) = sym("stretch_limit")
    return EXPONENT * sp.log((limit / GAP) ** 2 + PLUS) - (EXPONENT * POWER + 1) * sp.log(S)


def slope_of_log_integrand() -> sp.Expr:
    """Derivative of ln(shape^m (s - limit)/s) by ln(s - limit)."""
    (limit,) = sym("stretch_limit")
    close = (limit / GAP) ** 2
    return 1 - 2 * EXPONENT * close / (close + PLUS) - (EXPONENT * POWER + 1) * GAP / S


def panel() -> tuple[sp.Expr, sp.Expr]:
    """Mean of exp over a panel whose exponent rises linearly by STEP from 0, and its derivative by STEP."""
    mean = (sp.exp(STEP) - 1) / STEP
    return mean, (sp.exp(STEP) * (STEP - 1) + 1) / STEP**2


def panel_series(terms: int = 7) -> tuple[sp.Expr, sp.Expr]:
    """Both as power series, for small STEP."""
    mean = sp.Add(*(STEP**i / sp.factorial(i + 1) for i in range(terms)))
    return sp.horner(mean), sp.horner(sp.Add(*(STEP**i / (sp.factorial(i) * (i + 2)) for i in range(terms))))


def quotient() -> tuple[sp.Expr, sp.Expr]:
    """delta/ln(1 + delta) with delta = stretch_start/stretch - 1, and its derivative by delta."""
    strain = 2 * sp.atanh(DELTA / (2 + DELTA))
    value = DELTA / strain
    return value, (1 - QUOTIENT / (1 + DELTA)) * QUOTIENT / DELTA


def definitions() -> list[Definition]:
    """Rates of C33 and C22 over twice that of eps, and how they enter stress and J2; `across` is the share of C22 in j2_unit."""
    return [
        Definition(U33, (1 + DELTA / 2) * QUOTIENT, "6"),
        Definition(U22, U33 / (1 + DELTA) ** 2, "6"),
        Definition(FIRST, (1 - ACROSS) * U33 + ACROSS * U22, "6"),
        Definition(SECOND, (1 - ACROSS) * U33**2 + ACROSS * U22**2, "6"),
    ]


def ramp_mean(terms: int = 6) -> tuple[tuple[sp.Expr, sp.Expr], tuple[sp.Expr, sp.Expr]]:
    """P(REACH) and its derivative, m + 1 = ORDER: power series for a small REACH, and in full with PART = max(0, 1 - REACH)^m."""
    n, z = ORDER, REACH
    value = slope = sp.Integer(1)
    for i in range(terms - 1, 0, -1):
        value = 1 + (i - n) / (i + 1) * z * value
        slope = 1 + sp.Rational(i, i - 1) * (i - n) / (i + 1) * z * slope if i > 1 else (1 - n) / 2 * slope
    return (value, slope), ((1 - PART * sp.Max(0, 1 - z)) / (n * z), (PART - MEAN) / z)


def ramp() -> tuple[sp.Expr, sp.Expr, sp.Expr, sp.Expr]:
    """With y = ln(p1/p0): what ln(s/s_last) is too large, its derivative by y, ln(p1/s), and that by ln(s/s_last)."""
    rise = 1 + EXCESS
    by_y = -rise * (AHEAD_SLOPE / AHEAD + RATIO * BEHIND_SLOPE / BEHIND) / EXPONENT
    history = (1 + rise * AHEAD_SLOPE / (EXPONENT * AHEAD)) / BY_Y
    return sp.log(AHEAD / BEHIND) / EXPONENT - LOG_RISE, by_y, Y - sp.log(AHEAD) / EXPONENT, history


def first_guess() -> sp.Expr:
    """Y from the value and two derivatives of ln(s/s_last) at y = 0, and not above its bound by a large load at the end."""
    slope = (1 + RATIO) / 2
    bend = sp.Max(0, (ORDER + 1) * (1 - RATIO**2) / 12 + (RATIO + RATIO**2) / 2)
    by_slopes = 2 * LOG_RISE / (slope + sp.sqrt(slope**2 + 2 * bend * LOG_RISE))
    return sp.Min(by_slopes, LOG_RISE + sp.log(ORDER) / EXPONENT)


def share_across() -> sp.Expr:
    """Share of C22^2 in A:A in the states of the squeeze law, C22 = 1/C33."""
    (x_end,) = sym("x_end")
    return 1 / (1 + x_end**4)


def log_factor() -> sp.Expr:
    """Ln R."""
    (a,) = sym("a_rate")
    return (a + 1) * sp.log(MEAN) - a / 2 * sp.log(SECOND) - sp.log(FIRST)


def log_of_rate_measure() -> sp.Expr:
    """Ln of the strain rate in s over sqrt(J2/j2_unit)."""
    return sp.log(FIRST) - sp.log(SECOND) / 2
