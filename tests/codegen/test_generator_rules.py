"""The tensor skeleton: every rule of the generator table against componentwise differentiation, in exact arithmetic."""

from __future__ import annotations

import itertools

import pytest
import sympy as sp

from symbolic_state import INVARIANTS, MATERIAL, C, derivative, states
from umatgen.model.generators import NORMAL, TRANSVERSE, Generator, derivative_rules, gradient_rules, odot
from umatgen.notation import TABLE

STATES = states()
PAIRS = [(i, j) for i in range(3) for j in range(i, 3)]


def gradient_error(name: str, rule: dict[Generator, sp.Expr]) -> sp.Expr:
    """Largest difference between a gradient rule and the componentwise derivative, over exact states."""
    names = {TABLE.symbol(n): expr for n, expr in INVARIANTS.items()} | {TABLE.symbol("stretch"): sp.sqrt(INVARIANTS["x_end"])}
    total = sp.zeros(3, 3)
    for generator, weight in rule.items():
        total += weight.subs(names) * MATERIAL[generator]
    wanted = sp.Matrix(3, 3, lambda i, j: derivative(INVARIANTS[name], i, j))
    return max(abs(sp.nsimplify(d)) for s in STATES for d in (total - wanted).subs(s))


def derivative_error(generator: Generator, rule: dict[tuple[Generator, Generator], sp.Expr]) -> sp.Expr:
    """Largest difference between a product rule and the componentwise derivative of a generator."""
    worst = sp.S.Zero
    for (i, j), (k, m) in itertools.product(PAIRS, PAIRS):
        value = sp.S.Zero
        for (a, b), weight in rule.items():
            value += weight * odot(MATERIAL[a], MATERIAL[b], i, j, k, m)
        difference = value - derivative(MATERIAL[generator][i, j], k, m)
        worst = max(worst, *(abs(sp.nsimplify(difference.subs(s))) for s in STATES[:2]))
    return worst


@pytest.mark.parametrize("name", sorted(INVARIANTS))
def test_gradient_rule_is_the_derivative_with_respect_to_c(name: str) -> None:
    assert gradient_error(name, gradient_rules()[TABLE.symbol(name)]) == 0


@pytest.mark.parametrize("generator", sorted(set(MATERIAL) - {NORMAL, TRANSVERSE}), ids=lambda g: g.key)
def test_product_rule_is_the_derivative_of_the_generator(generator: Generator) -> None:
    assert derivative_error(generator, derivative_rules().get(generator, {})) == 0


def test_a_planted_factor_in_a_gradient_rule_is_seen() -> None:
    rule = {g: 2 * w for g, w in gradient_rules()[TABLE.symbol("det_f")].items()}
    assert gradient_error("det_f", rule) > 0


def test_a_planted_sign_in_a_product_rule_is_seen() -> None:
    generator = next(g for g in derivative_rules() if g.key == "unit")
    rule = {pair: -w for pair, w in derivative_rules()[generator].items()}
    assert derivative_error(generator, rule) > 0


def test_every_invariant_and_every_changing_generator_has_a_rule() -> None:
    assert {s.name for s in gradient_rules()} == set(INVARIANTS)
    changing = {g for g in MATERIAL if MATERIAL[g].free_symbols & C.free_symbols}
    assert set(derivative_rules()) == changing - {NORMAL, TRANSVERSE}, "those two are right factors only"
