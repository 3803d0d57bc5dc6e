"""Two-step rates: against the witness with a history, second order over the programme, and where the history ends."""

from dataclasses import replace

import numpy as np
import pytest

from oracle import State, random_states
from oracle.compare import relative_error
from oracle.history import Past, witness_after
from plyflow.cases import Case
from plyflow.compile import compile_umat
from plyflow.host import CallResult, UmatLibrary
from plyflow.results import case_controls, run_case
from plyflow.umat import prepare_umat
from umatgen.pipeline import generate
from umatgen.scene import SCENES, Scene, SceneError

FORMULAS = ("bdf2", "bdf2log")
LOCKED, RATE, LENGTH = 4, slice(8, 14), 14
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
STRESS_TOLERANCE, DDSDDE_TOLERANCE = 1.0e-12, 1.0e-9
each_formula = pytest.mark.parametrize("formula", FORMULAS)


def library(scene: Scene) -> UmatLibrary:
    return UmatLibrary(compile_umat(generate(scene).source))


def pasts(states: list[State], formula: str) -> list[Past]:
    """A last rate in the direction of this increment's, turned a little, 0.3 to 3 times as large; dt'/dt 0.3 to 3."""
    rng = np.random.default_rng(17)
    found = []
    for state in states:
        mean = (state.end.T @ state.end - state.start.T @ state.start) / state.time_increment
        turned = mean + 0.3 * np.abs(mean).max() * rng.normal(size=(3, 3))
        factor, length = np.exp(rng.uniform(-1.2, 1.2, size=2))
        found.append(Past(factor * (turned + turned.T) / 2, float(length * state.time_increment), formula))
    return found


def answer(umat: UmatLibrary, state: State, past: Past, increment: int = 2) -> CallResult:
    statev = np.zeros(15)
    statev[LOCKED] = float(state.locked)
    statev[RATE] = [past.rate[i, j] for i, j in VOIGT]
    statev[LENGTH] = past.length
    return umat.call(state.start, state.end, state.time_increment, state.props, statev, increment=increment)


def largest_errors(umat: UmatLibrary, formula: str, locked: bool, count: int = 12) -> tuple[float, float]:
    states = random_states(11, count, locked, (1.0e-3, 1.0e-1), relative_rotation=False)
    worst = [0.0, 0.0]
    for state, past in zip(states, pasts(states, formula), strict=True):
        found, (sigma, tangent) = answer(umat, state, past), witness_after(state, past)
        worst[0] = max(worst[0], relative_error(found.stress, sigma))
        worst[1] = max(worst[1], relative_error(found.ddsdde, tangent))
    return worst[0], worst[1]


@each_formula
@pytest.mark.parametrize("locked", [False, True], ids=["squeeze", "bleed"])
def test_stress_and_ddsdde_match_the_witness_with_a_history(formula: str, locked: bool) -> None:
    sigma, tangent = largest_errors(library(SCENES[formula]), formula, locked)
    assert sigma <= STRESS_TOLERANCE
    assert tangent <= DDSDDE_TOLERANCE


@pytest.mark.parametrize(
    ("text", "planted"),
    [("y_turn(3) = -growth*y_mean(3)", "y_turn(3) = growth*y_mean(3)"), ("history = dt/(dt +", "history = 1/(dt +")],
    ids=["turn", "weight"],
)
def test_a_planted_error_is_seen_by_the_witness(text: str, planted: str) -> None:
    source = generate(SCENES["bdf2log"]).source
    assert source.count(text) == 1
    broken = UmatLibrary(compile_umat(source.replace(text, planted)))
    assert max(largest_errors(broken, "bdf2log", False, 4)) > 1.0e-6


@each_formula
def test_without_history_it_is_the_one_step_formula(umat: UmatLibrary, formula: str) -> None:
    """No last increment, or the first one of a step: the default scene's answer."""
    scene = library(SCENES[formula])
    for state in random_states(5, 6, False):
        past = Past(np.ones((3, 3)), 1.0, formula)
        expected = umat.call(state.start, state.end, state.time_increment, state.props, np.zeros(8))
        for found in (answer(scene, state, past, increment=1), answer(scene, state, past._replace(length=0.0))):
            assert relative_error(found.stress, expected.stress) <= 1.0e-13
            assert relative_error(found.ddsdde, expected.ddsdde) <= 1.0e-13
        assert np.any(answer(scene, state, past).stress != expected.stress)


@each_formula
def test_the_history_is_this_increments_and_ends_at_the_lock(formula: str) -> None:
    scene = library(SCENES[formula])
    state = random_states(7, 1, False)[0]
    after = answer(scene, state, Past(np.zeros((3, 3)), 0.0, formula)).statev
    mean = (state.end.T @ state.end - state.start.T @ state.start) / state.time_increment
    np.testing.assert_allclose(after[RATE], [mean[i, j] for i, j in VOIGT], rtol=1e-10, atol=1e-12 * np.abs(mean).max())
    assert after[LENGTH] == state.time_increment
    eps_lock = state.props[7]
    lands = np.diag([1.0, np.exp(-eps_lock), np.exp(eps_lock)])
    landing = replace(state, start=np.eye(3), end=lands, time_increment=1.0)
    ended = answer(scene, landing, Past(np.zeros((3, 3)), 0.0, formula)).statev
    assert (ended[LOCKED], ended[LENGTH]) == (1.0, 0.0)


@pytest.mark.parametrize(("formula", "order"), [("default", 1.0), ("bdf2", 2.0), ("bdf2log", 2.0)])
def test_order_over_the_whole_programme_with_the_lock_in_it(formula: str, order: float) -> None:
    """Final thickness beside the one-dimensional law, increments halved twice; the lock is passed on the way."""
    umat, case = prepare_umat(formula), Case("IM7-8552", 70.0, "BP", 15.0)
    results = [run_case(case, umat, case_controls(refinement)) for refinement in (1.0, 2.0, 4.0)]
    assert all(result.lock_time is not None for result in results)
    errors = np.abs([result.thickness_ratio[-1] - result.law.thickness_ratio[-1] for result in results])
    measured = np.log2(errors[:-1] / errors[1:])
    np.testing.assert_allclose(measured, order, atol=0.15)


def test_a_rate_forgotten_costs_the_order() -> None:
    """Planted: the history is never used; the second order is gone."""
    from plyflow.umat import Umat

    good = prepare_umat("bdf2")
    source = generate(SCENES["bdf2"]).source
    broken = UmatLibrary(compile_umat(source.replace("IF (kinc > 1 .AND.", "IF (kinc < 0 .AND.")))
    umat: Umat = replace(good, library=broken)
    case = Case("IM7-8552", 70.0, "BP", 15.0)
    results = [run_case(case, umat, case_controls(refinement)) for refinement in (1.0, 2.0)]
    errors = [abs(r.thickness_ratio[-1] - r.law.thickness_ratio[-1]) for r in results]
    assert errors[0] / errors[1] < 2.2


@each_formula
def test_every_case_of_the_programme_ends_closer_than_with_one_step(formula: str) -> None:
    """Three temperatures, the default increments: the error falls at each, the lock stays where it is."""
    for temperature in (30.0, 50.0, 90.0):
        case = Case("IM7-8552", temperature, "CP", 15.0)
        one, two = (run_case(case, prepare_umat(name)) for name in ("default", formula))
        error_one, error_two = (abs(r.thickness_ratio[-1] - r.law.thickness_ratio[-1]) for r in (one, two))
        assert error_two < error_one
        assert abs(two.width_ratio[-1] - one.width_ratio[-1]) < 5.0e-5


def test_printed_invariants_with_a_two_step_rate_are_refused() -> None:
    with pytest.raises(SceneError, match="integrator 'bdf2' goes with invariants 'transverse' only"):
        Scene(name="mixed", integrator="bdf2", invariants="printed")
