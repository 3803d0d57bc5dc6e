"""Section 4.3: C, its rate and the invariants in the squeezing and bleeding states."""

from __future__ import annotations

import sympy as sp

from umataudit.derive.derivation import Comparison, Derivation, Printed, Step, derives, equals
from umataudit.printed.letters import sym

_TIME = sp.Symbol("t", real=True)
SQUEEZING = ("axis 1 compaction, axis 3 inextensible fibre: C33 = 1", "det C = I3, constant before locking")
BLEEDING = ("axis 1 compaction, axis 3 inextensible fibre: C33 = 1", "the width is that of the lock")


def squeezing_c() -> sp.Matrix:
    """C before locking: C22 from det C = I3."""
    lam, i3 = sym("lam I3")
    c22 = sp.Symbol("C22", positive=True)
    (solved,) = sp.solve(lam**2 * c22 - i3, c22)
    return sp.diag(lam**2, solved, 1)


def bleeding_c() -> sp.Matrix:
    """C after locking: C22 is that of an incompressible ply at eps_l, which is chi_l."""
    lam, i3, eps_l, chi_l = sym("lam I3 eps_l chi_l")
    at_lock = squeezing_c()[1, 1].subs({lam: sp.exp(eps_l), i3: 1})
    return sp.diag(lam**2, at_lock.subs(eps_l, -sp.log(chi_l) / 2), 1)


def rate_of(c: sp.Matrix) -> sp.Matrix:
    """Time derivative at the stretch rate lam_dot, everything else constant."""
    lam, lam_dot = sym("lam lam_dot")
    moving = sp.Function("lam_t")(_TIME)
    rate = c.subs(lam, moving).diff(_TIME)
    return rate.subs(sp.diff(moving, _TIME), lam_dot).subs(moving, lam)


def in_c11(expr: sp.Expr) -> sp.Expr:
    """The stretch and its rate in terms of C11 = lam^2 and Cdot11 = 2 lam lam_dot."""
    lam, lam_dot, c11, cdot11 = sym("lam lam_dot C11 Cdot11")
    return sp.simplify(expr.subs(lam_dot, cdot11 / (2 * lam)).subs(lam, sp.sqrt(c11)))


@derives("12-rate")
def stretch_rate(printed: Printed) -> Derivation:
    """Rate of ln(lambda)."""
    lam, lam_dot = sym("lam lam_dot")
    moving = sp.Function("lam_t")(_TIME)
    result = sp.diff(sp.log(moving), _TIME).subs(sp.diff(moving, _TIME), lam_dot).subs(moving, lam)
    return equals(printed, result, ("eps = ln(lambda)",), (Step("differentiate with respect to time", result),))


@derives("12-C")
def c_squeezing(printed: Printed) -> Derivation:
    """Transverse component from det C = I3."""
    result = squeezing_c()
    steps = (Step("det C = lambda^2 C22 = I3", result[1, 1]),)
    return equals(printed, result, SQUEEZING, steps, ("10-I3",), shown="diag(lam**2, I3/lam**2, 1)")


@derives("12-Cdot")
def cdot_squeezing(printed: Printed) -> Derivation:
    """Its rate."""
    result = rate_of(squeezing_c())
    steps = (Step("component 11", result[0, 0]), Step("component 22", result[1, 1]))
    return equals(printed, result, SQUEEZING, steps, ("12-C",), shown="diag(2*lam_dot*lam, -2*I3*lam_dot/lam**3, 0)")


@derives("12-I1")
def i1_squeezing(printed: Printed) -> Derivation:
    """Trace of C."""
    result = sp.expand(in_c11(squeezing_c().trace()))
    return equals(printed, result, SQUEEZING, (Step("trace of C, with lambda^2 = C11", result),), ("12-C",))


@derives("12-J2")
def j2_squeezing(printed: Printed) -> Derivation:
    """(1/2) Cdot : Cdot, with C11 + I3/C11 = I1 - 1."""
    c11, cdot11, i1, i3 = sym("C11 Cdot11 I1 I3")
    rate = rate_of(squeezing_c())
    direct = in_c11((rate * rate).trace() / 2)
    norm = sp.expand((c11 + i3 / c11) ** 2 - 2 * i3)
    front = sp.factor(sp.simplify(direct / norm))
    result = front * ((i1 - 1) ** 2 - 2 * i3)
    check = sp.simplify(result.subs(i1, c11 + i3 / c11 + 1) - direct)
    steps = (
        Step("(1/2) Cdot : Cdot, with lambda^2 = C11", direct),
        Step("C11^2 + I3^2/C11^2 = (C11 + I3/C11)^2 - 2 I3 = (I1 - 1)^2 - 2 I3", result),
        Step("difference of the two forms", check),
    )
    factors = {
        "number": sp.Rational(1, 2),
        "rate over C11, squared": (cdot11 / c11) ** 2,
        "bracket": (i1 - 1) ** 2 - 2 * i3,
    }
    shown = "1/2*(Cdot11/C11)**2*((I1 - 1)**2 - 2*I3)"
    return equals(printed, result, SQUEEZING, steps, ("12-Cdot", "12-I1", "4.3-J2"), shown, factors)


@derives("13-I1s", "13-real")
def smaller_root(printed: Printed) -> Derivation:
    """The smaller root of x + I3/x = I1 - 1; for 13-real at C = (1 + delta) 1, where C11 = 1 + delta."""
    c11, i1, i3, delta = sym("C11 I1 I3 delta")
    if printed.relation.id == "13-real":
        state = {i1: 3 * (1 + delta), i3: (1 + delta) ** 3}
        value = printed.value.subs(state)
        under = sp.factor(((i1 - 1) ** 2 - 4 * i3).subs(state))
        steps = (
            Step("(I1 - 1)^2 - 4 I3 at C = (1 + delta) 1", under),
            Step("the compaction stretch squared", 1 + delta),
        )
        comparison = Comparison("value at C = (1 + delta) 1", value, 1 + delta)
        missing = f"the root is of {under} at C = (1 + delta) 1, negative for every small dilation delta > 0"
        premises = ("I1^s is to be the smaller transverse stretch squared",)
        return Derivation(premises, steps, (comparison,), 1 + delta, missing=missing)
    roots = sp.solve(c11 + i3 / c11 - (i1 - 1), c11)
    state = {i1: 1 + sp.Rational(4, 5) + sp.Rational(5, 4), i3: 1}
    result = min(roots, key=lambda root: root.subs(state))
    steps = (
        Step("C11 + I3/C11 = I1 - 1: smaller root", result),
        Step("at C11 = 4/5, I3 = 1 it gives", result.subs(state)),
    )
    return equals(
        printed, result, (*SQUEEZING, "compaction: C11 is the smaller transverse component"), steps, ("12-I1",)
    )


@derives("14-C")
def c_bleeding(printed: Printed) -> Derivation:
    """C22 stays that of the lock."""
    result = bleeding_c()
    steps = (Step("at the lock C22 = 1/lambda^2 = exp(-2 eps_l), with J = 1", result[1, 1]),)
    return equals(printed, result, BLEEDING, steps, ("12-C", "5-chi_l"), shown="diag(lam**2, chi_l, 1)")


@derives("14-Cdot")
def cdot_bleeding(printed: Printed) -> Derivation:
    """Its rate."""
    result = rate_of(bleeding_c())
    steps = (Step("component 11", result[0, 0]),)
    return equals(printed, result, BLEEDING, steps, ("14-C",), shown="diag(2*lam_dot*lam, 0, 0)")


@derives("14-I1")
def i1_bleeding(printed: Printed) -> Derivation:
    """Trace of C."""
    result = in_c11(bleeding_c().trace())
    return equals(printed, result, BLEEDING, (Step("trace of C, with lambda^2 = C11", result),), ("14-C",))


@derives("14-J2")
def j2_bleeding(printed: Printed) -> Derivation:
    """(1/2) Cdot : Cdot."""
    rate = rate_of(bleeding_c())
    result = in_c11((rate * rate).trace() / 2)
    return equals(printed, result, BLEEDING, (Step("(1/2) Cdot : Cdot", result),), ("14-Cdot", "4.3-J2"))


@derives("14-I1b")
def i1b_is_c11(printed: Printed) -> Derivation:
    """C11 from the trace of C after locking."""
    c11, i1 = sym("C11 I1")
    trace = in_c11(bleeding_c().trace())
    (result,) = sp.solve(trace - i1, c11)
    return equals(printed, result, BLEEDING, (Step("I1 =", trace), Step("solved for C11", result)), ("14-C", "14-I1"))
