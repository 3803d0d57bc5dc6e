"""The creep-exact increment: the power mean of the viscosity over the strain path in place of its value at the end.

Under constant load the law separates: with m = 1/(a+1) the integral of eta^m over the strain of an increment is p^m dt. So

    s = [(1/dt) integral of eta^m d|eps|]^(1/m)

is the exact stress of an increment of pure compaction whatever its length, the lock inside it included. The factor R brings
g of the backward difference there: it exchanges eta(eps1) for the mean, and the increments of C33 and C22 for that of eps.

A load that changes in the increment leaves s behind its end value by half an increment. The logarithm of s is extrapolated from
the last increment, s_end = s (s/s_last)^theta with theta = dt/(dt + dt_last): of second order, and an error of s_last comes back
with the factor theta/(1 + theta) only. No extrapolation (theta = 0) in the first increment of a step, where loads may kink, and
where the compaction rests or turns.
"""

from __future__ import annotations

import sympy as sp

from umatgen.model.chain import Definition
from umatgen.notation import sym

PATH = {"squeeze": (3, 3), "bleed": (0, 2)}  # ply micro = constant (closeness^2 + plus)/stretch^power
PANELS = 8
SMALL_STEP, SMALL_STRAIN = 0.05, 1.0e-8  # below them series stand for quotients that cancel

S, PLUS, POWER, EXPONENT = sp.symbols("s plus power exponent", positive=True)
STEP = sp.Symbol("step", real=True)
DELTA, QUOTIENT, ACROSS = sp.symbols("delta quotient across", real=True)
U33, U22, FIRST, SECOND = sp.symbols("u33 u22 first second", real=True)
MEAN = sp.Symbol("mean", real=True)


def shape() -> sp.Expr:
    """What of ply micro depends on the stretch."""
    (limit,) = sym("stretch_limit")
    return ((limit / (S - limit)) ** 2 + PLUS) / S**POWER


def log_integrand() -> sp.Expr:
    """ln(shape^m/s): the integral over ln s becomes one over s."""
    return EXPONENT * sp.log(shape()) - sp.log(S)


def slope_of_log_integrand() -> sp.Expr:
    """Its derivative by s, with s - limit unexpanded."""
    (limit,) = sym("stretch_limit")
    close = limit / (S - limit)
    return -EXPONENT * (2 * close**2 / ((S - limit) * (close**2 + PLUS)) + POWER / S) - 1 / S


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
