"""Temperature table of a material: k, a and both b as monotone cubics of temperature (Fritsch and Carlson 1980)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import sympy as sp
from scipy.interpolate import PchipInterpolator

from umatgen.notation import sym

QUANTITIES = {"k": "k_gap", "a": "a_rate", "b_squeeze": "b_squeeze", "b_bleed": "b_bleed"}


@dataclass(frozen=True)
class Cubics:
    """One quantity over temperature: name in Fortran, and c3, c2, c1, c0 of each piece, in s = temperature - its start."""

    name: str
    coefficients: tuple[tuple[float, float, float, float], ...]


def cubics(table: Mapping[str, Sequence[float]], kept: Sequence[str]) -> list[Cubics]:
    """Cubics of the quantities kept; `table` holds temperature [degC] and the four columns, all (n,), n >= 2."""
    found = []
    for name in kept:
        c3, c2, c1, c0 = PchipInterpolator(table["temperature"], table[name]).c.tolist()
        found.append(Cubics(QUANTITIES[name], tuple(zip(c3, c2, c1, c0, strict=True))))
    return found


def slope_of_log_g() -> sp.Expr:
    """D ln g/d theta in 1/degC through k, a and b, and through eps_lock where it follows k, at fixed deformation."""
    names = ("dlng_k_gap", "dk_gap", "dlng_a_rate", "da_rate", "db_log", "dlng_eps_lock", "deps_lock")
    by_k, dk, by_a, da, db, by_lock, dlock = (sp.Symbol(name, real=True) for name in names)
    return (by_k + by_lock * dlock) * dk + by_a * da + db


def stress_slope() -> sp.Expr:
    """DDSDDT = (g/J) (d ln g/d theta) y in MPa/degC: an array in Fortran."""
    g, det_f = sym("g_visc", "det_f")
    slope, rate = sp.symbols("dlng_dtheta y_rate", real=True)
    return g * slope / det_f * rate
