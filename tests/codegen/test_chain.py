"""Named definitions: bounded partials and stable forms are what they stand for."""

from __future__ import annotations

import pytest
import sympy as sp

from umatgen.model.chain import Chain, Definition
from umatgen.model.kinematics import mohr_definitions, rate_definitions
from umatgen.model.viscous import factors, law_definitions
from umatgen.notation import sym

DEFINITIONS = [*mohr_definitions(), *rate_definitions(), *law_definitions(), factors("squeeze")[0]]
A_DIFF, A23, RADIUS, COS2, SIN2, STRETCH, X_END = sym("a_diff", "a23", "radius", "cos2", "sin2", "stretch", "x_end")
MEANING = {COS2: A_DIFF / RADIUS, SIN2: A23 / RADIUS}


def in_primitives(expr: sp.Expr) -> sp.Expr:
    """The expression with directions and definitions written out."""
    return Chain(DEFINITIONS).expand(expr.subs(MEANING))


def partial_error(definition: Definition) -> list[sp.Expr]:
    """Differences between the partials in use and the derivatives of the definition, simplified."""
    return [
        sp.simplify(in_primitives(definition.partial(s)) - in_primitives(sp.diff(definition.expr, s)))
        for s in definition.arguments
    ]


@pytest.mark.parametrize("definition", DEFINITIONS, ids=lambda d: d.symbol.name)
def test_partials_are_the_derivatives_of_the_definition(definition: Definition) -> None:
    assert set(partial_error(definition)) <= {0}
    assert set(definition.arguments) == definition.expr.free_symbols


def test_a_planted_sign_in_a_partial_is_seen() -> None:
    wrong = Definition(RADIUS, sp.sqrt(A_DIFF**2 + A23**2), "", partials={A_DIFF: -COS2, A23: SIN2})
    assert any(e != 0 for e in partial_error(wrong))


@pytest.mark.parametrize("definition", [d for d in DEFINITIONS if d.stable is not None], ids=lambda d: d.symbol.name)
def test_the_stable_form_equals_the_definition(definition: Definition) -> None:
    assert sp.simplify(in_primitives(definition.stable) - in_primitives(definition.expr)) == 0
    assert sp.simplify(in_primitives(definition.stable + X_END / 100) - in_primitives(definition.expr)) != 0


def test_the_chain_differentiates_through_names() -> None:
    chain = Chain(DEFINITIONS)
    (a22,) = sym("a22")
    named = chain.derivative(sp.log(STRETCH), a22)
    direct = sp.diff(chain.expand(sp.log(STRETCH)), a22)
    state = {a22: sp.Rational(9, 10), sym("a33")[0]: sp.Rational(13, 10), A23: sp.Rational(1, 5)}
    assert abs((in_primitives(named) - direct).subs(state).evalf(40)) < sp.Float("1e-35")


def test_a_name_is_defined_once() -> None:
    with pytest.raises(ValueError, match="defined twice"):
        Chain([*DEFINITIONS, DEFINITIONS[0]])
