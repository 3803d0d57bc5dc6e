"""The comparison itself: it sees a difference of one part in 1e27, refuses what it cannot decide, is deterministic."""

from __future__ import annotations

import mpmath as mp
import pytest
import sympy as sp

from umataudit.identity import UndecidedError, compare, reduces_to_zero
from umataudit.points import admissible_points, range_of
from umataudit.printed import Formula
from umataudit.printed.letters import sym


def test_equal_forms_hold_with_a_witness_of_thirty_digits() -> None:
    identity = compare(
        Formula("exp(-2*eps)*k/sqrt(chi_f)").value, Formula("k*chi_f**(-1/2)*exp(-eps)**2").value, "seed"
    )
    assert identity.holds
    assert len(identity.witnesses) == 3
    assert identity.largest < mp.mpf(10) ** -28


@pytest.mark.parametrize("factor", [sp.Integer(2), -sp.S.One, 1 + sp.Rational(1, 10**27)])
def test_a_factor_is_seen_however_close_to_one(factor: sp.Expr) -> None:
    value = Formula("(k/(sqrt(chi_f)*exp(eps) - k))**2 + 3").value
    assert not compare(factor * value, value, "seed").holds


def test_a_difference_in_one_component_of_a_tensor_is_seen() -> None:
    tensor = Formula("transpose(F) @ F").value
    other = tensor.copy()
    other[1, 2] += sp.Rational(1, 10**9)
    assert compare(tensor, tensor, "seed").holds
    assert not compare(tensor, other, "seed").holds


def test_powers_with_symbolic_exponents_are_reduced() -> None:
    left = Formula("(1/(2*((I1 - 1)**2 - 2*I3)))**((a + 2)/2)*J2**((a + 2)/2)").value
    right = Formula("(J2/(2*(I1**2 - 2*I1 + 1 - 2*I3)))**(a/2)*J2/(2*(I1**2 - 2*I1 + 1 - 2*I3))").value
    assert reduces_to_zero(left, right)
    assert not reduces_to_zero(left, 2 * right)


def test_what_agrees_numerically_but_is_not_reduced_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("umataudit.identity.reduces_to_zero", lambda left, right: False)
    x = sym("I1s")[0]
    with pytest.raises(UndecidedError, match="not reduced to zero"):
        compare(x, x, "seed")


def test_a_value_that_is_not_real_is_noticed() -> None:
    identity = compare(Formula("arcsin(2 + k)").value, Formula("k").value, "seed")
    assert not identity.real
    assert compare(Formula("arcsin(k)").value, Formula("k").value, "seed").real


def test_points_are_inside_their_ranges_and_the_same_on_every_run() -> None:
    symbols = sym("k eps a chi_f I1 sigma J2")
    first, second = (admissible_points(symbols, "seed", 5) for _ in range(2))
    assert first == second
    assert first != admissible_points(symbols, "another seed", 5)
    for point in first:
        for symbol, value in point.items():
            low, high = range_of(symbol)
            assert low < float(value) < high
