"""Eq. 6, the ordinate of Fig. 6, and b beside b-bar."""

from __future__ import annotations

import sympy as sp

from umataudit.derive.derivation import Comparison, Derivation, Printed, Step, derives, equals
from umataudit.derive.squeeze_flow import PREMISES, RATE, constant_volume, strip_flow
from umataudit.printed.letters import sym


@derives("6")
def strain_at_locking(printed: Printed) -> Derivation:
    """Shear at the edge, integrated until its angle is gamma_lock; thinning of the bulk, until eps_lock."""
    eps, gamma, eps_bulk = sym("eps gamma_lock eps_bulk")
    flow = strip_flow(newtonian=True)
    per_strain = constant_volume(flow.wall_shear_rate / RATE)
    past, y = sp.symbols("s y", real=True)
    sheared = sp.simplify(sp.integrate(per_strain.subs(eps, past), (past, eps, 0)))
    (grown,) = sp.solve(sheared.subs(sp.exp(-2 * eps), y) - sp.tan(gamma), y)
    edge = -sp.log(sp.sqrt(sp.expand(grown)))
    (bulk,) = sp.solve(flow.local_rate / RATE * y - eps_bulk, y)
    result = sp.Max(edge, bulk)
    steps = (
        Step("largest shear rate, at the plates and edges, over the rate: $3 w/h$", flow.wall_shear_rate / RATE),
        Step("with constant volume, integrated over the strain from 0 to $eps$: the shear at the edge", sheared),
        Step("equal to $tan(gamma_lock)$", edge),
        Step("thinning rate in the mid-plane over the mean rate", flow.local_rate / RATE),
        Step("the bulk reaches $eps_bulk$ at", bulk),
        Step("the first of the two events; strains are negative, so the larger one", result),
    )
    premises = (*PREMISES, "Newtonian", "$w$ and $h$ are full width and thickness", "the shear is $tan(gamma_lock)$")
    return Derivation(premises, steps, _members(printed.value, result), result)


def _members(printed: sp.Expr, result: sp.Expr) -> tuple[Comparison, ...]:
    """The two members of the maximum, matched by what they depend on; the whole when the printed form is no such maximum."""
    gamma = sym("gamma_lock")[0]
    labels = {True: "member of the edge", False: "member of the bulk"}
    sides = [{member.has(gamma): member for member in side.args} for side in (printed, result)]
    if not isinstance(printed, sp.Max) or len(printed.args) != 2 or set(sides[0]) != set(labels):
        return (Comparison("right-hand side", printed, result),)
    return tuple(Comparison(label, sides[0][key], sides[1][key]) for key, label in labels.items())


@derives("3.2-axis")
def ordinate(printed: Printed) -> Derivation:
    """The ordinate is to be exp(b) rate^a, a straight line of slope a in the log-log diagram."""
    a, b, sigma, eps_dot, eta_rate = sym("a b sigma eps_dot eta_rate")
    product = printed.of("3")
    result = sp.solve(sigma - product, eta_rate)[0]
    stress = product.subs(eta_rate, sp.exp(b) * (-eps_dot) ** a)
    rate = sp.Symbol("rate", positive=True)
    line = sp.expand_log(sp.log(printed.value.subs(sigma, stress).subs(eps_dot, -rate)), force=True)
    slope = sp.simplify(sp.diff(line, rate) * rate)
    intercept = sp.simplify(line.subs(rate, 1))
    steps = (Step("Eqs. 2 and 3", stress), Step("slope of ln(ordinate) over ln(rate)", slope), Step("intercept", intercept))
    comparisons = (Comparison("slope", slope, a), Comparison("intercept", intercept, b))
    premises = ("Eqs. 2, 3", "straight line of slope $a$, intercept $b$")
    return Derivation(premises, steps, comparisons, result, uses=("2", "3"))


@derives("3.2-b")
def resin_in_b(printed: Printed) -> Derivation:
    """exp(b) of Tables 2, 3 is the intercept of Fig. 6a with the fibre term that a fit can evaluate, without eta_resin."""
    eta_micro, eta_ply, eta_rate, eta_res, eps_dot = sym("eta_micro eta_ply eta_rate eta_res eps_dot")
    intercepts = []
    for fibre_term in (printed.of("5a"), printed.of("5b")):
        stress = printed.of("3").subs({eta_rate: printed.of("2"), eta_micro: fibre_term})
        ordinate = stress / eps_dot / (eta_ply * fibre_term.subs(eta_res, 1))
        intercepts.append(sp.simplify(ordinate.subs(eps_dot, -1)))
    result, after = (sp.expand_log(sp.log(intercept), force=True) for intercept in intercepts)
    steps = (
        Step("ordinate of Fig. 6a, stress over rate and $eta_ply eta_micro$, at the rate -1/s: $exp(b)$ =", intercepts[0]),
        Step("logarithm, before locking", result),
        Step("after locking", after),
    )
    premises = ("Eqs. 2, 3, 5", "$exp(b)$ is the intercept of Fig. 6a, its fibre term without the resin viscosity")
    check = Comparison("the same before and after locking", result, after)
    return equals(printed, result, premises, steps, ("2", "3", "5a", "5b"), also=(check,))
