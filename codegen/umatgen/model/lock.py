"""The lock without events (Eq. 6, sec. 4.4): the stage by the end of the increment, the width pushed to that of the lock.

An increment whose end is compacted to eps_lock or beyond obeys the bleed law, and so do all after it. In the increment that
passes the lock, the part of the rate in the ply plane is counted from the width that the ply has at the lock: C0 becomes
D C0 D with D = diag(1, widening, 1) in the axes n, t, N. A free edge then ends at exp(-eps_lock) whatever the increment, by
viscosity alone, and no increment has to end on the lock. D depends on F0 only, so the tangent is that of the bleed law.

J2 leaves the rates in the ply plane out in that increment. With a free edge they vanish at its end and the stress is the same;
but on the way there a trial that is too wide by as much as the lock was passed would have them rule the viscosity, and a plain
Newton iteration on stress ~ |rate|^a rate turns in a circle.
"""

from __future__ import annotations

import sympy as sp

from umatgen.notation import sym


def squared_lock_stretch() -> sp.Expr:
    """X at the lock, exp(2 eps_lock)."""
    (root_chi_l,) = sym("root_chi_l")
    return 1 / root_chi_l**2


def widening() -> sp.Expr:
    """exp(eps0 - eps_lock), the width at the lock over the width at the start of the increment that passes it."""
    x_start, x_lock = sym("x_start", "x_lock")
    return sp.sqrt(x_start / x_lock)


def lock_by_k(fibre_fraction: float) -> dict[str, sp.Expr]:
    """eps_lock and its slope in k by Eqs. A.1 (read with arctan) and 6, in steps, and `bulk`, above which it never lies.

    sine is sin(alpha) of A.1 and edge_tangent tan(gamma_lock), see `plyflow.law.edge_shear`; V0 is `fibre_fraction` [-].
    """
    k, w0, h0 = sym("k_gap", "w0", "h0")
    sine, tangent, by_sine = sp.symbols("sine edge_tangent dtangent", real=True)
    v0 = sp.Float(fibre_fraction)
    ratio = k**2 / v0
    cell = ratio * sp.sin(ratio / (1 + ratio) * sp.atan(2 * k**2 / sp.pi.evalf(20)))
    legs = (sp.pi.evalf(20) / (4 * v0) - sine * sp.sqrt(1 - sine**2)) / sine**2
    edge = -sp.log(1 + 2 * h0 / (3 * w0) * tangent) / 2
    return {
        "sine": cell,
        "edge_tangent": legs,
        "dtangent": sp.diff(legs, sine) * sp.diff(cell, k),
        "eps_lock": edge,
        "deps_lock": sp.diff(edge, tangent) * by_sine,
        "bulk": sp.log(4 * v0 / sp.pi.evalf(20)) / 3,
    }
