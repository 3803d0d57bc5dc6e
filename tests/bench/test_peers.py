"""The peers are the same material as the default scene, by other ways."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from plyflow.case.case import Case, driver_steps, property_values, props_vector
from plyflow.driver.drive import History, drive
from plyflow.evidence.bench.peers.differentiated import DifferentiatedUmat
from plyflow.evidence.bench.peers.fortran import PEERS, peer_library
from plyflow.run.case_run import case_controls
from plyflow.umat.prepare import Umat, prepare_umat

Array = NDArray[np.float64]
CASE = Case("IM7-8552", 70, "BP", 15)
# The rounding of J - 1 under the penalty (kappa = 1e5 MPa) for stresses; the step of the differences (1e-8) over the strain
# increment (1e-3) for the perturbed tangent.
STRESS, TANGENT, PERTURBED = 1e-11, 1e-12, 1e-4


@pytest.fixture(scope="module")
def umat() -> Umat:
    return prepare_umat("default")


def states(locked: bool) -> list[tuple[Array, Array]]:
    """Pairs F0, F1 in the stage, with shears."""
    generator = np.random.default_rng(3)
    base = np.diag([1.001, 1.08, 0.90] if locked else [1.001, 1.02, 0.98])
    starts = [base + 0.003 * generator.normal(size=(3, 3)) for _ in range(6)]
    return [(start, start + 0.001 * generator.normal(size=(3, 3))) for start in starts]


def library(name: str, umat: Umat) -> Any:
    """A peer by name."""
    if name == "tensortrax":
        return DifferentiatedUmat(umat.manifest)
    return peer_library(name)


def call(name: str, umat: Umat, start: Array, end: Array, state: Array) -> tuple[Array, Array, Array, float, float]:
    """Stress, DDSDDE, state, dissipation, PNEWDT of a peer; dt = 0.1 s."""
    props = [entry["default"] for entry in umat.manifest["props"]]
    if name == "tensortrax":
        done = library(name, umat).increment(start, end, 0.1, np.array(props), state)
        return done["stress"], done["ddsdde"], done["statev"], done["scd"], done["pnewdt"]
    made = (umat.library if name == "default" else library(name, umat)).call(start, end, 0.1, props, state)
    return made.stress, made.ddsdde, made.statev, made.scd, made.pnewdt


def distance(have: Array, want: Array) -> float:
    """Largest difference over the largest entry."""
    return float(np.max(np.abs(np.asarray(have) - want)) / np.max(np.abs(want)))


@pytest.mark.parametrize("locked", [False, True])
@pytest.mark.parametrize("name", [*PEERS, "tensortrax"])
def test_stress_tangent_and_state_are_those_of_the_default_scene(name: str, locked: bool, umat: Umat) -> None:
    state = np.zeros(8)
    state[4], state[6], state[7] = float(locked), -1e-3, 0.25
    tolerance = PERTURBED if name == "perturbed" else TANGENT
    for start, end in states(locked):
        want, have = call("default", umat, start, end, state), call(name, umat, start, end, state)
        assert distance(have[0], want[0]) < STRESS
        assert distance(have[1], want[1]) < tolerance
        assert distance(have[2], want[2]) < 1e-9  # the pressure: kappa times the rounding of J - 1
        assert have[3] == pytest.approx(want[3], rel=1e-8)
        assert distance(have[0] * (1 + 2 * STRESS), want[0]) > STRESS
        assert distance(have[1] * (1 + 2 * tolerance), want[1]) > tolerance


@pytest.mark.parametrize("name", ["four_index", "tensortrax"])
def test_at_vanishing_rate_the_tangent_looks_back_as_the_default_one(name: str, umat: Umat) -> None:
    state = np.zeros(8)
    state[6] = -1e-3
    start = np.diag([1.0, 1.01, 0.99])
    want, have = (call(n, umat, start, start, state)[1] for n in ("default", name))
    assert distance(have, want) < TANGENT
    assert have[5, 5] == pytest.approx(want[5, 5], rel=TANGENT)  # viscous only, where the penalty hides nothing
    state[6] = -2e-3
    assert call(name, umat, start, start, state)[1][5, 5] != pytest.approx(want[5, 5], rel=0.1)


@pytest.mark.parametrize("name", [*PEERS, "tensortrax"])
def test_an_increment_over_the_lock_is_asked_to_land_on_it(name: str, umat: Umat) -> None:
    start, end = np.diag([1.0, 1.01, 0.99]), np.diag([1.0, 1.12, 0.89])
    want, have = (call(n, umat, start, end, np.zeros(8))[4] for n in ("default", name))
    assert 0.0 < want < 1.0
    assert have == pytest.approx(want, rel=1e-10)
    inside = np.diag([1.0, 1.02, 0.98])
    assert call(name, umat, start, inside, np.zeros(8))[4] >= 1.0


def programme(target: Any, umat: Umat) -> History:
    """The compaction programme of one case in coarse increments."""
    props = props_vector(property_values(CASE, umat.manifest), umat.manifest)
    return drive(target, props, 8, driver_steps(CASE.load_programme), case_controls(0.3))


@pytest.mark.parametrize("name", ["four_index", "tensortrax"])
def test_an_exact_peer_takes_the_default_scenes_increments_and_iterations(name: str, umat: Umat) -> None:
    want, have = programme(umat.library, umat), programme(library(name, umat), umat)
    assert have.completed
    assert (have.increments, have.total_iterations) == (want.increments, want.total_iterations)
    ends = [run.deformation_gradient[-1, 2, 2] for run in (have, want)]
    assert ends[0] == pytest.approx(ends[1], rel=1e-9)


def test_the_perturbed_tangent_needs_more_iterations_for_the_same_answer(umat: Umat) -> None:
    want, have = programme(umat.library, umat), programme(library("perturbed", umat), umat)
    assert have.completed and have.total_iterations > want.total_iterations
    assert have.deformation_gradient[-1, 2, 2] == pytest.approx(want.deformation_gradient[-1, 2, 2], rel=1e-4)


@pytest.mark.parametrize("name", PEERS)
def test_a_state_beyond_the_range_asks_for_a_smaller_increment(name: str, umat: Umat) -> None:
    assert call(name, umat, np.eye(3), -np.eye(3), np.zeros(8))[4] == 0.25
    with pytest.raises(ArithmeticError):
        call("tensortrax", umat, np.eye(3), -np.eye(3), np.zeros(8))
