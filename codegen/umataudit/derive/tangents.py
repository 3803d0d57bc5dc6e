"""Section 4.4: choice of the potential, Eqs. 15 to 17."""

from __future__ import annotations

import itertools
from functools import cache

import sympy as sp

from umataudit.derive.derivation import Comparison, Derivation, Printed, Step, derives, equals
from umataudit.printed.letters import LETTERS, sym, tensor
from umataudit.printed.tensors import double_contraction, fourth_order, symmetric_identity

_BRACKET = "f*J2**(a/2)*(a/2*J2**(-1)*dyad(Cdot, Cdot) + identity4)"


@derives("4.4-rule")
def stage_rule(printed: Printed) -> Derivation:
    """Sections 3.1 and 4.3: squeezing first (small compaction), bleeding once the lock is passed."""
    eps, eps_l = sym("eps eps_l")
    result = eps_l - eps
    steps = (
        Step("Eqs. 4b, 5b, 14 hold after locking; compaction strains are negative and start from 0"),
        Step("after locking $eps < eps_l$: positive where Eq. 14 holds", result),
        Step("as printed, at the start ($eps = 0$) the test is", printed.value.subs(eps, 0)),
    )
    return equals(printed, result, ("bleeding follows locking (section 3.1, caption of Fig. 5)",), steps, ("6",))


@derives("15-f")
def common_form(printed: Printed) -> Derivation:
    """Eqs. 13 and 14 are both a factor times J2 to the (a+2)/2."""
    f, a, j2 = sym("f a J2")
    exponents = [sp.simplify(sp.diff(sp.log(printed.of(n)), j2) * j2) for n in ("13", "14")]
    result = f * j2 ** exponents[0]
    steps = (
        Step("exponent of $J2$ in Eq. 13", exponents[0]),
        Step("in Eq. 14", exponents[1]),
        Step("same rate exponent", a),
    )
    check = Comparison("exponents of Eqs. 13 and 14", exponents[0], exponents[1])
    return equals(printed, result, ("Eqs. 13, 14",), steps, ("13", "14"), also=(check,))


@derives("15")
def second_stress(printed: Printed) -> Derivation:
    """Eq. 8 with S_v = 2 dpsi_v/dCdot of psi_v = f J2^((a+2)/2), differentiated component by component."""
    (f, a, j2_name), cdot = sym("f a J2"), tensor("Cdot")
    j2 = double_contraction(cdot, cdot) / 2
    potential = f * j2 ** ((a + 2) / 2)
    stress = sp.Matrix(3, 3, lambda i, j: 2 * sp.diff(potential, cdot[i, j]) / (1 if i == j else 2)).subs(j2, j2_name)
    result = (tensor("Se") + stress).applyfunc(lambda e: sp.powsimp(sp.simplify(e)))
    steps = tuple(Step(f"$2 dpsi_v/dCdot$, component 1{n + 1}", sp.simplify(stress[0, n])) for n in (0, 1))
    premises = ("Eq. 8", "$psi_v = f J2^((a+2)/2)$, $f$ not differentiated")
    return equals(printed, result, premises, steps, ("8", "15-f"), "Se + (a + 2)*f*J2**(a/2)*Cdot")


def _stress_derivative(frozen: bool) -> sp.NDimArray:
    """dS/dC at the end of an increment, Cdot = (C - C_n)/dt, with f constant or with a gradient."""
    f, a, dt, j2 = sym("f a dt J2")
    cdot, elastic = tensor("Cdot"), LETTERS["Ce"].value
    power = j2 ** (a / 2)
    identity = symmetric_identity()

    def component(i: int, j: int, k: int, m: int) -> sp.Expr:
        rate = identity[i, j, k, m] / dt
        power_slope = sp.diff(power, j2) * cdot[k, m] / dt
        total = elastic[i, j, k, m] + (a + 2) * f * (power_slope * cdot[i, j] + power * rate)
        if not frozen:
            total += (a + 2) * power * cdot[i, j] * sp.Symbol("df_{}{}".format(*sorted((k + 1, m + 1))), real=True)
        return total

    return fourth_order(component)


@derives("16-f")
def stress_derivative(printed: Printed) -> Derivation:
    """Derivative of Eq. 15 to C."""
    frozen = printed.under == "frozen"
    result = _stress_derivative(frozen)
    steps = (
        Step("$Cdot = (C - C_n)/dt$; $dJ2/dC = Cdot/dt$"),
        Step("component 1122", result[0, 0, 1, 1]),
        Step("without $f$ held fixed there is a further term $dyad(Cdot, df/dC)$, which is not symmetric"),
    )
    premises = ("Eq. 15", "backward difference for $Cdot$", "$Ce = dS_e/dC$")
    missing = "$f$ depends on $C$ through $I1$ and $I3$; the derivative of $f$ is not given"
    shown = f"Ce + (a + 2)/dt*{_BRACKET}" if frozen else ""
    return equals(printed, result, premises, steps, ("15",), shown, missing=missing)


@derives("16")
def tangent_for_17(printed: Printed) -> Derivation:
    """Eq. 17 multiplies by D, and Edot = Cdot/2 = F^T D F: the tangent is 2 dS/dC = dS/dE."""
    elastic = LETTERS["Ce"].value
    half = _stress_derivative(frozen=True) - elastic
    result = elastic + 2 * half
    steps = (
        Step("$Sdot = dS/dC : Cdot = 2 dS/dC : Edot$, and $Edot = F^T D F$ is what Eq. 17 contracts with"),
        Step("$dS_v/dC$, component 1111", half[0, 0, 0, 0]),
        Step("$2 dS_v/dC$, component 1111", 2 * half[0, 0, 0, 0]),
        Step("$Ce$ is taken as the elastic tangent $2 dS_e/dC$ (Bonet and Burton give it so)"),
    )
    premises = ("Eq. 15 with $f$ held fixed", "Eq. 17 pushes the tangent forward and contracts it with $D$")
    return equals(printed, result, premises, steps, ("15", "16-f", "17"), shown=f"Ce + 2*(a + 2)/dt*{_BRACKET}")


@derives("17-push")
def tangent_push_forward(printed: Printed) -> Derivation:
    """F Sdot F^T/J with Sdot = C : (F^T D F)."""
    result = _pushed_tangent()
    steps = (
        Step("$F Sdot F^T/J$ with $Sdot = C4 : (F^T D F)$, for $D = (e_k e_l + e_l e_k)/2$: the component $ijkl$"),
        Step("component 1111, number of terms", sp.Integer(len(sp.Add.make_args(sp.expand(result[0, 0, 0, 0]))))),
    )
    shown = "1/J*F[i,I]*F[j,J]*F[k,K]*F[l,L]*C4[I,J,K,L]"
    return equals(printed, result, ("$Sdot = C4 : Edot$", "$Edot = F^T D F$"), steps, ("9",), shown)


@cache
def _pushed_tangent() -> sp.NDimArray:
    """F (C : (F^T D F)) F^T/J for the unit symmetric D = (e_k e_m + e_m e_k)/2."""
    J = sym("J")[0]
    f, fourth = tensor("F"), LETTERS["C4"].value

    def response(k: int, m: int) -> sp.Matrix:
        row_k, row_m = f[k, :], f[m, :]
        strain = (row_k.T * row_m + row_m.T * row_k) / 2
        return f * double_contraction(fourth, strain) * f.T / J

    columns = {(k, m): response(k, m) for k in range(3) for m in range(k, 3)}
    return fourth_order(lambda i, j, k, m: columns[min(k, m), max(k, m)][min(i, j), max(i, j)])


@cache
def jaumann_rate() -> sp.Matrix:
    """Jaumann rate of tau = F S F^T with Sdot = 0: D tau + tau D."""
    tau, (w12, w13, w23) = sym("J")[0] * tensor("stress"), sp.symbols("W_12 W_13 W_23", real=True)
    spin = sp.Matrix([[0, w12, w13], [-w12, 0, w23], [-w13, -w23, 0]])
    velocity = tensor("D") + spin
    return sp.expand(velocity * tau + tau * velocity.T - spin * tau + tau * spin)


@cache
def _jaumann_coefficients() -> sp.NDimArray:
    """Coefficients of D in the Jaumann rate with S constant, over J."""
    J = sym("J")[0]
    kept, rate = jaumann_rate(), tensor("D")
    return fourth_order(lambda i, j, k, m: sp.expand(sp.diff(kept[i, j], rate[k, m]) / (1 if k == m else 2) / J))


@derives("17-C'")
def jaumann_terms(printed: Printed) -> Derivation:
    """The part of the Jaumann rate in which S stays: D tau + tau D = J C' : D."""
    result = _jaumann_coefficients()
    steps = (
        Step("Jaumann rate of $F S F^T$ with $S$ constant: the spin drops out, component 11", jaumann_rate()[0, 0]),
        Step("over $J$, coefficient of $D$: component 1212", result[0, 1, 0, 1]),
    )
    shown = "1/2*(delta[i,k]*stress[j,l] + delta[i,l]*stress[j,k] + delta[j,k]*stress[i,l] + delta[j,l]*stress[i,k])"
    return equals(printed, result, ("$tau = J stress = F S F^T$",), steps, ("9",), shown)


@derives("17")
def jaumann_total(printed: Printed) -> Derivation:
    """Jaumann rate of tau = F S F^T: the part with Sdot, J c : D, and the part with S constant, with $cp4$ put in."""
    J = sym("J")[0]
    rate, pushed, kept = tensor("D"), LETTERS["c4"].value, LETTERS["cp4"].value
    whole = J * double_contraction(pushed, rate) + jaumann_rate()
    terms = _jaumann_coefficients()
    known = {kept[n]: terms[n] for n in itertools.product(range(3), repeat=4)}
    result = J * (double_contraction(pushed, rate) + double_contraction(kept, rate))
    steps = (
        Step("$F Sdot F^T = J c4 : D$ (17-push)"),
        Step("Jaumann rate with $S$ constant, component 11", jaumann_rate()[0, 0]),
        Step("$J cp4 : D$ with the $cp4$ of 17-C', component 11", sp.expand(J * double_contraction(terms, rate)[0, 0])),
        Step("DDSDDE of Abaqus is $c4 + cp4$, the derivative of $tau$ to strain over $J$"),
    )
    put_in = Comparison("with $cp4$ put in", printed.value.xreplace(known), whole)
    return equals(printed, result, ("$tau = J stress = F S F^T$",), steps, ("17-push", "17-C'"), "J*ddot(c4 + cp4, D)", also=(put_in,))
