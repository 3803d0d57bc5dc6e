"""The oracle's elastic part: hand formulas against differentiation, the state F = I, the compliance."""

from collections.abc import Callable

import numpy as np
import pytest
from mpmath import mp

from oracle import Properties, State, ddsdde, elastic_constants, random_states, stress
from oracle.algebra import Real, Tensor, add, build, inverse, right_cauchy_green, scale, strain_basis, subtract, tensor
from oracle.elastic import elastic_energy, elastic_stress, penalty_energy, penalty_stress
from oracle.properties import normal_compliance

STATES = random_states(11, 4, locked=False)
IDENTITY = np.eye(3)
each_state = pytest.mark.parametrize("state", STATES, ids=lambda state: state.label)


def gradient(energy: Callable[[Tensor, Properties], Real], c: Tensor, p: Properties) -> Tensor:
    """2 dE/dC by central differences: a strain basis of C/2, so that off-diagonal pairs move together."""
    step = mp.mpf("1e-25")
    slopes = []
    for component in range(6):
        e = scale(2 * step, strain_basis(component))
        slopes.append((energy(add(c, e), p) - energy(subtract(c, e), p)) / (2 * step))
    order = ((0, 3, 4), (3, 1, 5), (4, 5, 2))
    return build(lambda i, j: slopes[order[i][j]])


def largest(a: Tensor) -> Real:
    return max(abs(entry) for row in a for entry in row)


def distance(a: Tensor, b: Tensor) -> Real:
    return largest(subtract(a, b)) / largest(b)


@each_state
def test_elastic_stress_is_twice_the_gradient_of_the_potential(state: State) -> None:
    with mp.workdps(90):
        p, c = Properties.of(state.props), right_cauchy_green(tensor(state.end))
        assert distance(gradient(elastic_energy, c, p), elastic_stress(c, p)) < mp.mpf("1e-30")


@each_state
def test_penalty_stress_is_twice_the_gradient_of_the_penalty(state: State) -> None:
    with mp.workdps(90):
        p, c = Properties.of(state.props), right_cauchy_green(tensor(state.end))
        assert distance(gradient(penalty_energy, c, p), penalty_stress(c, p)) < mp.mpf("1e-30")


def test_gradient_check_sees_a_planted_error() -> None:
    state = STATES[1]
    with mp.workdps(90):
        p, c = Properties.of(state.props), right_cauchy_green(tensor(state.end))
        wrong = add(elastic_stress(c, p), scale(p.G_LT * mp.mpf("1e-20"), inverse(c)))
        assert distance(gradient(elastic_energy, c, p), wrong) > mp.mpf("1e-30")


@pytest.mark.parametrize("locked", [False, True], ids=["squeeze", "bleed"])
@each_state
def test_undeformed_state_is_stress_free(state: State, locked: bool) -> None:
    assert largest(stress(IDENTITY, IDENTITY, 1.0, state.props, locked)) < mp.mpf("1e-35")


@each_state
def test_stiffness_at_rest_is_the_inverse_of_the_compliance(state: State) -> None:
    """A huge dt removes the flow; the locked regime has no penalty; all 36 components are compared."""
    stiffness = ddsdde(IDENTITY, IDENTITY, "1e40", state.props, True)
    with mp.workdps(60):
        p = Properties.of(state.props)
        compliance = mp.zeros(6)
        for i, row in enumerate(normal_compliance(p)):
            for j, entry in enumerate(row):
                compliance[i, j] = entry
        shears = (1 / p.G_LT, 1 / p.G_LT, 2 * (1 + p.nu_TT) / p.E_T)
        for i, entry in enumerate(shears, start=3):
            compliance[i, i] = entry
        unity = mp.matrix([list(row) for row in stiffness]) * compliance
        assert max(abs(unity[i, j] - (i == j)) for i in range(6) for j in range(6)) < mp.mpf("1e-15")


def test_constants_of_table_4_are_positive() -> None:
    """The compliance admits the paper's Table 4 (the printed formulas with one Poisson ratio do not)."""
    with mp.workdps(40):
        constants = elastic_constants(Properties.of(STATES[0].props))
        assert constants.mu_T > 0 and constants.mu_L > 0 and constants.lam > 0 and constants.beta > 0
