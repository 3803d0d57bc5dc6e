"""The instruments of the matrix themselves: witness laws, turned tensors, condition, verdicts."""

import math

import numpy as np
import pytest

from plyflow.evidence.stability.cells import Check, Verdict
from plyflow.evidence.stability.ledger import Ledger
from plyflow.evidence.stability.rounding import difference, measure_rounding
from plyflow.evidence.stability.states import random_increment, random_values, stage_increment
from plyflow.evidence.stability.subject import Subject
from plyflow.evidence.stability.tensors import (
    Array,
    elastic_moduli,
    elastic_stress,
    green,
    rotation,
    second_piola,
    tensor,
    turned_stress,
    turned_tangent,
)
from plyflow.umat.library import CallResult

AT_MOST = Check("group", "name", "number", 2.0)
AT_LEAST = Check("group", "name", "number", 2.0, at_least=True)
MAY_REFUSE = Check("group", "name", "number", 2.0, may_refuse=True)
SOFT = {"E_L": 40.0, "E_T": 2.0, "nu_LT": 0.25, "nu_TT": 0.3, "G_LT": 7.0}


def energy(right: Array) -> float:
    """Elastic energy of Eq. 10 with the sign and factor that make F = I stress free, MPa."""
    mu_t, mu_l, lam, alpha, beta = elastic_moduli(SOFT)
    volume, i4 = math.sqrt(np.linalg.det(right)), right[0, 0]
    i5 = (right @ right)[0, 0]
    bracket = (mu_t - mu_l) + 0.5 * alpha * math.log(volume) + 0.125 * beta * (i4 - 1.0)
    first = 0.5 * mu_t * (np.trace(right) - 3.0) - mu_t * math.log(volume) + 0.5 * lam * (volume - 1.0) ** 2
    return float(first + bracket * (i4 - 1.0) - 0.5 * (mu_t - mu_l) * (i5 - 1.0))


def test_elastic_witness_is_the_derivative_of_its_energy() -> None:
    right = green(np.array([[1.05, 0.1, -0.05], [0.02, 0.9, 0.1], [0.0, -0.1, 1.1]]))
    found, step = elastic_stress(right, SOFT), 1e-6
    for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
        moved = np.zeros((3, 3))
        moved[i, j] = moved[j, i] = step
        slope = (energy(right + moved) - energy(right - moved)) / (2.0 * step)
        assert found[i, j] == pytest.approx(slope * (2.0 if i == j else 1.0), rel=1e-7, abs=1e-8)


def test_turned_tangent_is_the_tangent_of_turned_strains() -> None:
    rng = np.random.default_rng(1)
    tangent, strain = rng.normal(size=(6, 6)), rng.normal(size=(3, 3))
    strain = strain + strain.T
    turn = rotation(0, 20.0) @ rotation(1, 50.0) @ rotation(2, 70.0)
    engineering = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
    place = ([0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2])
    plain = turned_stress(tangent @ (strain[place] * engineering), turn)
    moved = turned_tangent(tangent, turn) @ ((turn @ strain @ turn.T)[place] * engineering)
    assert np.abs(plain - moved).max() < 1e-12


def test_second_piola_is_pulled_back() -> None:
    gradient = np.array([[1.1, 0.2, 0.0], [0.0, 0.9, 0.1], [0.0, 0.3, 1.2]])
    stress = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    pushed = gradient @ second_piola(stress, gradient) @ gradient.T / np.linalg.det(gradient)
    assert np.abs(pushed - tensor(stress)).max() < 1e-12


def test_condition_grows_as_the_strain_increment_shrinks(subject: Subject) -> None:
    """The stress needs the difference of C at both ends: about one over the strain increment."""
    values = subject.values(subject.columns[6], kappa=0.0, E_L=1e-6)
    found = [measure_rounding(subject, *stage_increment(values, True, size), 1.0, values, True) for size in (1e-2, 1e-5)]
    ratio = found[1].condition / found[0].condition
    assert 300.0 < ratio < 3000.0
    assert all(one.share < 4.0 for one in found)


def test_difference_keeps_the_low_part_of_a_quadruple_number() -> None:
    assert difference(np.array([1.0, 1e-20]), np.array(1.0)) == 1e-20


def test_random_increments_are_the_same_every_time(subject: Subject) -> None:
    drawn = []
    for _ in range(2):
        rng = subject.generator(1)
        drawn.append([random_increment(random_values(subject, rng), locked, rng) for locked in (False, True)])
    for one, other in zip(*drawn, strict=True):
        assert np.array_equal(one.start, other.start) and one.values == other.values


def test_verdict_follows_bound_and_direction() -> None:
    assert AT_MOST.judge(2.0).verdict is Verdict.HOLDS
    assert AT_MOST.judge(2.1).verdict is Verdict.FAILS
    assert AT_LEAST.judge(2.0).verdict is Verdict.HOLDS
    assert AT_LEAST.judge(1.9).verdict is Verdict.FAILS
    assert {check.judge(math.nan).verdict for check in (AT_MOST, AT_LEAST)} == {Verdict.FAILS}


def test_refusal_needs_a_message_a_reason_and_good_numbers() -> None:
    assert MAY_REFUSE.refuse("no answer").verdict is Verdict.REFUSED
    assert MAY_REFUSE.refuse("  ").verdict is Verdict.FAILS
    assert MAY_REFUSE.refuse("no answer", 3.0).verdict is Verdict.FAILS
    assert AT_MOST.refuse("no answer").verdict is Verdict.FAILS


def answer(messages: str = "", pnewdt: float = 1e36, stopped: bool = False, stress: float = 0.0) -> CallResult:
    return CallResult(np.full(6, stress), np.zeros((6, 6)), np.zeros(8), 0.0, 0.0, 0.0, pnewdt, messages, stopped, np.zeros(6))


@pytest.mark.parametrize(
    ("result", "kind"),
    [
        (answer(stopped=True), "unsaid"),
        (answer("too far", pnewdt=1e36), "unsaid"),
        (answer("too far", pnewdt=0.25, stress=1.0), "wrong-sided"),
        (answer(stress=math.nan), "not finite"),
        (answer(stress=math.inf), "not finite"),
    ],
)
def test_ledger_enters_what_must_not_happen(subject: Subject, result: CallResult, kind: str) -> None:
    ledger = Ledger()
    ledger.audit_call(result, (np.eye(3), np.eye(3)), subject.values(subject.columns[0]), np.zeros(6), subject.statev())
    assert len(ledger.incidents[kind]) == ledger.total == 1


def test_ledger_lets_a_refusal_with_a_message_pass(subject: Subject) -> None:
    ledger = Ledger()
    result = answer("too far", pnewdt=0.25)
    ledger.audit_call(result, (np.eye(3), np.eye(3)), subject.values(subject.columns[0]), np.zeros(6), subject.statev())
    assert ledger.total == 0 and ledger.refusals == 1
