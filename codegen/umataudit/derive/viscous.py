"""Section 4.3: the integration of Eq. 12, Eqs. 13 and 14, and the stress that they give back."""

from __future__ import annotations

from functools import cache

import sympy as sp

from umataudit.derive.derivation import Derivation, Printed, Step, derives, equals
from umataudit.derive.flow_states import SQUEEZING, rate_of, squeezing_c
from umataudit.printed.letters import sym


@derives("12")
def scalar_gradient(printed: Printed) -> Derivation:
    """Component 11 of Eq. 11, with the stress of Eqs. 1 to 3."""
    lam, sigma, a, b, eps_dot, eta_rate, i3 = sym("lam sigma a b eps_dot eta_rate I3")
    J = sym("J")[0]
    stretch = sp.diag(lam, sp.sqrt(i3) / lam, 1)
    pulled = (J / 2) * stretch.inv() * sp.diag(sigma, 0, 0) * stretch.inv().T
    micro = sym("eta_micro_r" if printed.under else "eta_micro")[0]
    law = printed.of("3").subs(eta_rate, sp.exp(b) * (-eps_dot) ** a).subs(sym("eta_micro")[0], micro)
    result = pulled[0, 0].subs(sigma, -sp.powsimp(sp.simplify(-law)))
    steps = (Step("component 11 of Eq. 11", pulled[0, 0]), Step("stress of Eqs. 2, 3", law), Step("together", result))
    return equals(printed, result, ("Eqs. 2, 3, 11",), steps, ("2", "3", "11"))


@cache
def integrated_potential() -> tuple[sp.Expr, tuple[Step, ...]]:
    """Integral of Eq. 12 over Cdot11 along the constrained path, in eta, rate and J."""
    J, a, b, c11, eta_micro, eta_ply = sym("J a b C11 eta_micro eta_ply")
    u, end, rate, power = sp.symbols("u U r p", positive=True)
    slope = J / (2 * c11) * eta_micro * eta_ply * sp.exp(b) * (u / (2 * c11)) ** (power - 1)
    integral = sp.simplify(sp.integrate(slope, (u, 0, end)))
    potential = sp.powsimp(sp.simplify(integral.subs(end, 2 * c11 * rate))).subs(power, a + 2)
    integral = integral.subs(power, a + 2)
    steps = (
        Step("Eq. 12 with $u = -Cdot11 = 2 C11 r$, $r = -eps_dot$, $a + 2 > 0$, integrated over $u$ from 0 to $U$", integral),
        Step("in the rate $r$: $psi_v$ =", potential),
    )
    return potential, steps


@cache
def potential_of(micro: sp.Expr, ply: sp.Expr, rate_squared: sp.Expr, x: sp.Symbol) -> tuple[sp.Expr, tuple[Step, ...]]:
    """psi_v of a fibre and a ply term, in terms of x = exp(2 eps) and J2.

    Parameters
    ----------
    micro : fibre term, proportional to the resin viscosity (which b takes up).
    ply : ply term.
    rate_squared : squared compaction rate in terms of J2.
    x : symbol of the squared compaction stretch.
    """
    a, eps, eps_l, eta_micro, eta_ply, eta_res, chi_l = sym("a eps eps_l eta_micro eta_ply eta_res chi_l")
    potential, steps = integrated_potential()
    micro = micro / eta_res
    state = {eps: sp.log(x) / 2, eps_l: -sp.log(chi_l) / 2}
    viscosity = sp.simplify((micro * ply).subs(state))
    rate = sp.Symbol("r", positive=True)
    power = rate_squared ** ((a + 2) / 2)
    result = potential.subs(rate, sp.S.One).subs({eta_micro: 1, eta_ply: 1}) * viscosity * power
    more = (
        Step("ply term times fibre term ($eta_res$ in $b$) with $exp(eps) = sqrt(x)$", viscosity),
        Step("$r^2$ from $J2$", rate_squared),
        Step("$psi_v$", result),
    )
    return result, (*steps, *more)


@derives("13")
def potential_squeezing(printed: Printed) -> Derivation:
    """Eq. 12 integrated, with J2 of the squeezing state."""
    w0, h0, chi_l, chi_f, k, a, b, J, x, i1, i3, j2 = sym("w0 h0 chi_l chi_f k a b J I1s I1 I3 J2")
    norm = (i1 - 1) ** 2 - 2 * i3
    result, steps = potential_of(printed.of("5a"), printed.of("4a"), j2 / (2 * norm), x)
    steps = (*steps[:2], Step("$J2 = (1/2) (Cdot11/C11)^2 ((I1-1)^2 - 2 I3)$ and $Cdot11 = 2 C11 eps_dot$"), *steps[2:])
    parts = {
        "$(w0/h0)^2$": (w0 / h0) ** 2,
        "aspect ratios": sp.sqrt(chi_l) / chi_f,
        "$4 J k exp(b)/(a+2)$": 4 * J * k * sp.exp(b) / (a + 2),
        "power of $I1s$": x ** sp.Rational(-3, 2),
        "bracket": (k / (sp.sqrt(x) - k / sp.sqrt(chi_f))) ** 2 + 3 * chi_f,
        "norm of the rate": (1 / (2 * norm)) ** ((a + 2) / 2),
        "$J2$ power": j2 ** ((a + 2) / 2),
    }
    shown = (
        "(w0/h0)**2*(sqrt(chi_l)/chi_f)*(4*J*k*exp(b)/(a + 2))*I1s**(-3/2)"
        "*((k/(sqrt(I1s) - k/sqrt(chi_f)))**2 + 3*chi_f)*(1/(2*((I1 - 1)**2 - 2*I3)))**((a + 2)/2)*J2**((a + 2)/2)"
    )
    uses = ("4a", "5a", "12", "12-rate", "12-J2", "13-I1s", "3.2-b")
    return equals(printed, result, ("Eq. 12", "Eqs. 4a, 5a", "$J2$ of the squeezing state"), steps, uses, shown, parts)


@derives("14")
def potential_bleeding(printed: Printed) -> Derivation:
    """Eq. 12 integrated, with J2 of the bleeding state."""
    x, j2 = sym("I1b J2")
    result, steps = potential_of(printed.of("5b"), printed.of("4b"), j2 / (2 * x**2), x)
    steps = (*steps[:2], Step("$J2 = Cdot11^2/2$ and $Cdot11 = 2 C11 eps_dot$, $C11 = I1b$"), *steps[2:])
    uses = ("4b", "5b", "12", "12-rate", "14-J2", "14-I1b", "3.2-b")
    return equals(printed, result, ("Eq. 12", "Eqs. 4b, 5b", "$J2$ of the bleeding state"), steps, uses)


@derives("4.3-stress")
def stress_given_back(printed: Printed) -> Derivation:
    """Stress of Eq. 15 in squeezing with the derived Eq. 13, for sigma_11 alone or for sigma_11 - sigma_22."""
    J, a, b, i3, eta_micro, eta_ply, eps_dot = sym("J a b I3 eta_micro_r eta_ply eps_dot")
    lam, lam_dot = sym("lam lam_dot")
    c, rate = squeezing_c(), rate_of(squeezing_c())
    j2 = (rate * rate).trace() / 2
    norm = sp.Symbol("norm", positive=True)
    f = J * eta_micro * eta_ply * sp.exp(b) / (a + 2) * (2 * norm) ** (-(a + 2) / 2)
    second = (a + 2) * f * sp.Symbol("j", positive=True) ** (a / 2) * rate
    stress = [c[i, i] * second[i, i] / J for i in (0, 1)]
    taken = stress[0] - stress[1] if printed.under == "difference" else stress[0]
    r = sp.Symbol("r", positive=True)
    values = {sp.Symbol("j", positive=True): 2 * norm * r**2, lam_dot: -r * lam}
    reduced = sp.simplify(taken.subs(values))
    trace = lam**4 + i3**2 / lam**4
    result = sp.powsimp(sp.simplify(reduced.subs(norm, trace))).subs(r, -eps_dot)
    steps = (
        Step("$J2$ in this state", sp.simplify(j2)),
        Step("$f$ of the derived Eq. 13, $norm = C11^2 + C_22^2 = (I1-1)^2 - 2 I3$", f),
        Step("$sigma_11$ of Eqs. 9, 15", sp.simplify(stress[0])),
        Step("$sigma_22$", sp.simplify(stress[1])),
        Step("in the rate: " + ("$sigma_11 - sigma_22$" if printed.under else "$sigma_11$"), result),
    )
    return equals(printed, result, ("Eqs. 9, 13 (derived), 15", *SQUEEZING), steps, ("9", "13", "15"))
