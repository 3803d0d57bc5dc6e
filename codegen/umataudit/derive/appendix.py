"""The appendix: Eq. A.1, the cell areas, V_f = k^2 and what happens to the fibre fraction after locking."""

from __future__ import annotations

import sympy as sp

from umataudit.derive.derivation import Derivation, Printed, Step, derives, equals
from umataudit.printed.letters import sym
from umataudit.printed.units import check_units

_NO_FIGURE = "the sketch (Fig. A.1) from which it was arranged is missing"


@derives("A.1-A0", "A.1-Af")
def cell_area(printed: Printed) -> Derivation:
    """Fibre area over fibre fraction."""
    r, area = sym("r A0")
    (fraction,) = sym("V0" if printed.relation.id == "A.1-A0" else "Vf")
    share = sp.Rational(1, 2) if printed.under == "half" else sp.S.One
    (whole,) = sp.solve(fraction - sp.pi * r**2 / area, area)
    result = share * whole
    steps = (Step("one fibre, $pi r^2$, is its fraction of the cell: cell area", whole), Step("area taken", result))
    return equals(printed, result, ("the fibre fraction is fibre area over cell area",), steps)


@derives("A.1-alpha")
def angle_at_locking(printed: Printed) -> Derivation:
    """Rhombic cells of the same side: areas go as the sines of their angles."""
    a0, af, alpha_f = sym("A0 Af alpha_f")
    side, sine = sp.symbols("s q", positive=True)
    square = sp.solve(af - side**2 * sp.sin(alpha_f), side)[0] ** 2
    (sine_at_lock,) = sp.solve(a0 - square * sine, sine)
    result = sp.asin(sine_at_lock)
    steps = (
        Step("area at the limit $Af = s^2 sin(alpha_f)$: $s^2$", square),
        Step("area at locking $A0 = s^2 sin(alpha)$: $sin(alpha)$", sine_at_lock),
        Step("acute angle", result),
    )
    premises = ("both cells are rhombi of one side $s$, a geometry chosen because it gives the printed form", "$alpha$ is acute")
    return equals(
        printed, result, premises, steps, ("A.1-A0", "A.1-Af"), missing=_NO_FIGURE, taken_from=("A.1-alpha",)
    )  # fmt: skip


@derives("A.1-alpha_f")
def limit_angle(printed: Printed) -> Derivation:
    """The power of d that makes the argument of the printed arctangent a number; its other letters as printed."""
    a0, af, d = sym("A0 Af d")
    p = sp.Symbol("p", integer=True)
    (power,) = sp.solve(p - 2, p)
    result = a0 / (a0 + af) * sp.atan(d**power / (4 * af))
    unit = check_units("alpha_f", printed.reading.formula.tree)
    steps = (Step(f"as printed: {unit}"), Step("$d^p/(4 Af)$ is a number for $p$ =", sp.Integer(power)), Step("angle", result))
    return equals(
        printed, result, ("the argument of the arctangent is a number", "all but the power of $d$ as printed"), steps,
        proviso=f"its form taken as given: {_NO_FIGURE}",
    )  # fmt: skip


@derives("A.1")
def locking_angle(printed: Printed) -> Derivation:
    """Parallelogram of sides s and d with the angle alpha between them, two half cells, sheared until the fibres stand in columns."""
    a0, v0, d, alpha = sym("A0 V0 d alpha")
    side = sp.Symbol("s", positive=True)
    (length,) = sp.solve(side * d * sp.sin(alpha) - 2 * a0, side)
    shift, height = side - d * sp.cos(alpha), d * sp.sin(alpha)
    tangent = (shift / height).subs(side, length)
    result = sp.atan(tangent)
    argument = (4 * a0 / d**2 - sp.sin(2 * alpha)) / (1 - sp.cos(2 * alpha))
    area = printed.of("A.1-A0").subs(sym("r")[0], d / 2)
    half = {v0: sp.Rational(1, 2)}
    q = sp.Symbol("q", positive=True)  # cot(alpha)
    of_q = sp.simplify((2 * area / d**2).subs(half) * (1 + q**2) - q)
    (turning,) = sp.solve(sp.diff(of_q, q), q)
    steps = (
        Step("fibres touch along $d$; the other side, from the area $2 A0 = s d sin(alpha)$", length),
        Step("offset of a fibre against the one below, $s - d cos(alpha)$, over the height $d sin(alpha)$", shift / height),
        Step("a ratio of two legs: the tangent of the shear angle, as Eq. 6 takes it", tangent),
        Step("minus the argument that is printed", sp.simplify(tangent - argument)),
        Step("smallest argument over all $alpha$ ($V0 = 50$ %): above 1, an arcsine has no value", sp.simplify(of_q.subs(q, turning))),
        Step("as a number", sp.N(of_q.subs(q, turning), 8)),
        Step("for $k = 0.813$ (IM7-8552, 70 C) and the corrected $alpha_f$ the argument is", _at_table(of_q, q)),
    )
    premises = (
        "$A0$ is half of the area of the cell, a parallelogram of sides $s$ and $d$",
        "$d$, the fibre diameter, is the distance of fibres in contact",
    )
    return equals(printed, result, premises, steps, ("A.1-A0", "A.1-alpha"))


def _at_table(argument: sp.Expr, cotangent: sp.Symbol) -> sp.Expr:
    """The argument of Eq. A.1 with the angles of the lines below it, d squared in alpha_f, for V_f = 0.813^2."""
    v0, vf = sp.Rational(1, 2), sp.Rational("0.813") ** 2
    ratio = vf / v0
    alpha_f = ratio / (1 + ratio) * sp.atan(2 * vf / sp.pi)
    alpha = sp.asin(ratio * sp.sin(alpha_f))
    return sp.N(argument.subs(cotangent, sp.cot(alpha)), 5)


@derives("A.1-Vf")
def limit_fraction(printed: Printed) -> Derivation:
    """Fibre fraction where Eq. 5b is singular; or of a square fibre in its cell."""
    if printed.under == "square fibre":
        return _square_fibre(printed)
    k, chi_l, chi_f, v0, eps = sym("k chi_l chi_f V0 eps")
    stretch = sp.Symbol("y", positive=True)
    (at_limit,) = sp.solve(1 / printed.of("5b").subs(sp.exp(eps), stretch).subs(eps, sp.log(stretch)), stretch)[:1]
    volume = sp.simplify(at_limit / sp.sqrt(1 / chi_l))
    result = v0 / volume
    check = sp.N(result.subs({v0: sp.Rational(1, 2), chi_l: sp.Rational(7, 10) * chi_f, k: sp.Rational("0.813")}), 5)
    steps = (
        Step("Eq. 5b is singular at $exp(eps)$ =", at_limit),
        Step("volume there over the initial one, width fixed at $exp(-eps_l) = sqrt(chi_l)$", volume),
        Step("fibre fraction", result),
        Step("IM7-8552 at 70 C ($k = 0.813$), $chi_l = 0.7 chi_f$", check),
        Step("$k^2$ there", sp.N(sp.Rational("0.813") ** 2, 5)),
    )
    return equals(printed, result, ("Eq. 5b", "$V0$ until locking, fibres conserved"), steps, ("5b", "5-chi_l"))


def _square_fibre(printed: Printed) -> Derivation:
    """Area of a fibre of edge d over its cell d/k x d/k."""
    k, d = sym("k d")
    side = sp.Symbol("s", positive=True)
    (cell,) = sp.solve(d / side - k, side)
    result = d**2 / cell**2
    said = Step("side of the cell, of which the fibre covers the share $k$", cell)
    premises = ("square fibre of edge $d$", "it covers the share $k$ of both faces (5-k)")
    steps = (said, Step("fibre area over cell area", result))
    return equals(printed, result, premises, steps, missing="an assumption; the share is that of 5-k", taken_from=("5-k",))


@derives("A.1-trend")
def fraction_after_locking(printed: Printed) -> Derivation:
    """Fibre fraction V0/J with the width fixed."""
    eps, eps_l, v0 = sym("eps eps_l V0")
    fraction = v0 / sp.exp(eps - eps_l)
    slope = -sp.diff(fraction, eps)
    result = sp.sign(slope)
    steps = (
        Step("fibre fraction after locking: $V0/J$, $J = exp(eps - eps_l)$", fraction),
        Step("its change in compaction, minus its derivative to $eps$", slope),
    )
    return equals(printed, result, ("fibres stay, resin leaves (section 3.1)",), steps)
