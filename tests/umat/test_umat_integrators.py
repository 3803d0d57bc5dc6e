"""Two-step rates: against the witness with a history, second order over the programme, and where the history ends."""

from dataclasses import replace

import numpy as np
import pytest

from oracle import PROPERTY_NAMES, State, random_states
from oracle.compare import relative_error
from oracle.history import Past, witness_after
from plyflow.case.case import PLY_KINDS, Case, property_values, props_vector
from plyflow.driver.drive import Controls, History, Step, drive
from plyflow.run.case_run import case_controls, run_case
from plyflow.umat.compile import compile_umat
from plyflow.umat.library import CallResult, UmatLibrary
from plyflow.umat.prepare import prepare_umat
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
    from plyflow.umat.prepare import Umat

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


def stop_and_go(umat: UmatLibrary, state_variables: int, props: np.ndarray) -> list[CallResult]:
    """Three seconds at 1e-3/s, three at rest, two more at 1e-3/s, all in one step of increments of 1 s."""
    statev, start, answers = np.zeros(state_variables), np.eye(3), []
    for increment, strain in enumerate((1, 2, 3, 3, 3, 3, 4, 5), 1):
        end = np.diag([1.0, np.exp(1.0e-3 * strain), np.exp(-1.0e-3 * strain)])
        answers.append(umat.call(start, end, 1.0, props, statev, increment=increment))
        statev, start = answers[-1].statev, end
    return answers


def default_props() -> np.ndarray:
    manifest = prepare_umat().manifest
    return np.array(props_vector(property_values(Case("IM7-8552", 70.0, "BP", 15.0), manifest), manifest))


@each_formula
def test_an_increment_at_rest_is_no_history(formula: str, umat: UmatLibrary) -> None:
    """The first increment after it is that of the default scene; planted: it is a history like any other."""
    expected = stop_and_go(umat, 8, default_props())[6].stress
    source = generate(SCENES[formula]).source
    assert source.count("j2_last > j2_floor") == 1
    broken = UmatLibrary(compile_umat(source.replace("j2_last > j2_floor", "j2_last > -1.0d0  ")))
    found, spoilt = (stop_and_go(u, 15, default_props())[6].stress for u in (library(SCENES[formula]), broken))
    assert relative_error(found, expected) <= 1.0e-13
    assert relative_error(spoilt, expected) > 1.0e-2


@each_formula
def test_dissipation_is_the_work_of_the_viscous_stress_on_the_increment(formula: str) -> None:
    """S:(C1 - C0)/2 with nothing elastic; nothing moves, nothing is dissipated. Planted: the rate at the end twice."""
    scene = replace(SCENES[formula], name="viscous", elastic=False, incompressibility="none")
    generated = generate(scene)
    names = [row["name"] for row in generated.manifest["statev"]]  # type: ignore[attr-defined]
    constants = [row["name"] for row in generated.manifest["props"]]  # type: ignore[attr-defined]
    broken = generated.source.replace("cdot(1:3)*rate_mean(1:3)", "cdot(1:3)*cdot(1:3)     ")
    assert broken != generated.source
    errors = [work_errors(UmatLibrary(compile_umat(s)), formula, names, constants) for s in (generated.source, broken)]
    assert errors[0] <= 1.0e-11
    assert errors[1] > 1.0e-3


def work_errors(umat: UmatLibrary, formula: str, names: list[str], constants: list[str]) -> float:
    worst, states = 0.0, random_states(11, 8, False, (1.0e-3, 1.0e-1), relative_rotation=False)
    for state, past in zip(states, pasts(states, formula), strict=True):
        values = {f"rate_{i + 1}{j + 1}": past.rate[i, j] for i, j in VOIGT} | {"dt_last": past.length}
        statev = np.array([values.get(name, 0.0) for name in names])
        props = [state.props[PROPERTY_NAMES.index(name)] for name in constants]
        found = umat.call(state.start, state.end, state.time_increment, props, statev, increment=2)
        s11, s22, s33, s12, s13, s23 = found.stress
        inverse = np.linalg.inv(state.end)
        piola = inverse @ np.array([[s11, s12, s13], [s12, s22, s23], [s13, s23, s33]]) @ inverse.T
        piola *= np.linalg.det(state.end)
        work = 0.5 * np.sum(piola * (state.end.T @ state.end - state.start.T @ state.start))
        worst = max(worst, abs(found.scd - max(0.0, work)) / np.abs(work))
        assert found.scd == found.statev[names.index("dissipation")]
        rest = umat.call(state.start, state.start, state.time_increment, props, statev, increment=2)
        worst = max(worst, rest.scd / abs(work))
    return worst


def plain_newton_from_rest(umat: UmatLibrary, props: np.ndarray) -> History:
    """One second to the peak of the programme and twenty there, each increment first tried without motion."""
    targets = {"11": 1.0, "22": 0.0, "33": 0.2, "12": 0.0, "13": 0.0, "23": 0.0}
    steps = [Step(1.0, targets, PLY_KINDS), Step(20.0, targets, PLY_KINDS)]
    controls = Controls(initial_increment=0.1, maximum_increment=5.0, newton="plain", extrapolation="none")
    return drive(umat, props, 15, steps, controls, temperature=70.0)


@each_formula
def test_plain_newton_without_extrapolation_ends_the_programme(formula: str) -> None:
    assert plain_newton_from_rest(library(SCENES[formula]), default_props()).completed


def test_plain_newton_needs_the_secant_where_the_mean_rate_vanishes() -> None:
    """Planted: the derivative of bdf2 where nothing moves, at a rate that runs against the last one."""
    source = generate(SCENES["bdf2"]).source
    broken = source.replace("IF (0.5d0*sum(rate_mean", "IF (9.9d9+sum(rate_mean")
    assert broken != source
    assert not plain_newton_from_rest(UmatLibrary(compile_umat(broken)), default_props()).completed


def width_over_the_blend(source: str) -> float:
    """Final width beside exp(-eps_lock), relative, where the lock is a blend; a second to 0.2 MPa and twenty there."""
    targets = {"11": 1.0, "22": 0.0, "33": 0.2, "12": 0.0, "13": 0.0, "23": 0.0}
    steps = [Step(1.0, targets, PLY_KINDS), Step(20.0, targets, PLY_KINDS)]
    controls = Controls(initial_increment=0.01, maximum_increment=5.0)
    history = drive(UmatLibrary(compile_umat(source)), default_props(), 15, steps, controls, temperature=70.0)
    assert history.completed
    assert history.statev[-1, LOCKED] == 1.0
    return float(abs(history.statev[-1, 1] * np.exp(default_props()[7]) - 1.0))


def test_no_history_is_carried_through_a_blended_lock() -> None:
    """The width is that of the lock. Planted: the direction of squeezing is carried on at the rate of bleeding."""
    source = generate(Scene(name="blended", lock="blend", integrator="bdf2log")).source
    planted = "IF (s_lock > s_start) statev(15) = 0.0d0"
    assert source.count(planted) == 1
    assert width_over_the_blend(source) < 5.0e-4
    assert width_over_the_blend(source.replace(planted, "")) > 1.0e-3


def test_printed_invariants_with_a_two_step_rate_are_refused() -> None:
    with pytest.raises(SceneError, match="integrator 'bdf2' goes with invariants 'transverse' only"):
        Scene(name="mixed", integrator="bdf2", invariants="printed")
