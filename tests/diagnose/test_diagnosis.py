"""A right tangent is called right, each planted mistake is found and named, and an unknown one is not explained away."""

from __future__ import annotations

import numpy as np
import pytest

from plyflow.diagnose.case import PROGRAMMES, programme
from plyflow.diagnose.check import diagnose
from plyflow.diagnose.mistakes import Point, catalogue, difference, fitting_mistakes, jaumann_terms
from plyflow.umat.library import UmatLibrary

RIGHT, RIGHT_UNSYMMETRIC, UNKNOWN = 0, 15, 11
PLANTED = {
    1: "no 1/J",
    2: "no Jaumann terms",
    3: "neither 1/J nor Jaumann terms",
    4: "derivative of the Cauchy stress",
    5: "Voigt order of the tangent: shears are in the order 23, 13, 12",
    6: "Voigt order of stress and tangent: shears are in the order 23, 13, 12",
    7: "tensor for engineering shear: the shear columns",
    8: "tensor for engineering shear: the shear stiffnesses",
    9: "half the shear columns",
    10: "material tangent dS/dE",
    13: "transposed",
    14: "symmetrised",
}
BOTH = 12


@pytest.mark.parametrize(("case", "number"), [*((name, RIGHT) for name in PROGRAMMES), ("general", RIGHT_UNSYMMETRIC)])
def test_a_right_tangent_is_called_right(neo_hooke: UmatLibrary, case: str, number: int) -> None:
    diagnosis = diagnose(neo_hooke, programme(case, [1.3, 4.1, number], 0))
    assert diagnosis.history.completed
    assert diagnosis.right
    # Central differences at strain steps of 1e-6 to 1e-4 of a smooth stress.
    assert diagnosis.worst.difference < 1e-8
    assert list(diagnosis.mistakes) == []


@pytest.mark.parametrize("number", PLANTED)
def test_a_planted_mistake_is_the_only_one_named(neo_hooke: UmatLibrary, number: int) -> None:
    diagnosis = diagnose(neo_hooke, programme("general", [1.3, 4.1, number], 0))
    assert not diagnosis.right
    assert len(diagnosis.mistakes) == 1
    assert diagnosis.mistakes[0].startswith(PLANTED[number])
    assert diagnosis.fit is not None
    assert diagnosis.fit < 1e-6


def test_two_mistakes_together_are_named_together(neo_hooke: UmatLibrary) -> None:
    named = diagnose(neo_hooke, programme("general", [1.3, 4.1, BOTH], 0)).mistakes
    assert any("no Jaumann terms" in text and "tensor for engineering shear" in text for text in named)
    assert all("no Jaumann terms" in text for text in named)


def test_an_unknown_mistake_is_located_but_not_explained(neo_hooke: UmatLibrary) -> None:
    diagnosis = diagnose(neo_hooke, programme("general", [1.3, 4.1, UNKNOWN], 0))
    assert not diagnosis.right
    assert list(diagnosis.mistakes) == []
    assert diagnosis.worst.entry == ("11", "22")
    assert diagnosis.worst.given == pytest.approx(1.3 * diagnosis.worst.right, rel=1e-6)


def test_a_path_that_cannot_tell_mistakes_apart_names_all_that_fit(neo_hooke: UmatLibrary) -> None:
    named = diagnose(neo_hooke, programme("uniaxial", [1.3, 4.1, 7], 0)).mistakes
    assert {text.partition(":")[2].strip() for text in named} == {
        "the shear columns are twice too large",
        "the shear stiffnesses are twice too large",
    }


def test_the_wrong_tangent_is_diagnosed_where_newton_fails_with_it(neo_hooke: UmatLibrary) -> None:
    assert diagnose(neo_hooke, programme("uniaxial", [1.3, 4.1, 10], 0)).mistakes[0].startswith("material tangent")


def test_mistakes_are_all_different_at_a_general_state() -> None:
    rng = np.random.default_rng(7)
    right = rng.standard_normal((6, 6))
    point = Point(np.eye(3) + 0.2 * rng.standard_normal((3, 3)), rng.standard_normal(6), right, right)
    tangents = [mistake.tangent(point) for mistake in catalogue()]
    for number, tangent in enumerate(tangents):
        assert difference(tangent, right) > 1e-3
        assert all(difference(tangent, other) > 1e-3 for other in tangents[:number])


def test_a_small_difference_is_not_taken_for_a_mistake() -> None:
    rng = np.random.default_rng(8)
    right = rng.standard_normal((6, 6))
    point = Point(np.diag([1.1, 0.9, 1.0]), np.zeros(6), right, right + 1e-3 * rng.standard_normal((6, 6)))
    assert fitting_mistakes([point], 1e-3) == ([], None)


def test_jaumann_terms_are_those_of_a_stretch_along_a_stress() -> None:
    terms = jaumann_terms(np.array([5.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert terms[0, 0] == 10.0  # 2 s_11
    assert terms[3, 3] == terms[4, 4] == 2.5  # s_11/2
    assert np.count_nonzero(terms) == 3
