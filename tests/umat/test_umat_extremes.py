"""Stiff and extreme points: times from 1e-10 to 1e6 s, no rate, rotations alone, coincident stretches."""

from dataclasses import replace

import numpy as np
import pytest

from oracle import PROPERTY_NAMES, State, properties_of, random_states, stress, ulp_sensitivity
from oracle.algebra import VOIGT, voigt
from oracle.compare import Array, statev_at_start, umat_errors
from oracle.states import random_rotation
from plyflow.umat.library import UmatLibrary
from umat.planted import DDSDDE_TOLERANCE, STRESS_TOLERANCE

ROWS, COLUMNS = np.transpose(VOIGT)
EPSILON = float(np.finfo(float).eps)
each_regime = pytest.mark.parametrize("locked", [False, True], ids=["squeeze", "bleed"])


@each_regime
@pytest.mark.parametrize("times", [(1e-10, 1e-6), (1e3, 1e6)], ids=["short", "long"])
def test_times_of_sixteen_decades_change_nothing(umat: UmatLibrary, locked: bool, times: tuple[float, float]) -> None:
    for error in umat_errors(umat, random_states(50, 20, locked, times=times)):
        assert error.stress <= STRESS_TOLERANCE and error.ddsdde <= DDSDDE_TOLERANCE


@each_regime
def test_no_rate_leaves_the_elastic_stress_and_a_finite_tangent(umat: UmatLibrary, locked: bool) -> None:
    for drawn in random_states(51, 20, locked):
        state = replace(drawn, start=drawn.end)
        error = umat_errors(umat, [state])[0]
        assert error.stress <= STRESS_TOLERANCE and error.ddsdde <= DDSDDE_TOLERANCE


def turned_elastic_stress(state: State, turn: Array) -> Array:
    """Stress without rate at the end of the increment, turned; MPa, (3, 3)."""
    rest = stress(state.end, state.end, state.time_increment, state.props, state.locked)
    turned: Array = turn @ np.array([[float(entry) for entry in row] for row in rest]) @ turn.T
    return turned


@each_regime
@pytest.mark.parametrize("angle", [1e-6, 0.1, 90.0, 179.0, 180.0])
def test_a_rotation_alone_flows_less_than_a_thousandth_of_the_strain_floor(
    umat: UmatLibrary, locked: bool, angle: float
) -> None:
    """Rounding in F is a strain of 1e-16; the floor of 1e-12 makes it a linear fluid, not a yield stress."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    for drawn in random_states(52, 10, locked):
        props = properties_of(eps_lock=drawn.props[PROPERTY_NAMES.index("eps_lock")], kappa=0.0)
        state = replace(drawn, start=drawn.end, end=turn @ drawn.end, props=props)
        found = umat.call(state.start, state.end, state.time_increment, props, statev_at_start(locked)).stress
        turned = turned_elastic_stress(replace(drawn, props=props), turn)
        creep = replace(drawn, start=drawn.end * (1 - 1e-12), props=props)
        floor = creeping_stress(creep)
        difference = np.abs(found - turned[ROWS, COLUMNS])
        assert np.max(difference) <= 1e-3 * floor + 100 * EPSILON * np.max(np.abs(turned))


def creeping_stress(state: State) -> float:
    """Largest component of the viscous stress of an increment, MPa."""
    arguments = (state.end, state.time_increment, state.props, state.locked)
    pair = [voigt(stress(start, *arguments)) for start in (state.start, state.end)]
    return max(abs(float(moving - resting)) for moving, resting in zip(*pair, strict=True))


@each_regime
@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14])
def test_nearly_coincident_stretches_cost_no_more_than_their_direction(
    umat: UmatLibrary, locked: bool, gap: float
) -> None:
    """The direction of the smallest stretch is known to an ulp over the gap; the stress does not need it."""
    rng = np.random.default_rng(53)
    for _ in range(5):
        angle, turn = rng.uniform(0.0, np.pi), np.eye(3)
        turn[1:, 1:] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        end = turn @ np.diag([1.01, np.exp(gap - 0.02), np.exp(-0.02)]) @ turn.T
        start = end + 1e-3 * rng.uniform(-1.0, 1.0, (3, 3))
        rotation = random_rotation(rng)
        props = properties_of(E_L=1.0, E_T=1e-2, G_LT=1e-2, kappa=1.0)
        state = State(rotation @ start, rotation @ end, 1.0, props, locked, 1e-3, "coincident")
        error = umat_errors(umat, [state])[0]
        assert error.stress <= STRESS_TOLERANCE
        assert error.ddsdde <= max(STRESS_TOLERANCE, EPSILON / gap)


@pytest.mark.parametrize("kappa", [0.0, 5.0e5])
@pytest.mark.parametrize("strain", [1e-3, 1e-2])
def test_stiff_fibres_and_penalty_are_as_good_as_their_input(umat: UmatLibrary, kappa: float, strain: float) -> None:
    """E_L/E_T = 2.5e7 (Table 4) and kappa/mu_T up to 1e12, fibre and volume held as well as doubles can."""
    end = np.diag([1.0, 1.0 / 0.96875, 0.96875])
    start = np.diag([1.0, 1.0 / (0.96875 * (1 + strain)), 0.96875 * (1 + strain)])
    state = State(start, end, 1.0, properties_of(kappa=kappa), False, strain, "held")
    error = umat_errors(umat, [state])[0]
    assert error.stress <= max(STRESS_TOLERANCE, ulp_sensitivity(state))
    assert error.ddsdde <= STRESS_TOLERANCE
