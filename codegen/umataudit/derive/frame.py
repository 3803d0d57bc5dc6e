"""Eqs. 7, 8, 9, 11 and the invariants: balance of power, push-forward and pull-back."""

from __future__ import annotations

import sympy as sp

from umataudit.derive.derivation import Comparison, Defined, Derivation, Printed, Step, derives, equals
from umataudit.printed.letters import sym, tensor
from umataudit.printed.tensors import double_contraction

_POWER = "the stress power per reference volume is $S : Cdot/2$, for every $Cdot$"


def _for_every(rate: sp.Matrix, balance: sp.Expr, unknown: sp.Matrix) -> sp.Matrix:
    """The symmetric tensor for which a balance of power vanishes for every rate."""
    balance, rates = sp.expand(balance), sorted(rate.free_symbols, key=str)
    solved = sp.solve([sp.diff(balance, entry) for entry in rates], sorted(unknown.free_symbols, key=str))
    return unknown.subs(solved)


def _conjugate(gradient: sp.Matrix) -> sp.Matrix:
    """Symmetric S with S : Cdot/2 = gradient : Cdot for every Cdot."""
    cdot, unknown = tensor("Cdot"), tensor("S")
    return _for_every(cdot, double_contraction(unknown, cdot) / 2 - double_contraction(gradient, cdot), unknown)


@derives("7")
def additive_potential(printed: Printed) -> Derivation:
    """The weights with which psi_e and psi_v must enter psi for Eq. 8 to be 2 (dpsi/dC + dpsi/dCdot)."""
    psi_e, psi_v, a, f, j2 = sym("psi_e psi_v a f J2")
    weights = sp.symbols("c_e c_v", real=True)
    elastic, viscous = tensor("Pe")[0, 1], tensor("Pv")[0, 1]
    difference = sp.expand(2 * (weights[0] * elastic + weights[1] * viscous) - printed.of("8")[0, 1])
    solved = sp.solve([sp.diff(difference, slope) for slope in (elastic, viscous)], weights, dict=True)[0]
    result = solved[weights[0]] * psi_e + solved[weights[1]] * psi_v
    potential = f * j2 ** ((a + 2) / 2)
    power = sp.simplify(2 * j2 * sp.diff(potential, j2))
    dissipated = "viscous power $Cdot : dpsi_v/dCdot$ of $psi_v = f J2^((a+2)/2)$; it is not negative, as Clausius-Duhem needs"
    steps = (
        Step("$psi = c_e psi_e + c_v psi_v$ in $2 (dpsi/dC + dpsi/dCdot)$, $C$ a parameter of $psi_v$: minus Eq. 8", difference),
        Step("zero for every gradient: $c_e$", solved[weights[0]]),
        Step("$c_v$", solved[weights[1]]),
        Step(dissipated, power),
    )
    premises = ("Eq. 8 is $2 (dpsi/dC + dpsi/dCdot)$", "$C$ is a parameter of $psi_v$ (below Eq. 9)")
    check = Comparison("viscous power is $(a+2) psi_v$", sp.powsimp(power), sp.powsimp((a + 2) * potential))
    return equals(printed, result, premises, steps, ("8", "15-f"), also=(check,))


@derives("8")
def stress_from_potentials(printed: Printed) -> Derivation:
    """Power balance: elastic part stored, viscous part derived from psi_v with respect to Cdot."""
    elastic, viscous = _conjugate(tensor("Pe")), _conjugate(tensor("Pv"))
    result = elastic + viscous
    steps = (
        Step("stored: $S_e : Cdot/2 = dpsi_e/dC : Cdot$, component 11 of $S_e$", elastic[0, 0]),
        Step("dissipated: $S_v : Cdot/2 = dpsi_v/dCdot : Cdot$, component 11 of $S_v$", viscous[0, 0]),
    )
    return equals(printed, result, (_POWER,), steps, shown="2*(Pe + Pv)")


@derives("9")
def push_forward(printed: Printed) -> Derivation:
    """The sigma with J sigma : D = S : (F^T D F) for every D."""
    J = sym("J")[0]
    f, rate, second = tensor("F"), tensor("D"), printed.of("8")
    unknown = tensor("stress")
    balance = J * double_contraction(unknown, rate) - double_contraction(second, f.T * rate * f)
    result = _for_every(rate, balance, unknown)
    steps = (
        Step("$Cdot/2 = F^T D F$"),
        Step("$J stress : D = S : (F^T D F)$ for every $D$: component 33 of $stress$", sp.factor_terms(result[2, 2])),
    )
    return equals(printed, result, (_POWER, "Eq. 8"), steps, ("8",), shown="1/J*(F @ (2*(Pe + Pv)) @ transpose(F))")


@derives("11")
def pull_back(printed: Printed) -> Derivation:
    """Eq. 9 solved for dpsi_v/dCdot."""
    J = sym("J")[0]
    f, stress = tensor("F"), tensor("stress")
    inverse = f.adjugate() / f.det()
    result = (J / 2) * inverse * stress * inverse.T
    steps = (Step("Eq. 9 with the viscous part alone, multiplied by $(J/2) F^-1$ and $F^-T$"),)
    return equals(printed, result, (Defined("Eq. 9"),), steps, ("9",), shown="J/2*(inv(F) @ stress @ transpose(inv(F)))")


@derives("10-I2")
def second_invariant(printed: Printed) -> Derivation:
    """Coefficient of the characteristic polynomial."""
    c, root = tensor("C"), sp.Symbol("x", real=True)
    polynomial = sp.Poly((root * sp.eye(3) - c).det(method="berkowitz"), root)
    result = polynomial.coeff_monomial(root)
    steps = (Step("$det(x identity - C) = x^3 - I1 x^2 + I2 x - I3$: coefficient of $x$", result),)
    return equals(printed, result, ("principal invariants",), steps, shown="1/2*(tr(C)**2 - tr(C @ C))")


@derives("10-I3")
def third_invariant(printed: Printed) -> Derivation:
    """det(F^T F)."""
    J = sym("J")[0]
    f = tensor("F")
    root = sp.Symbol("j", positive=True)
    squared = sp.simplify((f.T * f).det() / f.det() ** 2)
    result = squared * J**2
    steps = (Step("$det(F^T F)$ over $det(F)^2$", squared), Step("with $det(F) = J$", (squared * root**2).subs(root, J)))
    return equals(printed, result, (Defined("$C = F^T F$"), Defined("$J = det(F)$")), steps)


@derives("4.3-I1")
def first_invariant(printed: Printed) -> Derivation:
    """Trace of C for a general F."""
    f = tensor("F")
    result = (f.T * f).trace()
    steps = (
        Step("$I1 = identity : C = tr(F^T F)$, the sum of the squared principal stretches"),
        Step("eigenvalues of $F$ have squares that sum to $tr(F F)$; in simple shear by 1", _shear(f * f)),
        Step("while $I1$ is", _shear(f.T * f)),
    )
    return equals(printed, result, ("$I1 = identity : C$ (below Eq. 10)",), steps, shown="tr(transpose(F) @ F)")


def _shear(matrix: sp.Matrix) -> sp.Expr:
    """Trace in simple shear by 1."""
    f = tensor("F")
    state = {f[i, j]: int(i == j or (i, j) == (0, 1)) for i in range(3) for j in range(3)}
    return matrix.trace().subs(state)


@derives("4.3-J2")
def rate_invariant(printed: Printed) -> Derivation:
    """The invariant whose gradient is Cdot, as Eq. 15 uses it: the gradient integrated along s Cdot."""
    cdot = tensor("Cdot")
    part = sp.Symbol("s", positive=True)
    result = sp.integrate(part * sp.expand(double_contraction(cdot, cdot)), (part, 0, 1))
    comparisons = tuple(
        Comparison(f"$dJ2/dCdot$ {i + 1}{j + 1}", sp.diff(printed.value, cdot[i, j]) / (1 if i == j else 2), cdot[i, j])
        for i in range(3) for j in range(i, 3)
    )  # fmt: skip
    steps = (
        Step("a gradient $dJ2/dCdot = Cdot$ integrated along $s Cdot$, $s$ from 0 to 1: integrand $s Cdot : Cdot$"),
        Step("for the component 11 alone", result.subs({entry: 0 for entry in cdot if entry != cdot[0, 0]})),
    )
    return equals(printed, result, ("Eq. 15: $dJ2/dCdot = Cdot$",), steps, shown="1/2*ddot(Cdot, Cdot)", also=comparisons)
