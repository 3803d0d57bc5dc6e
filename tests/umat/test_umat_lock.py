"""The lock: which flow an increment takes, the width it leaves, what counts as compaction, and that the lock stays."""

import numpy as np
import pytest

from oracle import properties_of, stress
from oracle.algebra import voigt
from oracle.compare import Array, relative_error, statev_at_start
from plyflow.driver.drive import Controls, Step, drive
from plyflow.umat.library import NO_OPINION, CallResult, UmatLibrary
from umat.planted import compiled, emit
from umatgen.scene import Scene

PROPS = properties_of(kappa=0.0)
LOCK, STEP = -0.0593, 0.5
NOT_WIDENED = ("f0(1,2)*widening", "f0(1,2)"), ("f0(2,2)*widening", "f0(2,2)"), ("f0(3,2)*widening", "f0(3,2)")


def compacted(eps: float) -> Array:
    """Isochoric compaction along 3, fibres straight."""
    return np.diag([1.0, np.exp(-eps), np.exp(eps)])


def sheared(component: str) -> Array:
    """Simple shear of 0.3."""
    deformation = np.eye(3)
    deformation[int(component[0]) - 1, int(component[1]) - 1] = 0.3
    return deformation


def increment(umat: UmatLibrary, start: float, end: float, locked: bool = False) -> CallResult:
    return umat.call(compacted(start), compacted(end), STEP, PROPS, statev_at_start(locked))


def is_of(result: CallResult, start: float, end: float, locked: bool) -> bool:
    """Whether the stress is the oracle's for a start of that stage."""
    exact = voigt(stress(compacted(start), compacted(end), STEP, PROPS, locked))
    return relative_error(result.stress, exact) < 1e-12


@pytest.mark.parametrize("start", [0.0, -0.02, LOCK + 1e-3, LOCK - 1e-3, LOCK - 0.01])
@pytest.mark.parametrize("end", [0.01, -0.03, LOCK + 1e-9, LOCK - 1e-9, LOCK - 0.05])
def test_the_end_of_an_increment_decides_the_stage_and_asks_for_nothing(
    umat: UmatLibrary, start: float, end: float
) -> None:
    result = increment(umat, start, end)
    assert result.statev[4] == float(end < LOCK)
    assert is_of(result, start, end, locked=False)
    assert (result.pnewdt, result.messages) == (NO_OPINION, "")


def test_the_three_flows_can_be_told_apart(umat: UmatLibrary) -> None:
    """Squeezing, bleeding, and bleeding from the width at the lock in the increment that passes it."""
    start, end = LOCK + 0.02, LOCK - 0.01
    crossing, bleeding = (increment(umat, start, end, locked).stress for locked in (False, True))
    squeezing = increment(umat, start, LOCK + 1e-9).stress
    unwidened = increment(compiled(emit(), *NOT_WIDENED), start, end).stress
    assert min(relative_error(one, crossing) for one in (bleeding, squeezing, unwidened)) > 1e-2


@pytest.mark.parametrize("end", [-0.03, -0.0, LOCK + 0.01])
def test_once_locked_stays_locked(umat: UmatLibrary, end: float) -> None:
    result = increment(umat, LOCK + 0.02, end, locked=True)
    assert is_of(result, LOCK + 0.02, end, locked=True)
    assert result.statev[4] == 1.0
    again = umat.call(compacted(end), compacted(end + 1e-3), STEP, PROPS, result.statev)
    assert is_of(again, end, end + 1e-3, locked=True)
    broken = compiled(emit(), ("locked = statev(5) >= 0.5d0", "locked = .FALSE."))
    assert increment(broken, LOCK + 0.02, end, locked=True).statev[4] == 0.0


@pytest.mark.parametrize("component", ["12", "21", "13", "23"])
def test_simple_shear_of_the_ply_compacts_nothing(umat: UmatLibrary, component: str) -> None:
    """Along the fibre and across it, in the ply and between plies; a scene of the smallest stretch sees some."""
    found = umat.call(np.eye(3), sheared(component), STEP, PROPS, statev_at_start(False)).statev
    assert abs(found[0]) <= 1e-15
    assert found[4] == 0.0


def test_the_smallest_transverse_stretch_counts_a_transverse_shear_as_compaction() -> None:
    """The measure above is one that tells: by the smallest stretch the same shear passes the lock."""
    smallest = compiled(emit(Scene(name="smallest", compaction="smallest", integrator="bdf1")))
    found = smallest.call(np.eye(3), sheared("23"), STEP, PROPS, statev_at_start(False)).statev
    assert found[0] < -0.1
    assert found[4] == 1.0


@pytest.mark.parametrize("stretches", [(1.0, 0.7, 1 / 0.7), (0.95, 0.8, 1.0), (1.0, 0.7, 1.0)])
def test_compression_in_the_plane_locks_nothing(umat: UmatLibrary, stretches: tuple[float, ...]) -> None:
    found = umat.call(np.eye(3), np.diag(stretches), STEP, PROPS, statev_at_start(False)).statev
    assert found[0] == pytest.approx(np.log(stretches[2]), abs=1e-15)
    assert found[4] == 0.0


def test_fibre_stretch_shear_along_the_fibre_and_rotation_leave_the_strain_as_it_is(umat: UmatLibrary) -> None:
    shear = np.array([[1.1, 0.0, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 1.0]])
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    for start, locked in ((LOCK - 1e-3, 1.0), (LOCK + 1e-3, 0.0)):
        first = quarter @ shear @ compacted(start)
        result = umat.call(first, first, STEP, PROPS, statev_at_start(False))
        assert result.statev[4] == locked
        assert result.statev[0] == pytest.approx(start, rel=1e-12)


def width_beside_the_lock(umat: UmatLibrary, size: float, state_variables: int = 8) -> float:
    """Final width over exp(-eps_lock), less one: free edge, 1 s to 0.2 MPa past the lock, 20 s there."""
    targets = {"11": 1.0, "22": 0.0, "33": 0.2, "12": 0.0, "13": 0.0, "23": 0.0}
    steps = [Step(duration, targets, {"22": "S", "33": "P"}) for duration in (1.0, 20.0)]
    history = drive(umat, properties_of(kappa=1e5), state_variables, steps, Controls(size, size * 1e-3, size))
    assert history.completed, history.message
    assert history.statev[-1, 4] == 1.0
    return float(abs(history.statev[-1, 1] * np.exp(LOCK) - 1.0))


@pytest.mark.parametrize("size", [1e-3, 1e-2, 0.1, 1.0])
@pytest.mark.parametrize(("scene", "state_variables"), [("bdf1", 8), ("default", 10)])
def test_a_free_edge_has_the_width_of_the_lock_whatever_the_increments(
    scene: str, state_variables: int, size: float
) -> None:
    assert width_beside_the_lock(compiled(emit(scene)), size, state_variables) < 1e-4


def test_without_the_push_the_width_depends_on_the_increments() -> None:
    assert width_beside_the_lock(compiled(emit(), *NOT_WIDENED), 1.0) > 1e-3
