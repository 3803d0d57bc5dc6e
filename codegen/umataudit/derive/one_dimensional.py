"""Table 1 and Eqs. 1 to 4: the squeeze-flow solutions, the product form and the ply term."""

from __future__ import annotations

import sympy as sp

from umataudit.derive.derivation import Comparison, Defined, Derivation, Printed, Step, derives, equals
from umataudit.derive.flow_states import time_derivative
from umataudit.derive.squeeze_flow import PREMISES, RATE, constant_volume, constant_width, strip_flow
from umataudit.printed.letters import sym

_SHAPES = {"": constant_volume, "constant width": constant_width}
_SHAPE_STEP = {
    "": "the volume under the plates stays constant: $w = w0 exp(-eps)$, $h = h0 exp(eps)$",
    "constant width": "the width under the plates stays $w0$: $h = h0 exp(eps)$",
}


@derives("T1.1")
def rogers(printed: Printed) -> Derivation:
    """Mean pressure of a Newtonian strip over the rate: the volume constant as the row says, or the width as in row 2."""
    flow = strip_flow(newtonian=True)
    m, eta_micro = sym("m eta_micro")
    over_rate = (flow.pressure / RATE).subs(m, eta_micro)
    result = _SHAPES[printed.under](over_rate)
    steps = (*flow.steps, Step(_SHAPE_STEP[printed.under] + "; over the rate", result))
    w0, h0, w, h = sym("w0 h0 w h")
    words = Comparison("the row's words, volume under the plates constant", _SHAPES[printed.under](w * h), w0 * h0)
    return equals(printed, result, PREMISES, steps, also=(words,))


@derives("T1.2")
def wang_gutowski(printed: Printed) -> Derivation:
    """Mean pressure of a power-law strip over the rate, with f(n) for what depends on n alone."""
    n, f_n, m, w, h, eps_dot = sym("n f_n m w h eps_dot")
    flow = strip_flow()
    factor = sp.simplify(flow.pressure / (m * (w / h) ** (n + 1) * RATE**n))
    result = _SHAPES[printed.under](f_n * (-eps_dot) ** (n - 1) * m * (w / h) ** (n + 1))
    steps = (
        *flow.steps,
        Step("what depends on the exponent alone is $f_n$; 1 for $n = 1$, as row 1 has it", factor),
        Step(_SHAPE_STEP[printed.under], result),
    )
    check = Comparison("$f_n$ holds nothing but $n$", sp.Integer(len(factor.free_symbols - {n})), sp.S.Zero)
    return equals(printed, result, PREMISES, steps, also=(check,))


@derives("T1.3")
def kelly(printed: Printed) -> Derivation:
    """No formula is printed."""
    comparisons = [Comparison("a formula", printed.value, printed.value)] if printed.relation.readings else []
    return Derivation(
        (), (), tuple(comparisons), missing="printed in words, without a formula",
        proviso="taken as printed: the source (Kelly 2011) is not part of the paper",
    )  # fmt: skip


@derives("1-rate")
def hencky_rate(printed: Printed) -> Derivation:
    """Time derivative of ln(h/h0)."""
    h0, h, h_dot = sym("h0 h h_dot")
    result = time_derivative(sp.log(h / h0), h, h_dot)
    return equals(printed, result, (Defined("$eps = ln(h/h0)$"),), (Step("differentiate with respect to time", result),))


@derives("1")
def product_form(printed: Printed) -> Derivation:
    """The squeeze-flow pressure of Table 1, split into strain and rate factor, as a stress."""
    eta_strain, eta_rate, eps_dot, f_n, n, m, w, h = sym("eta_strain eta_rate eps_dot f_n n m w h")
    pressure = f_n * m * (w / h) ** (n + 1) * (-eps_dot) ** n
    rate_part = f_n * (-eps_dot) ** (n - 1)
    strain_part = sp.powsimp(pressure / (rate_part * (-eps_dot)))
    stress = -sp.powsimp(rate_part * strain_part * (-eps_dot))
    check = Comparison("pressure is minus stress", stress, -pressure)
    result = -eta_strain * eta_rate * (-eps_dot)
    steps = (
        Step("pressure of row 2 of Table 1", pressure),
        Step("its rate factor $eta_rate$", rate_part),
        Step("its strain factor $eta_strain$", strain_part),
        Step("stress = -pressure; product of the two factors and the rate", result),
    )
    premises = ("Table 1, row 2", "compaction: the rate is negative, the stress compressive")
    return equals(printed, result, premises, steps, ("T1.2",), also=(check,))


@derives("2")
def rate_law(printed: Printed) -> Derivation:
    """Rate factor of Table 1 with a = n - 1 and the material constant f(n) written exp(b) or exp(b-bar)."""
    a, b, b_bar, n, f_n, eps_dot = sym("a b b_bar n f_n eps_dot")
    table = f_n * (-eps_dot) ** (n - 1)
    constant = sp.exp(b_bar if printed.under == "bar" else b)
    result = table.subs({n: a + 1, f_n: constant})
    steps = (Step("rate factor of Table 1, row 2", table), Step("$n = a + 1$, and a name for $f_n$", result))
    return equals(printed, result, ("Table 1, row 2", "the rate by its magnitude"), steps, ("T1.2",))


@derives("3")
def two_scales(printed: Printed) -> Derivation:
    """Eq. 1 with eta_strain = eta_micro eta_ply."""
    eta_strain, eta_micro, eta_ply = sym("eta_strain eta_micro eta_ply")
    first = printed.of("1")
    result = first.subs(eta_strain, eta_micro * eta_ply)
    steps = (Step("Eq. 1", first), Step("$eta_strain$ is the product of fibre and ply term", result))
    return equals(printed, result, ("Eq. 1", "$eta_strain = eta_micro eta_ply$"), steps, ("1",))


@derives("4-strain")
def transverse_strain(printed: Printed) -> Derivation:
    """Incompressible, fibre inextensible."""
    eps = sym("eps")[0]
    transverse = sp.Symbol("eps_t", real=True)
    (result,) = sp.solve(sp.log(sp.exp(eps) * sp.exp(transverse)).expand(force=True), transverse)
    steps = (Step("$J = exp(eps) exp(eps_transverse) = 1$, fibre stretch 1", result),)
    return equals(printed, result, ("incompressible flow", "inextensible fibre"), steps)


@derives("4a", "4b")
def ply_term(printed: Printed) -> Derivation:
    """Rogers' (w/h)^2 while the width grows, or with that of the lock, compared in full or up to a constant factor."""
    m, w0, h0, w, h, eps, eps_l = sym("m w0 h0 w h eps eps_l")
    flow = strip_flow(newtonian=True)
    over = flow.pressure / (m * RATE)
    shape, what = constant_volume(over), "volume constant: $w = w0 exp(-eps)$, $h = h0 exp(eps)$"
    if printed.relation.id == "4b":
        shape = sp.expand_power_base(over.subs({w: w0 * sp.exp(-eps_l), h: h0 * sp.exp(eps)}))
        what = "the width stays that of the lock: $w = w0 exp(-eps_l)$, $h = h0 exp(eps)$"
    steps = (*flow.steps, Step(f"{what}; over $eta_micro$ and the rate", shape))
    if printed.under != "factor":
        return equals(printed, shape, PREMISES, steps)
    comparisons = tuple(
        Comparison(f"slope of the logarithm over ${name.name}$", _log_slope(printed.value, name), _log_slope(shape, name))
        for name in (eps, eps_l, w0, h0)
    )
    sign = Comparison("sign", sp.sign(printed.value), sp.sign(shape))
    return Derivation(PREMISES, steps, (*comparisons, sign), shape)


def _log_slope(expr: sp.Expr, name: sp.Symbol) -> sp.Expr:
    return sp.simplify(sp.diff(expr, name) / expr)


@derives("4-lock")
def ply_continuity(printed: Printed) -> Derivation:
    """Eq. 4b over Eq. 4a at eps = eps_l."""
    eps, eps_l = sym("eps eps_l")
    result = sp.simplify((printed.of("4b") / printed.of("4a")).subs(eps, eps_l))
    return equals(printed, result, ("Eqs. 4a, 4b",), (Step("Eq. 4b over Eq. 4a at $eps = eps_l$", result),), ("4a", "4b"))


@derives("4-power")
def ply_term_power_law(printed: Printed) -> Derivation:
    """The ply term of a fluid with the rate exponent a of Eq. 2, with the prefactor of Eq. 4."""
    a, n, m, f_n, w, h = sym("a n m f_n w h")
    exponent = sp.S.One if printed.under == "newtonian" else a + 1
    shape = constant_volume((w / h) ** (n + 1)).subs(n, exponent)
    result = 2 * shape
    steps = (
        Step("Table 1, row 2: width over thickness to the $n + 1$", f_n * m * (w / h) ** (n + 1)),
        Step(f"$n = {exponent}$, volume constant, prefactor of Eq. 4", result),
    )
    premises = ("Table 1, row 2", "the same fluid flows at the ply scale and follows Eq. 2: $n = a + 1$")
    return equals(printed, result, premises, steps, ("T1.2", "2"))
