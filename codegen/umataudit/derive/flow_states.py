"""Section 4.3: C, its rate and the invariants in the squeezing ("12") and bleeding ("14") states."""

from __future__ import annotations

import sympy as sp

from umataudit.derive.derivation import Comparison, Defined, Derivation, Printed, Step, derives, equals
from umataudit.printed.letters import sym

_TIME = sp.Symbol("t", real=True)
SQUEEZING = ("axis 1 compaction, axis 3 inextensible fibre: $C_33 = 1$", "$det(C) = I3$, constant before locking")
BLEEDING = ("axis 1 compaction, axis 3 inextensible fibre: $C_33 = 1$", "the width is that of the lock")
_PREMISES = {"12": SQUEEZING, "14": BLEEDING}
_SHOWN = {
    "12-C": "diag(lam**2, I3/lam**2, 1)", "12-Cdot": "diag(2*lam_dot*lam, -2*I3*lam_dot/lam**3, 0)",
    "14-C": "diag(lam**2, chi_l, 1)", "14-Cdot": "diag(2*lam_dot*lam, 0, 0)",
}  # fmt: skip


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


def _state(printed: Printed) -> tuple[str, sp.Matrix]:
    """Equation of the state that a relation is about, and C in it."""
    number = printed.relation.id[:2]
    return number, squeezing_c() if number == "12" else bleeding_c()


def time_derivative(expr: sp.Expr, moving: sp.Symbol, rate: sp.Symbol) -> sp.Expr:
    """Derivative to time when one symbol moves at a rate, everything else constant."""
    path = sp.Function(f"{moving.name}_t")(_TIME)
    return expr.subs(moving, path).diff(_TIME).subs(sp.diff(path, _TIME), rate).subs(path, moving)


def rate_of(c: sp.Matrix) -> sp.Matrix:
    """Time derivative of C at the stretch rate lam_dot."""
    return time_derivative(c, *sym("lam lam_dot"))


def in_c11(expr: sp.Expr) -> sp.Expr:
    """The stretch and its rate in terms of C11 = lam^2 and Cdot11 = 2 lam lam_dot."""
    lam, lam_dot, c11, cdot11 = sym("lam lam_dot C11 Cdot11")
    return sp.simplify(expr.subs(lam_dot, cdot11 / (2 * lam)).subs(lam, sp.sqrt(c11)))


@derives("12-rate")
def stretch_rate(printed: Printed) -> Derivation:
    """Rate of ln(lambda)."""
    lam, lam_dot = sym("lam lam_dot")
    result = time_derivative(sp.log(lam), lam, lam_dot)
    return equals(printed, result, (Defined("$eps = ln(lam)$"),), (Step("differentiate with respect to time", result),))


@derives("12-C", "14-C")
def c_of_state(printed: Printed) -> Derivation:
    """Transverse component from det C = I3, or as it was at the lock."""
    number, result = _state(printed)
    said, uses = {
        "12": ("$det(C) = lam^2 C_22 = I3$", ("10-I3",)),
        "14": ("at the lock $C_22 = 1/lam^2 = exp(-2 eps_l)$, with $J = 1$", ("12-C", "5-chi_l")),
    }[number]
    steps = (Step(said, result[1, 1]),)
    return equals(printed, result, _PREMISES[number], steps, uses, _SHOWN[printed.relation.id])


@derives("12-Cdot", "14-Cdot")
def cdot_of_state(printed: Printed) -> Derivation:
    """Its rate."""
    number, c = _state(printed)
    result = rate_of(c)
    steps = tuple(Step(f"component {n + 1}{n + 1}", result[n, n]) for n in range(3) if result[n, n] != 0)
    return equals(printed, result, (Defined(f"$C$ of {number}-C"),), steps, (f"{number}-C",), _SHOWN[printed.relation.id])


@derives("12-I1", "14-I1")
def i1_of_state(printed: Printed) -> Derivation:
    """Trace of C."""
    number, c = _state(printed)
    result = sp.expand(in_c11(c.trace()))
    steps = (Step("trace of $C$, with $lam^2 = C11$", result),)
    return equals(printed, result, (Defined(f"$C$ of {number}-C"),), steps, (f"{number}-C",))


@derives("12-J2")
def j2_squeezing(printed: Printed) -> Derivation:
    """(1/2) Cdot : Cdot, with C11 + I3/C11 = I1 - 1."""
    c11, cdot11, i1, i3 = sym("C11 Cdot11 I1 I3")
    rate = rate_of(squeezing_c())
    direct = in_c11((rate * rate).trace() / 2)
    front = sp.factor(sp.simplify(direct / sp.expand((c11 + i3 / c11) ** 2 - 2 * i3)))
    bracket = (i1 - 1) ** 2 - 2 * i3
    result = front * bracket
    steps = (
        Step("$(1/2) Cdot : Cdot$, with $lam^2 = C11$", direct),
        Step("$C11^2 + I3^2/C11^2 = (C11 + I3/C11)^2 - 2 I3 = (I1 - 1)^2 - 2 I3$", result),
        Step("difference of the two forms", sp.simplify(result.subs(i1, c11 + i3 / c11 + 1) - direct)),
    )
    factors = {"number": sp.Rational(1, 2), "rate over $C11$, squared": (cdot11 / c11) ** 2, "bracket": bracket}
    shown = "1/2*(Cdot11/C11)**2*((I1 - 1)**2 - 2*I3)"
    return equals(printed, result, SQUEEZING, steps, ("12-Cdot", "12-I1", "4.3-J2"), shown, factors)


@derives("14-J2")
def j2_bleeding(printed: Printed) -> Derivation:
    """(1/2) Cdot : Cdot."""
    rate = rate_of(bleeding_c())
    result = in_c11((rate * rate).trace() / 2)
    return equals(printed, result, BLEEDING, (Step("$(1/2) Cdot : Cdot$", result),), ("14-Cdot", "4.3-J2"))


@derives("13-I1s")
def smaller_root(printed: Printed) -> Derivation:
    """The smaller root of x + I3/x = I1 - 1."""
    c11, i1, i3 = sym("C11 I1 I3")
    roots = sp.solve(c11 + i3 / c11 - (i1 - 1), c11)
    state = {i1: 1 + sp.Rational(4, 5) + sp.Rational(5, 4), i3: 1}
    result = min(roots, key=lambda root: root.subs(state))
    steps = (
        Step("$C11 + I3/C11 = I1 - 1$: smaller root", result),
        Step("at $C11 = 4/5$, $I3 = 1$ it gives", result.subs(state)),
    )
    premises = (*SQUEEZING, "compaction: $C11$ is the smaller transverse component")
    return equals(printed, result, premises, steps, ("12-I1",))


@derives("13-real")
def root_in_a_dilation(printed: Printed) -> Derivation:
    """The same at C = (1 + delta) 1, where C11 = 1 + delta."""
    i1, i3, delta = sym("I1 I3 delta")
    state = {i1: 3 * (1 + delta), i3: (1 + delta) ** 3}
    under = sp.factor(((i1 - 1) ** 2 - 4 * i3).subs(state))
    steps = (Step("$(I1 - 1)^2 - 4 I3$ at $C = (1 + delta) 1$", under), Step("the compaction stretch squared", 1 + delta))
    comparison = Comparison("value at $C = (1 + delta) 1$", printed.value.subs(state), 1 + delta)
    missing = f"the root is of ${under}$ at $C = (1 + delta) 1$, negative for every small dilation $delta > 0$"
    premises = ("$I1s$ is to be the smaller transverse stretch squared",)
    return Derivation(premises, steps, (comparison,), 1 + delta, missing=missing)


@derives("14-I1b")
def i1b_is_c11(printed: Printed) -> Derivation:
    """C11 from the trace of C after locking."""
    c11, i1 = sym("C11 I1")
    trace = in_c11(bleeding_c().trace())
    (result,) = sp.solve(trace - i1, c11)
    steps = (Step("$I1$ =", trace), Step("solved for $C11$", result))
    return equals(printed, result, (Defined("$C$ of 14-C"),), steps, ("14-C", "14-I1"))
