"""The floor of the rate: at zero rate the tangent of a power law with a < 0 is infinite."""

from __future__ import annotations

import sympy as sp

from umatgen.notation import sym


def floor() -> sp.Expr:
    """Floor of J2 in 1/s^2, which keeps the tangent finite at zero rate: the larger of the two floors, squared."""
    rate_floor, strain_floor, per_time = sym("rate_floor", "strain_floor", "per_time")
    return sp.Max(rate_floor, strain_floor * per_time) ** 2
