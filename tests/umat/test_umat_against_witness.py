"""The emitted UMAT against forty digits: stress, tangent, state and energies at random states."""

from dataclasses import replace

import numpy as np
import pytest

from oracle import PROPERTY_NAMES, State, energies, random_states, state_variables, ulp_sensitivity
from oracle.compare import (
    Array,
    relative_error,
    scaled_error,
    statev_at_start,
    umat_errors,
    witness_ddsdde,
    witness_stress,
)
from oracle.conditioning import tangent_components
from plyflow.umat.library import NO_OPINION, CallResult, UmatLibrary
from umat.planted import DDSDDE_TOLERANCE, REGIMES, STRESS_TOLERANCE, drawn

KAPPA = PROPERTY_NAMES.index("kappa")
SMALL = (1.0e-8, 1.0e-3)
each_regime = pytest.mark.parametrize("regime", REGIMES)
each_side = pytest.mark.parametrize("locked", [False, True], ids=["squeeze", "bleed"])


def answer(umat: UmatLibrary, state: State) -> CallResult:
    statev = statev_at_start(state.locked)
    result = umat.call(state.start, state.end, state.time_increment, state.props, statev)
    assert (result.pnewdt, result.messages) == (NO_OPINION, ""), "PNEWDT is touched by faults only"
    return result


def check(umat: UmatLibrary, states: list[State]) -> None:
    """Every state within the tolerances; the message names the worst."""
    errors = umat_errors(umat, states)
    for state, error in zip(states, errors, strict=True):
        assert error.stress <= STRESS_TOLERANCE, f"stress off by {error.stress:.1e}: {state.label}"
        assert error.ddsdde <= DDSDDE_TOLERANCE, f"ddsdde off by {error.ddsdde:.1e}: {state.label}"


@each_regime
@pytest.mark.parametrize("seed", [1, 2])
def test_stress_and_ddsdde_match_forty_digits(umat: UmatLibrary, regime: str, seed: int) -> None:
    """50 states: shear, fibre stretch, ends turned together or apart up to 180 degrees, dt 1e-6 to 1e3 s."""
    check(umat, drawn(regime, seed, 50))


@each_side
def test_small_increments_lose_nothing_when_both_ends_are_turned_together(umat: UmatLibrary, locked: bool) -> None:
    """Strain increments down to 1e-8: C1 - C0 must not be the difference of two rounded tensors."""
    check(umat, random_states(3, 50, locked, SMALL, relative_rotation=False))


@each_regime
def test_ddsdde_matches_entry_by_entry_in_the_scale_of_its_row_and_column(umat: UmatLibrary, regime: str) -> None:
    for state in drawn(regime, 4, 50):
        assert scaled_error(answer(umat, state).ddsdde, witness_ddsdde(state)) <= DDSDDE_TOLERANCE


@each_side
def test_small_increments_between_ends_turned_apart_are_as_good_as_their_input(umat: UmatLibrary, locked: bool) -> None:
    """One ulp of F0 or F1 moves the answer by up to 1e-7 here; the UMAT's error stays below that."""
    for state in random_states(5, 8, locked, SMALL, relative_rotation=True):
        error = umat_errors(umat, [state])[0]
        assert error.stress <= max(STRESS_TOLERANCE, ulp_sensitivity(state))
        assert error.ddsdde <= max(STRESS_TOLERANCE, ulp_sensitivity(state, tangent_components))


@pytest.mark.parametrize("kappa", [1.0e5, 1.0e9])
def test_stiff_penalty_is_as_good_as_its_input(umat: UmatLibrary, kappa: float) -> None:
    """With the volume held to 1e-6, one ulp of F is 1e-10 of the pressure; the tangent does not suffer."""
    for state in nearly_incompressible(kappa):
        error = umat_errors(umat, [state])[0]
        assert error.stress <= max(STRESS_TOLERANCE, ulp_sensitivity(state))
        assert error.ddsdde <= STRESS_TOLERANCE


def nearly_incompressible(kappa: float) -> list[State]:
    """States stretched along the fibre to a volume ratio of 1 - 1e-6: the transverse block stays."""
    states = []
    for state in random_states(6, 12, False, (1e-5, 1e-3), relative_rotation=False):
        stretch = np.diag([(1 - 1e-6) / np.linalg.det(state.end), 1.0, 1.0])
        props = with_property(state.props, "kappa", kappa)
        states.append(replace(state, start=state.start @ stretch, end=state.end @ stretch, props=props))
    return states


def with_property(props: Array, name: str, value: float) -> Array:
    """PROPS with one of them replaced."""
    changed = props.copy()
    changed[PROPERTY_NAMES.index(name)] = value
    return changed


def test_penalty_ends_at_the_lock(umat: UmatLibrary) -> None:
    for state in random_states(11, 6, True):
        stiff = replace(state, props=with_property(state.props, "kappa", 1.0e9))
        assert np.array_equal(answer(umat, stiff).stress, answer(umat, state).stress)
        assert answer(umat, stiff).statev[5] == 0.0


@each_regime
def test_statev_reports_the_kinematics_of_the_end(umat: UmatLibrary, regime: str) -> None:
    for state in drawn(regime, 7, 30):
        statev = answer(umat, state).statev
        arguments = (state.start, state.end, state.time_increment, state.props, state.locked)
        wanted = [float(value) for value in state_variables(*arguments)]
        found = [*statev[:4], *statev[5:7]]
        assert found[:4] == pytest.approx(wanted[:4], rel=1e-12)
        assert found[4] == pytest.approx(wanted[4], rel=1e-12, abs=1e-15 * state.props[KAPPA])
        rate_scale = state.strain_increment / state.time_increment
        assert found[5] == pytest.approx(wanted[5], rel=1e-12, abs=1e-12 * rate_scale)
        assert statev[4] == float(regime != "squeeze")


@each_regime
def test_energies_match_forty_digits(umat: UmatLibrary, regime: str) -> None:
    for state in drawn(regime, 8, 30):
        found = answer(umat, state)
        arguments = (state.start, state.end, state.time_increment, state.props, state.locked)
        wanted = energies(*arguments)
        stored = float(wanted.elastic + wanted.penalty)
        assert found.sse == pytest.approx(stored, rel=1e-10)
        assert found.scd == pytest.approx(float(wanted.dissipation), rel=1e-11)
        assert found.statev[7] == pytest.approx(float(wanted.dissipation), rel=1e-11)


def test_dissipation_accumulates(umat: UmatLibrary) -> None:
    state = random_states(9, 1, True)[0]
    before = statev_at_start(True)
    before[7] = 2.5
    after = umat.call(state.start, state.end, state.time_increment, state.props, before)
    assert after.statev[7] - 2.5 == pytest.approx(after.scd, rel=1e-9, abs=1e-15)


@each_side
def test_answer_turns_with_the_end_and_ignores_a_turn_of_the_start(umat: UmatLibrary, locked: bool) -> None:
    """A quarter turn is exact in doubles, so nothing but the order of sums may change."""
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    for state in random_states(10, 12, locked, relative_rotation=False):
        plain = answer(umat, state).stress
        statev = statev_at_start(locked)
        turned = umat.call(quarter @ state.start, quarter @ state.end, state.time_increment, state.props, statev)
        expected = plain[[1, 0, 2, 3, 5, 4]] * np.array([1, 1, 1, -1, -1, 1])
        assert relative_error(turned.stress, expected) < 1e-14


def test_comparison_sees_one_part_in_ten_to_the_eleven() -> None:
    """The measure itself: an error just above the tolerance in the smallest component is still seen."""
    state = random_states(1, 1, False)[0]
    sigma = witness_stress(state)
    smallest = int(np.argmin(np.abs(sigma)))
    wrong = sigma.copy()
    wrong[smallest] += 2e-12 * np.max(np.abs(sigma))
    assert relative_error(wrong, sigma) > STRESS_TOLERANCE
    assert relative_error(sigma, sigma) == 0.0
    assert relative_error(np.full(6, np.nan), sigma) == float("inf")
