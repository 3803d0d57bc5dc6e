"""Which flow an increment takes, how it lands on the lock, and that the lock stays."""

import numpy as np
import pytest

from oracle import properties_of, stress
from oracle.algebra import voigt
from oracle.compare import Array, relative_error, statev_at_start
from plyflow.umat.library import NO_OPINION, CallResult, UmatLibrary

PROPS = properties_of(kappa=0.0)
LOCK = -0.0593
STEP = 0.5


def compacted(eps: float) -> Array:
    """Isochoric compaction along 3, fibres straight."""
    return np.diag([1.0, np.exp(-eps), np.exp(eps)])


def increment(umat: UmatLibrary, start: float, end: float, locked: bool = False) -> CallResult:
    return umat.call(compacted(start), compacted(end), STEP, PROPS, statev_at_start(locked))


def is_of(result: CallResult, start: float, end: float, locked: bool) -> bool:
    """Whether the stress is the oracle's in that regime."""
    exact = voigt(stress(compacted(start), compacted(end), STEP, PROPS, locked))
    return relative_error(result.stress, [float(component) for component in exact]) < 1e-12


def test_regimes_can_be_told_apart() -> None:
    exact = [stress(compacted(LOCK), compacted(LOCK - 0.01), STEP, PROPS, locked) for locked in (False, True)]
    assert relative_error(*([float(c) for c in voigt(s)] for s in exact)) > 1e-2


@pytest.mark.parametrize("end", [-0.01, LOCK + 1e-3, LOCK - 1e-3])
def test_an_increment_that_starts_above_the_lock_squeezes_to_its_end(umat: UmatLibrary, end: float) -> None:
    assert is_of(increment(umat, -0.005, end), -0.005, end, locked=False)


@pytest.mark.parametrize("start", [LOCK - 1e-3, LOCK - 1e-9, LOCK + 5e-6])
def test_an_increment_that_starts_at_the_lock_bleeds_even_without_history(
    umat: UmatLibrary, start: float
) -> None:
    result = increment(umat, start, LOCK - 0.01)
    assert is_of(result, start, LOCK - 0.01, locked=True)
    assert result.statev[4] == 1.0
    assert result.pnewdt == NO_OPINION


def test_an_increment_that_starts_just_above_the_tolerance_still_squeezes(umat: UmatLibrary) -> None:
    assert is_of(increment(umat, LOCK + 2e-5, LOCK - 1e-3), LOCK + 2e-5, LOCK - 1e-3, locked=False)


@pytest.mark.parametrize("end", [-0.03, -0.0, LOCK + 0.01])
def test_once_locked_stays_locked(umat: UmatLibrary, end: float) -> None:
    result = increment(umat, LOCK + 0.02, end, locked=True)
    assert is_of(result, LOCK + 0.02, end, locked=True)
    assert result.statev[4] == 1.0
    again = umat.call(compacted(end), compacted(end + 1e-3), STEP, PROPS, result.statev)
    assert is_of(again, end, end + 1e-3, locked=True)


@pytest.mark.parametrize("start", [0.0, -0.02, LOCK + 1e-4])
@pytest.mark.parametrize("overshoot", [5e-5, 1e-3, 0.05])
def test_an_increment_past_the_lock_asks_for_a_part_that_does_not_pass_it(
    umat: UmatLibrary, start: float, overshoot: float
) -> None:
    """The wish lies between the mean of chord and rate-based time and the chord itself, which lands a constant rate."""
    end = LOCK - overshoot
    chord = (start - LOCK) / (start - end)
    result = increment(umat, start, end)
    assert 0.0 < result.pnewdt <= chord * (1.0 + 1e-9)
    assert result.pnewdt >= np.sqrt(1e-3 * chord) * (1.0 - 1e-9) or result.pnewdt == pytest.approx(chord, rel=1e-6)
    landed = increment(umat, start, LOCK)
    assert landed.pnewdt == NO_OPINION
    assert landed.statev[4] == 1.0
    assert landed.statev[0] == pytest.approx(LOCK, abs=1e-5)


def test_an_increment_that_ends_above_the_lock_has_no_wish_and_no_lock(umat: UmatLibrary) -> None:
    result = increment(umat, -0.01, LOCK + 1e-4)
    assert result.pnewdt == NO_OPINION
    assert result.statev[4] == 0.0


def test_a_smaller_wish_of_someone_else_is_kept(umat: UmatLibrary) -> None:
    """PNEWDT only ever goes down, and in an increment that needs nothing it is left alone."""
    assert increment(umat, -0.01, -0.011).pnewdt == NO_OPINION
    assert increment(umat, 0.0, LOCK - 0.05).pnewdt < NO_OPINION


def test_the_stage_looks_at_the_transverse_stretches_alone(umat: UmatLibrary) -> None:
    """Fibre stretch, shear along the fibre and any rotation leave the compaction strain as it is."""
    shear = np.array([[1.1, 0.0, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 1.0]])
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    for start, locked in ((LOCK - 1e-3, 1.0), (LOCK + 1e-3, 0.0)):
        first = quarter @ shear @ compacted(start)
        result = umat.call(first, first, STEP, PROPS, statev_at_start(False))
        assert result.statev[4] == locked
        assert result.statev[0] == pytest.approx(start, rel=1e-12)
