"""Eq. 10 from its premises: the printed terms with unknown coefficients, a stress-free natural state, Spencer's constants."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import sympy as sp

from umataudit.derive.derivation import Derivation, Printed, Step, derives, equals
from umataudit.printed.letters import sym

_PREMISES = (
    "the terms of Eq. 10 with unknown coefficients",
    "F = 1 is free of stress",
    "small strains: Spencer's energy lambda/2 (tr e)^2 + mu_T e:e + alpha tr e (n.e.n) + 2 (mu_L - mu_T) n.e.e.n"
    " + beta/2 (n.e.n)^2",
    "alpha and beta are Spencer's: the paper does not define them",
)


@dataclass(frozen=True)
class _Basis:
    """Terms of Eq. 10: as they stand, and to second order in the strain."""

    terms: tuple[sp.Expr, ...]
    expanded: tuple[sp.Expr, ...]


def _strain() -> sp.Matrix:
    return sp.Matrix(3, 3, lambda i, j: sp.Symbol("e_{}{}".format(*sorted((i + 1, j + 1))), real=True))


@cache
def _basis() -> _Basis:
    """The seven terms, and their expansion for C = 1 + 2 e, fibre along axis 1."""
    i1, i4, i5, j = sym("I1 I4 I5 J")
    e, small = _strain(), sp.Symbol("s", positive=True)
    c = sp.eye(3) + 2 * small * e
    log_j = sp.log(c.det(method="berkowitz")) / 2
    terms = (i1 - 3, sp.log(j), (j - 1) ** 2, i4 - 1, sp.log(j) * (i4 - 1), (i4 - 1) ** 2, i5 - 1)
    values = {i1: c.trace(), i4: c[0, 0], i5: (c * c)[0, 0]}
    expanded = []
    for term in terms:
        value = term.subs(sp.log(j), log_j).subs(j, sp.exp(log_j)).subs(values)
        expanded.append(sum(sp.diff(value, small, n).subs(small, 0) / sp.factorial(n) for n in (0, 1, 2)))
    return _Basis(terms, tuple(sp.expand(sp.simplify(value)) for value in expanded))


@cache
def _spencer() -> sp.Expr:
    lam, mu_t, mu_l, alpha, beta = sym("lam_e mu_T mu_L alpha_e beta_e")
    e = _strain()
    square = e * e
    return (
        lam / 2 * e.trace() ** 2 + mu_t * square.trace() + alpha * e.trace() * e[0, 0]
        + 2 * (mu_l - mu_t) * square[0, 0] + beta / 2 * e[0, 0] ** 2
    )  # fmt: skip


@cache
def _coefficients() -> tuple[tuple[sp.Symbol, ...], dict[sp.Symbol, sp.Expr]]:
    unknowns = sp.symbols("c1:8", real=True)
    residual = sp.expand(sp.Add(*(c * t for c, t in zip(unknowns, _basis().expanded, strict=True))) - _spencer())
    strains = sorted(_strain().free_symbols, key=str)
    equations = sp.Poly(residual, *strains).coeffs()
    return unknowns, sp.solve(equations, unknowns, dict=True)[0]


@cache
def _potential() -> sp.Expr:
    unknowns, solved = _coefficients()
    return sp.Add(*(solved[c] * t for c, t in zip(unknowns, _basis().terms, strict=True)))


@derives("10")
def elastic_potential(printed: Printed) -> Derivation:
    """The coefficients that the premises force."""
    unknowns, solved = _coefficients()
    names = ("I1 - 3", "ln J", "(J - 1)^2", "I4 - 1", "ln J (I4 - 1)", "(I4 - 1)^2", "I5 - 1")
    residual = _linear_part(printed.value)
    steps = (
        Step(
            "first-order part of the printed potential at F = 1 (must vanish), over the strain along the fibre",
            residual,
        ),
        *(Step(f"coefficient of {name}", solved[c]) for name, c in zip(names, unknowns, strict=True)),
        Step(
            "the printed coefficient of ln J (I4 - 1) holds for an alpha that is Spencer's times",
            _times(printed, solved),
        ),
    )
    shown = (
        "1/2*mu_T*(I1 - 3) - mu_T*ln(J) + 1/2*lam_e*(J - 1)**2"
        " + ((mu_T - mu_L) + alpha_e/2*ln(J) + beta_e/8*(I4 - 1))*(I4 - 1) - 1/2*(mu_T - mu_L)*(I5 - 1)"
    )
    i4 = sym("I4")[0]
    brackets = [solved[unknowns[3]] + solved[unknowns[4]] * _basis().terms[1] + solved[unknowns[5]] * (i4 - 1)]
    expected = [solved[c] * t for c, t in zip(unknowns, _basis().terms, strict=True)]
    parts = dict(zip(
        ("term in I1", "term in ln J", "term in (J-1)^2", "bracket with alpha and beta (Spencer's)", "term in I5"),
        (expected[0], expected[1], expected[2], brackets[0] * (i4 - 1), expected[6]), strict=True,
    ))  # fmt: skip
    return equals(printed, _potential(), _PREMISES, steps, shown=shown, parts=parts)


def _times(printed: Printed, solved: dict[sp.Symbol, sp.Expr]) -> sp.Expr:
    """Derived over printed coefficient of ln J (I4 - 1)."""
    i4, j = sym("I4 J")
    coupled = sp.diff(printed.value, i4).subs(i4, 1)
    return sp.simplify(solved[sp.Symbol("c5", real=True)] / (sp.diff(coupled, j) * j))


def _linear_part(potential: sp.Expr) -> sp.Expr:
    """Slope of a potential of I1, I4, I5, J along the fibre at F = 1, over the strain e_11; half the residual stress."""
    i1, i4, i5, j = sym("I1 I4 I5 J")
    rates = {i1: 2, i4: 2, i5: 4, j: 1}
    natural = {i1: 3, i4: 1, i5: 1, j: 1}
    return sp.simplify(sp.Add(*(sp.diff(potential, i).subs(natural) * rate for i, rate in rates.items())))
