"""Kinematics: the compaction stretch along the ply normal, and the paper's smallest transverse eigenvalue.

With the fibre n, the ply normal N and t across both, A is the transverse block of C (components tt, tN, NN, here 22, 23, 33).
Section 4.4 speaks of the compaction direction, an input: x = 1/(N . C^-1 N) is the squared stretch of the ply thickness along
it, smooth everywhere. The paper's I1 - 1, I3 and I1^s are, for an inextensible and unsheared fibre, tr A, det A and the
smallest eigenvalue of A, which is x as long as N stays its direction.
"""

from __future__ import annotations

import sympy as sp

from umatgen.model.chain import Definition
from umatgen.notation import sym


def transverse_norm() -> Definition:
    """A:A."""
    a22, a33, a23, a_norm2 = sym("a22", "a33", "a23", "a_norm2")
    return Definition(a_norm2, a22**2 + a33**2 + 2 * a23**2, "13 ((I1-1)^2 - 2 I3)")


def normal_definitions() -> list[Definition]:
    """Squared stretch x along the ply normal by Nanson's formula, the stretch and A:A; dx/dC is a rule of the generators."""
    det_f, area2, x_end, stretch = sym("det_f", "area2", "x_end", "stretch")
    return [
        Definition(x_end, det_f**2 / area2, "4.4"),
        Definition(stretch, sp.sqrt(x_end), "13", partials={x_end: 1 / (2 * stretch)}),
        transverse_norm(),
    ]


def mohr_definitions() -> list[Definition]:
    """Mohr's circle of A: half difference, radius, smallest eigenvalue x, stretch sqrt(x) and norm A:A.

    `cos2 = a_diff/radius` and `sin2 = a23/radius` are inputs of the chain: bounded names for the two ratios that are
    0/0 where the transverse stretches coincide. There they are set to 0, which gives the mean of all admissible
    directions: dx/dC = (1/2)(p2 (x) p2 + p3 (x) p3).
    """
    a22, a33, a23 = sym("a22", "a33", "a23")
    a_diff, radius, cos2, sin2 = sym("a_diff", "radius", "cos2", "sin2")
    area2, x_end, stretch = sym("area2", "x_end", "stretch")
    mean = (a22 + a33) / 2
    return [
        Definition(a_diff, (a22 - a33) / 2, "4.3"),
        Definition(radius, sp.sqrt(a_diff**2 + a23**2), "4.3", partials={a_diff: cos2, a23: sin2}),
        Definition(area2, a22 * a33 - a23**2, "4.3"),
        Definition(
            x_end,
            mean - radius,
            "13 (I1^s)",
            stable=area2 / (mean + radius),
            partials={a22: sp.Rational(1, 2), a33: sp.Rational(1, 2), radius: -sp.S.One},
        ),
        Definition(stretch, sp.sqrt(x_end), "13", partials={x_end: 1 / (2 * stretch)}),
        transverse_norm(),
    ]


def compaction_definitions(compaction: str) -> list[Definition]:
    """Definitions that ln g is differentiated through: x along the normal and A:A are invariants of their own there."""
    return mohr_definitions() if compaction == "smallest" else normal_definitions()[1:2]


def rate_definitions() -> list[Definition]:
    """J2 with its floor (MODEL: zero rate makes the tangent infinite because a < 0)."""
    j2, j2_floor, j2_eff = sym("j2", "j2_floor", "j2_eff")
    return [Definition(j2_eff, j2 + j2_floor, "15")]


def strain_rate(compaction: str = "normal") -> sp.Expr:
    """Rate of eps = ln(x)/2 as dx/dC : Cdot / (2 x), with the components of Cdot in the axes n, t, N as symbols cdot_11 ..."""
    (x_end,) = sym("x_end")
    c = {f"{i}{j}": sp.Symbol(f"cdot_{i}{j}", real=True) for i in (1, 2, 3) for j in range(i, 4)}
    if compaction == "smallest":
        cos2, sin2 = sym("cos2", "sin2")
        return ((1 - cos2) * c["22"] / 2 + (1 + cos2) * c["33"] / 2 - sin2 * c["23"]) / (2 * x_end)
    u, v = sym("tilt_1", "tilt_2")
    along = u * (u * c["11"] + 2 * v * c["12"] + 2 * c["13"]) + v * (v * c["22"] + 2 * c["23"]) + c["33"]
    return along / (2 * x_end)
