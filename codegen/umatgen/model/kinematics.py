"""Kinematics: the transverse block A of C and its always-real invariants (MODEL: the printed Eqs. 13-14 use I1, I3).

With the fibre n and the transverse basis p2, p3 orthonormal, A_ab = p_a . C p_b. The paper's I1 - 1, I3 and I1^s are, for
an inextensible fibre, tr A, det A and the smallest eigenvalue of A; written with A they are real in every state.
"""

from __future__ import annotations

import sympy as sp

from umatgen.model.chain import Definition
from umatgen.notation import sym


def transverse_definitions() -> list[Definition]:
    """Mohr's circle of A: half difference, radius, smallest eigenvalue x, stretch sqrt(x) and norm A:A.

    `cos2 = a_diff/radius` and `sin2 = a23/radius` are inputs of the chain: bounded names for the two ratios that are
    0/0 where the transverse stretches coincide. There they are set to 0, which gives the mean of all admissible
    directions: dx/dC = (1/2)(p2 (x) p2 + p3 (x) p3).
    """
    a22, a33, a23 = sym("a22", "a33", "a23")
    a_diff, radius, cos2, sin2 = sym("a_diff", "radius", "cos2", "sin2")
    area2, x_min, stretch, a_norm2 = sym("area2", "x_min", "stretch", "a_norm2")
    mean = (a22 + a33) / 2
    return [
        Definition(a_diff, (a22 - a33) / 2, "sec. 4.3"),
        Definition(radius, sp.sqrt(a_diff**2 + a23**2), "sec. 4.3", partials={a_diff: cos2, a23: sin2}),
        Definition(area2, a22 * a33 - a23**2, "sec. 4.3"),
        Definition(
            x_min,
            mean - radius,
            "13 (I1^s)",
            stable=area2 / (mean + radius),
            partials={a22: sp.Rational(1, 2), a33: sp.Rational(1, 2), radius: -sp.S.One},
        ),
        Definition(stretch, sp.sqrt(x_min), "13", partials={x_min: 1 / (2 * stretch)}),
        Definition(a_norm2, a22**2 + a33**2 + 2 * a23**2, "13 ((I1-1)^2 - 2 I3)"),
    ]


def rate_definitions() -> list[Definition]:
    """J2 with its floor (MODEL: zero rate makes the tangent infinite because a < 0)."""
    j2, j2_floor, j2_eff = sym("j2", "j2_floor", "j2_eff")
    return [Definition(j2_eff, j2 + j2_floor, "15")]


def strain_rate_from_rates() -> sp.Expr:
    """Rate of eps = ln(x)/2 as dx/dC : Cdot / (2 x), with Cdot's transverse components as symbols cdot_22 ..."""
    x_min, cos2, sin2 = sym("x_min", "cos2", "sin2")
    c22, c33, c23 = sp.symbols("cdot_22 cdot_33 cdot_23", real=True)
    return ((1 - cos2) * c22 / 2 + (1 + cos2) * c33 / 2 - sin2 * c23) / (2 * x_min)
