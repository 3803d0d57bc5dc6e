"""The appendix: Eq. A.1, the cell areas, V_f = k^2 and what happens to the fibre fraction after locking."""

from __future__ import annotations

import sympy as sp

from umataudit.derive.derivation import Comparison, Derivation, Printed, Step, derives, equals
from umataudit.printed.letters import sym
from umataudit.printed.units import UnitError, unit_of

_NO_FIGURE = "the sketch (Fig. A.1) from which it was arranged is missing"


@derives("A.1-A0", "A.1-Af")
def cell_area(printed: Printed) -> Derivation:
    """Fibre area over fibre fraction."""
    r, area = sym("r A0")
    (fraction,) = sym("V0" if printed.relation.id == "A.1-A0" else "Vf")
    share = sp.Rational(1, 2) if printed.under == "half" else sp.S.One
    (whole,) = sp.solve(fraction - sp.pi * r**2 / area, area)
    result = share * whole
    steps = (Step("one fibre, pi r^2, is its fraction of the cell: cell area", whole), Step("area taken", result))
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
        Step("area at the limit A_f = s^2 sin(alpha_f): s^2", square),
        Step("area at locking A_0 = s^2 sin(alpha): sin(alpha)", sine_at_lock),
        Step("acute angle", result),
    )
    assumed = "both cells are rhombi of one side s, a geometry that gives the printed form"
    premises, proviso = (assumed, "alpha is acute"), f"{assumed}: {_NO_FIGURE}"
    return equals(printed, result, premises, steps, ("A.1-A0", "A.1-Af"), proviso=proviso)


@derives("A.1-alpha_f")
def limit_angle(printed: Printed) -> Derivation:
    """Only the units can be checked."""
    arctan = printed.reading.formula.tree
    try:
        unit = unit_of(arctan).unit
        said = "units fit"
    except UnitError as error:
        unit, said = sp.Symbol("unit", positive=True), str(error)
    return Derivation(
        ("the argument of arctan is a number",), (Step(said),), (Comparison("unit of the angle", unit, sp.S.One),),
        missing=f"{said}, and {_NO_FIGURE}", proviso=f"taken as given: {_NO_FIGURE}",
    )  # fmt: skip


@derives("A.1")
def locking_angle(printed: Printed) -> Derivation:
    """Smallest argument of the arcsine over all angles alpha; above 1 there is no real angle."""
    a0, v0, d, alpha = sym("A0 V0 d alpha")
    area = printed.of("A.1-A0").subs(sym("r")[0], d / 2)
    value = printed.value.subs(a0, area)
    premises = ("A0 = pi r^2/(2 V0), d = 2 r, V0 = 1/2", "gamma_lock is a real angle")
    if not isinstance(value, sp.asin):
        return Derivation(premises, (), (Comparison("an arcsine", value, sp.asin(value)),), missing=_NO_FIGURE)
    cotangent = sp.Symbol("cot", positive=True)
    half_angle = {
        sp.sin(2 * alpha): 2 * cotangent / (1 + cotangent**2),
        sp.cos(2 * alpha): (cotangent**2 - 1) / (1 + cotangent**2),
    }
    argument = sp.simplify(value.args[0].subs(half_angle))
    turning = [root for root in sp.solve(sp.diff(argument, cotangent), cotangent) if root.is_positive]
    smallest = sp.simplify(argument.subs(cotangent, turning[0])) if len(turning) == 1 else sp.S.Zero
    half = {v0: sp.Rational(1, 2)}
    if smallest.free_symbols - {v0}:
        return Derivation(
            premises, (), (Comparison("an argument of alpha alone", smallest, sp.S.Zero),), missing=_NO_FIGURE
        )
    needed = [root for root in sp.solve(smallest - 1, v0) if root.is_positive]
    argument, smallest = argument.subs(half), sp.simplify(smallest.subs(half))
    steps = (
        Step("argument of the arcsine with c = cot(alpha)", argument),
        Step("its smallest value over all alpha", smallest),
        Step("as a number", sp.N(smallest, 8)),
        Step(
            "for k = 0.813 (IM7-8552, 70 C), V_f = k^2 and d squared in alpha_f it is", _at_table(argument, cotangent)
        ),
        *(Step("the smallest value is 1, a real angle for one alpha, at V0 =", sp.N(root, 6)) for root in needed),
    )
    excess = sp.Max(sp.nsimplify(smallest) - 1, 0)
    missing = f"no real angle: the argument of the arcsine is at least {sp.N(smallest, 5)} for every alpha (V0 = 50 %); {_NO_FIGURE}"
    comparison = Comparison("excess of the argument over 1", excess, sp.S.Zero)
    return Derivation(
        premises, steps, (comparison,), uses=("A.1-A0",), missing=missing, proviso=f"taken as given: {_NO_FIGURE}"
    )


def _at_table(argument: sp.Expr, cotangent: sp.Symbol) -> sp.Expr:
    """The argument of the arcsine with the angles of the lines below Eq. A.1, for V_f = 0.813^2."""
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
        Step("Eq. 5b is singular at exp(eps) =", at_limit),
        Step("volume there over the initial one, width fixed at exp(-eps_l) = sqrt(chi_l)", volume),
        Step("fibre fraction", result),
        Step("IM7-8552 at 70 C (k = 0.813), chi_l = 0.7 chi_f", check),
        Step("k^2 there", sp.N(sp.Rational("0.813") ** 2, 5)),
    )
    return equals(printed, result, ("Eq. 5b", "V0 until locking, fibres conserved"), steps, ("5b", "5-chi_l"))


def _square_fibre(printed: Printed) -> Derivation:
    """Area of a fibre of edge d over its cell d/k x d/k."""
    k, d = sym("k d")
    side = sp.Symbol("s", positive=True)
    (cell,) = sp.solve(d / side - k, side)
    result = d**2 / cell**2
    said = Step("side of the cell, of which the fibre covers the share k", cell)
    premises = ("square fibre of edge d", "it covers the share k of both faces (5-k)")
    return equals(printed, result, premises, (said, Step("fibre area over cell area", result)), ("5-k",))


@derives("A.1-trend")
def fraction_after_locking(printed: Printed) -> Derivation:
    """Fibre fraction V0/J with the width fixed."""
    eps, eps_l, v0 = sym("eps eps_l V0")
    fraction = v0 / sp.exp(eps - eps_l)
    slope = -sp.diff(fraction, eps)
    result = sp.sign(slope)
    steps = (
        Step("fibre fraction after locking: V0/J, J = exp(eps - eps_l)", fraction),
        Step("its change in compaction, -d/d eps", slope),
    )
    return equals(printed, result, ("fibres stay, resin leaves (section 3.1)",), steps)
