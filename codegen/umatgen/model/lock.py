"""The lock as a C1 blend over a stated strain width, for those who want the smooth transition the paper speaks of.

With s the smoothstep of the strain over the window of width delta centred at eps_lock, g = (1-s) g_squeeze + s g_bleed and
the penalty fades as (1-s) kappa. s never falls: once locked stays locked. Like f, s sees C as a parameter of the potential
and enters the tangent through its derivative only.
"""

from __future__ import annotations

import sympy as sp

from umatgen.model.chain import Definition
from umatgen.notation import sym

G_SQUEEZE, G_BLEED = sp.symbols("g_squeeze g_bleed", positive=True)
S_START, BLEND_WIDTH = sp.symbols("s_start blend_width", real=True)
EPS, XI, S_NOW, S_LOCK, DS = sp.symbols("eps xi s_now s_lock ds_dstretch", real=True)


def smoothstep(x: sp.Expr) -> sp.Expr:
    """C1 step from 0 at x = 0 to 1 at x = 1."""
    return x**2 * (3 - 2 * x)


def window_position() -> sp.Expr:
    """Position in the window before clipping to [0, 1]: 0 where the blend begins, 1 where it ends."""
    (eps_lock,) = sym("eps_lock")
    return (eps_lock - EPS) / BLEND_WIDTH + sp.Rational(1, 2)


def slope_of_step() -> sp.Expr:
    """ds/dstretch inside the window, with eps = ln(stretch)."""
    (stretch,) = sym("stretch")
    return sp.factor(sp.diff(smoothstep(XI), XI) * sp.diff(window_position(), EPS)) / stretch


def blended_factor() -> Definition:
    """G of the blend."""
    (g_visc,) = sym("g_visc")
    return Definition(g_visc, (1 - S_LOCK) * G_SQUEEZE + S_LOCK * G_BLEED, "13, 14 blended")


def blended_slope(squeeze: sp.Symbol, bleed: sp.Symbol) -> sp.Expr:
    """D ln g from d ln g_squeeze and d ln g_bleed at fixed s."""
    g = blended_factor()
    return (sp.diff(g.expr, G_SQUEEZE) * G_SQUEEZE * squeeze + sp.diff(g.expr, G_BLEED) * G_BLEED * bleed) / g.symbol


def slope_through_step() -> sp.Expr:
    """D ln g/dstretch through s."""
    g = blended_factor()
    return sp.diff(g.expr, S_LOCK) * DS / g.symbol
