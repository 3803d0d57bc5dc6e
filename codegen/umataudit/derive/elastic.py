"""Eq. 10 from its premises: the printed terms with unknown coefficients, a stress-free natural state, Spencer's constants."""

from __future__ import annotations

from functools import cache

import sympy as sp

from umataudit.derive.derivation import Derivation, Printed, Step, derives, equals
from umataudit.printed.letters import sym

_PREMISES = (
    "the terms of Eq. 10 with unknown coefficients",
    "$F = 1$ is free of stress",
    "small strains: Spencer's energy $lam_e/2 tr(e)^2 + mu_T tr(e e) + alpha_e tr(e) e_11"
    " + 2 (mu_L - mu_T) tr(N0 e e) + beta_e/2 e_11^2$",
    "$alpha_e$ and $beta_e$ are Spencer's: the paper does not define them",
)
_SHOWN = (
    "1/2*mu_T*(I1 - 3) - mu_T*ln(J) + 1/2*lam_e*(J - 1)**2"
    " + ((mu_T - mu_L) + alpha_e/2*ln(J) + beta_e/8*(I4 - 1))*(I4 - 1) - 1/2*(mu_T - mu_L)*(I5 - 1)"
)


def _terms() -> dict[str, sp.Expr]:
    """The seven terms of Eq. 10 by name."""
    i1, i4, i5, j = sym("I1 I4 I5 J")
    return {
        "$I1 - 3$": i1 - 3, "$ln(J)$": sp.log(j), "$(J - 1)^2$": (j - 1) ** 2, "$I4 - 1$": i4 - 1,
        "$ln(J) (I4 - 1)$": sp.log(j) * (i4 - 1), "$(I4 - 1)^2$": (i4 - 1) ** 2, "$I5 - 1$": i5 - 1,
    }  # fmt: skip


@cache
def _coefficients() -> dict[str, sp.Expr]:
    """The coefficient of each term, from the second order in the strain e with C = 1 + 2 s e, fibre along axis 1."""
    i1, i4, i5, j, lam, mu_t, mu_l, alpha, beta = sym("I1 I4 I5 J lam_e mu_T mu_L alpha_e beta_e")
    e = sp.Matrix(3, 3, lambda m, n: sp.Symbol("e_{}{}".format(*sorted((m + 1, n + 1))), real=True))
    small, square = sp.Symbol("s", positive=True), e * e
    c = sp.eye(3) + 2 * small * e
    log_j = sp.log(c.det(method="berkowitz")) / 2
    values = {i1: c.trace(), i4: c[0, 0], i5: (c * c)[0, 0]}

    def to_second_order(term: sp.Expr) -> sp.Expr:
        value = term.subs(sp.log(j), log_j).subs(j, sp.exp(log_j)).subs(values)
        return sp.simplify(sum(sp.diff(value, small, n).subs(small, 0) / sp.factorial(n) for n in (0, 1, 2)))

    spencer = (
        lam / 2 * e.trace() ** 2 + mu_t * square.trace() + alpha * e.trace() * e[0, 0]
        + 2 * (mu_l - mu_t) * square[0, 0] + beta / 2 * e[0, 0] ** 2
    )  # fmt: skip
    unknowns = sp.symbols("c1:8", real=True)
    expanded = sp.Add(*(c * to_second_order(t) for c, t in zip(unknowns, _terms().values(), strict=True)))
    equations = sp.Poly(sp.expand(expanded - spencer), *sorted(e.free_symbols, key=str)).coeffs()
    (solved,) = sp.solve(equations, unknowns, dict=True)
    return dict(zip(_terms(), (solved[c] for c in unknowns), strict=True))


@derives("10")
def elastic_potential(printed: Printed) -> Derivation:
    """The coefficients that the premises force."""
    i4, j = sym("I4 J")
    coefficients, terms = _coefficients(), _terms()
    coupled = sp.diff(sp.diff(printed.value, i4).subs(i4, 1), j) * j
    steps = (
        Step("first-order part of the printed potential at $F = 1$ (must vanish), over the strain along the fibre",
             _slope(printed.value)),
        *(Step(f"coefficient of {name}", value) for name, value in coefficients.items()),
        Step("the printed coefficient of $ln(J) (I4 - 1)$ holds for an $alpha_e$ that is Spencer's times",
             sp.simplify(coefficients["$ln(J) (I4 - 1)$"] / coupled)),
    )  # fmt: skip
    expected = {name: coefficients[name] * term for name, term in terms.items()}
    bracket = coefficients["$I4 - 1$"] + coefficients["$ln(J) (I4 - 1)$"] * sp.log(j) + coefficients["$(I4 - 1)^2$"] * (i4 - 1)
    parts = {
        "term in $I1$": expected["$I1 - 3$"], "term in $ln(J)$": expected["$ln(J)$"], "term in $(J - 1)^2$": expected["$(J - 1)^2$"],
        "bracket with $alpha_e$ and $beta_e$ (Spencer's)": bracket * (i4 - 1), "term in $I5$": expected["$I5 - 1$"],
    }  # fmt: skip
    return equals(printed, sp.Add(*expected.values()), _PREMISES, steps, shown=_SHOWN, parts=parts)


def _slope(potential: sp.Expr) -> sp.Expr:
    """Slope of a potential of I1, I4, I5, J along the fibre at F = 1, over the strain e_11; half the residual stress."""
    i1, i4, i5, j = sym("I1 I4 I5 J")
    rates, natural = {i1: 2, i4: 2, i5: 4, j: 1}, {i1: 3, i4: 1, i5: 1, j: 1}
    return sp.simplify(sp.Add(*(sp.diff(potential, i).subs(natural) * rate for i, rate in rates.items())))
