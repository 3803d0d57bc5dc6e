"""The peers are the same material as the scene with the paper's backward difference, by other ways."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from plyflow.case.case import Case, driver_steps, property_values, props_vector
from plyflow.driver.drive import History, drive
from plyflow.evidence.bench.peers.differentiated import DifferentiatedUmat
from plyflow.evidence.bench.peers.fortran import PEERS, TWIN, peer_library
from plyflow.run.case_run import case_controls
from plyflow.umat.library import CallResult, UmatLibrary
from plyflow.umat.prepare import Umat, prepare_umat

Array = NDArray[np.float64]
CASE = Case("IM7-8552", 70, "BP", 15)
# The rounding of J - 1 under the penalty (kappa = 1e5 MPa) for stresses; the step of the differences (1e-8) over the strain
# increment (1e-3) for the perturbed tangent.
STRESS, TANGENT, PERTURBED = 1e-11, 1e-12, 1e-4
ALL = pytest.mark.parametrize("name", [*PEERS, "tensortrax"])
EXACT = pytest.mark.parametrize("name", ["four_index", "tensortrax"])


@pytest.fixture(scope="module")
def umat() -> Umat:
    return prepare_umat(TWIN)


def states(locked: bool) -> list[tuple[Array, Array]]:
    """Pairs F0, F1 in the stage, with shears."""
    generator = np.random.default_rng(3)
    base = np.diag([1.001, 1.08, 0.90] if locked else [1.001, 1.02, 0.98])
    starts = [base + 0.003 * generator.normal(size=(3, 3)) for _ in range(6)]
    return [(start, start + 0.001 * generator.normal(size=(3, 3))) for start in starts]


def library(name: str, umat: Umat) -> UmatLibrary:
    """A peer by name, or the scene."""
    if name in PEERS:
        return peer_library(name)
    return DifferentiatedUmat(umat.manifest) if name == "tensortrax" else umat.library


def call(name: str, umat: Umat, start: Array, end: Array, state: Array) -> CallResult:
    """One call; dt = 0.1 s."""
    return library(name, umat).call(start, end, 0.1, [entry["default"] for entry in umat.manifest["props"]], state)


def distance(have: Array, want: Array) -> float:
    """Largest difference over the largest entry."""
    return float(np.max(np.abs(have - want)) / np.max(np.abs(want)))


def state_of(locked: bool = False, rate: float = 0.0) -> Array:
    """State variables with a last rate [1/s] and a dissipation behind them."""
    return np.array([0, 0, 0, 0, float(locked), 0, rate, 0.25])


@pytest.mark.parametrize("locked", [False, True])
@ALL
def test_stress_tangent_and_state_are_those_of_the_scene(name: str, locked: bool, umat: Umat) -> None:
    tolerance = PERTURBED if name == "perturbed" else TANGENT
    for start, end in states(locked):
        want, have = (call(n, umat, start, end, state_of(locked, -1e-3)) for n in ("scene", name))
        assert distance(have.stress, want.stress) < STRESS
        assert distance(have.ddsdde, want.ddsdde) < tolerance
        assert distance(have.statev, want.statev) < 1e-9  # the pressure: kappa times the rounding of J - 1
        assert have.scd == pytest.approx(want.scd, rel=1e-8)
        assert distance(have.stress * (1 + 2 * STRESS), want.stress) > STRESS
        assert distance(have.ddsdde * (1 + 2 * tolerance), want.ddsdde) > tolerance


@EXACT
def test_at_vanishing_rate_the_tangent_looks_back_as_the_scene(name: str, umat: Umat) -> None:
    start = np.diag([1.0, 1.01, 0.99])
    want, have = (call(n, umat, start, start, state_of(rate=-1e-3)).ddsdde for n in ("scene", name))
    assert distance(have, want) < TANGENT
    assert have[5, 5] == pytest.approx(want[5, 5], rel=TANGENT)  # viscous only, where the penalty hides nothing
    assert call(name, umat, start, start, state_of(rate=-2e-3)).ddsdde[5, 5] != pytest.approx(want[5, 5], rel=0.1)


@ALL
def test_an_increment_over_the_lock_counts_its_rate_from_the_width_there(name: str, umat: Umat) -> None:
    start, end = np.diag([1.0, 1.01, 0.99]), np.diag([1.0, 1.16, 0.84])
    want, have = (call(n, umat, start, end, np.zeros(8)) for n in ("scene", name))
    assert distance(have.stress, want.stress) < STRESS and have.statev[4] == want.statev[4] == 1.0
    assert distance(have.ddsdde, want.ddsdde) < (PERTURBED if name == "perturbed" else TANGENT)
    locked_before = call(name, umat, start, end, state_of(locked=True))
    assert distance(locked_before.stress, want.stress) > 1e-3


def programme(name: str, umat: Umat) -> tuple[History, float]:
    """The compaction programme of one case in coarse increments, and its final thickness ratio."""
    props = props_vector(property_values(CASE, umat.manifest), umat.manifest)
    run = drive(library(name, umat), props, 8, driver_steps(CASE.load_programme), case_controls(0.3))
    assert run.completed
    return run, float(run.deformation_gradient[-1, 2, 2])


@EXACT
def test_an_exact_peer_takes_the_scenes_increments_and_iterations(name: str, umat: Umat) -> None:
    (want, end), (have, its_end) = programme("scene", umat), programme(name, umat)
    assert (have.increments, have.total_iterations) == (want.increments, want.total_iterations)
    assert its_end == pytest.approx(end, rel=1e-9)


def test_the_perturbed_tangent_needs_more_iterations_for_the_same_answer(umat: Umat) -> None:
    (want, end), (have, its_end) = programme("scene", umat), programme("perturbed", umat)
    assert have.total_iterations > want.total_iterations
    assert its_end == pytest.approx(end, rel=1e-4)


@ALL
def test_a_state_beyond_the_range_asks_for_a_smaller_increment(name: str, umat: Umat) -> None:
    beyond = call(name, umat, np.eye(3), -np.eye(3), np.zeros(8))
    assert beyond.pnewdt == 0.25 and not beyond.stress.any()
