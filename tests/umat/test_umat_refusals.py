"""What the UMAT refuses: a bad end asks for a smaller increment, a bad start or input ends the analysis."""

from typing import Any

import numpy as np
import pytest

from oracle import PROPERTY_NAMES, properties_of
from oracle.compare import Array, statev_at_start
from plyflow.umat.library import CallResult, UmatLibrary
from umat.planted import compiled, emit

IDENTITY = np.eye(3)
PROPS = properties_of()
STRESS_BEFORE = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
INVERTED = np.diag([1.0, 1.0, -1.0])
BAD_DEFORMATIONS = {
    "inverted": INVERTED,
    "singular": np.diag([1.0, 1.0, 0.0]),
    "zero": np.zeros((3, 3)),
    "rank one": np.ones((3, 3)),
    "NaN": np.where(IDENTITY, np.nan, 0.0),
    "one NaN off the diagonal": IDENTITY + np.array([[0, np.nan, 0], [0, 0, 0], [0, 0, 0]]),
    "infinite": np.diag([1.0, 1.0, np.inf]),
}
each_bad = pytest.mark.parametrize("bad", BAD_DEFORMATIONS.values(), ids=BAD_DEFORMATIONS.keys())
each_regime = pytest.mark.parametrize("locked", [False, True], ids=["squeeze", "bleed"])


def call(umat: UmatLibrary, start: Array, end: Array, locked: bool, dt: float = 1.0, **more: Any) -> CallResult:
    props = more.pop("props", PROPS)
    statev = more.pop("statev", statev_at_start(locked))
    return umat.call(start, end, dt, props, statev, STRESS_BEFORE, **more)


def beyond_limit(locked: bool) -> Array:
    """Compaction strain between the limit of the law and full collapse, with the width of the regime."""
    return np.diag([1.0, np.exp(0.06) if locked else 2.0, 0.5])


def assert_untouched(result: CallResult, locked: bool) -> None:
    assert np.array_equal(result.stress, STRESS_BEFORE)
    assert np.array_equal(result.statev, statev_at_start(locked))
    assert not result.ddsdde.any()
    assert (result.sse, result.scd) == (0.0, 0.0)


def assert_smaller_increment_wanted(result: CallResult, locked: bool) -> None:
    assert 0.0 < result.pnewdt <= 0.25
    assert not result.stopped
    assert result.messages.strip()
    assert_untouched(result, locked)


def assert_analysis_ended(result: CallResult, locked: bool) -> None:
    assert result.stopped
    assert result.messages.strip()
    assert_untouched(result, locked)


@each_bad
@each_regime
def test_a_bad_end_asks_for_a_smaller_increment(umat: UmatLibrary, bad: Array, locked: bool) -> None:
    assert_smaller_increment_wanted(call(umat, IDENTITY, bad, locked), locked)


@each_bad
@each_regime
def test_a_bad_start_ends_the_analysis(umat: UmatLibrary, bad: Array, locked: bool) -> None:
    result = call(umat, bad, IDENTITY, locked)
    assert_analysis_ended(result, locked)
    assert "start of the increment" in result.messages


@each_regime
def test_an_end_beyond_the_compaction_limit_asks_for_a_smaller_increment(umat: UmatLibrary, locked: bool) -> None:
    """The law returns a finite stress of the wrong branch there; the UMAT must not."""
    result = call(umat, IDENTITY, beyond_limit(locked), locked)
    assert_smaller_increment_wanted(result, locked)
    assert "limit" in result.messages


@each_regime
def test_a_start_beyond_the_compaction_limit_ends_the_analysis(umat: UmatLibrary, locked: bool) -> None:
    """No smaller increment can help."""
    assert_analysis_ended(call(umat, beyond_limit(locked), beyond_limit(locked), locked), locked)


@each_regime
def test_a_good_increment_says_nothing(umat: UmatLibrary, locked: bool) -> None:
    result = call(umat, IDENTITY, np.diag([1.0, 1.01, 0.99]), locked)
    assert not result.stopped and not result.messages
    assert not np.array_equal(result.stress, STRESS_BEFORE)


@pytest.mark.parametrize("dt", [-1.0, np.nan, np.inf])
def test_a_time_increment_that_is_none_ends_the_analysis(umat: UmatLibrary, dt: float) -> None:
    assert_analysis_ended(call(umat, IDENTITY, IDENTITY, False, dt=dt), False)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("w0", 0.0), ("h0", -0.5), ("l0_over_d", 0.0), ("k", -1.0), ("a", -1.0), ("a", 0.5),
        ("eps_lock", 0.0), ("eps_lock", 0.1), ("eps_lock", -0.99e-4), ("chi_ratio", 0.0), ("E_L", 0.0), ("E_T", -1.0), ("G_LT", 0.0),
        ("kappa", -1.0), ("strain_floor", -1.0), ("rate_floor", -1.0), ("b_squeeze", np.nan),
    ],
)  # fmt: skip
def test_a_constant_out_of_bounds_ends_the_analysis_and_is_named(umat: UmatLibrary, name: str, value: float) -> None:
    """The message gives the number of the constant or its name, and the value."""
    result = call(umat, IDENTITY, IDENTITY, False, props=properties_of(**{name: value}))
    assert_analysis_ended(result, False)
    if np.isfinite(value):
        assert name in result.messages
        assert f"{value:.6E}" in result.messages


def test_a_lock_of_ten_thousandths_is_taken(umat: UmatLibrary) -> None:
    assert not call(umat, IDENTITY, IDENTITY, False, props=properties_of(eps_lock=-1e-4)).messages


@pytest.mark.parametrize(("k", "chi_ratio", "refused"), [(0.8, 1.6, True), (1.2, 0.7, True), (0.8, 1.56, False)])
def test_a_compaction_limit_before_the_lock_ends_the_analysis(
    umat: UmatLibrary, k: float, chi_ratio: float, refused: bool
) -> None:
    result = call(umat, IDENTITY, IDENTITY, False, props=properties_of(k=k, chi_ratio=chi_ratio))
    if refused:
        assert_analysis_ended(result, False)
        assert "k**2 chi_ratio must be below 1" in result.messages
    else:
        assert not result.messages


@each_regime
def test_a_stress_that_is_not_finite_asks_for_a_smaller_increment(umat: UmatLibrary, locked: bool) -> None:
    props = properties_of(kappa=1e300, E_L=1e300)
    assert_smaller_increment_wanted(call(umat, IDENTITY, np.diag([1e4, 1e4, 0.99]), locked, props=props), locked)


@each_regime
def test_a_fault_that_writes_the_stress_is_seen(locked: bool) -> None:
    broken = compiled(emit(), ("IF (.NOT. gap > 0.0d0) THEN", "stress = 0.0d0\n        IF (.NOT. gap > 0.0d0) THEN"))
    with pytest.raises(AssertionError):
        assert_smaller_increment_wanted(call(broken, IDENTITY, beyond_limit(locked), locked), locked)


@pytest.mark.parametrize("ratios", [{"nu_LT": 0.8, "nu_TT": 0.3}, {"nu_TT": 1.0}, {"nu_TT": -1.0}])
def test_a_compliance_that_is_not_positive_definite_ends_the_analysis(
    umat: UmatLibrary, ratios: dict[str, float]
) -> None:
    result = call(umat, IDENTITY, IDENTITY, False, props=properties_of(E_L=1.0, E_T=1.0, **ratios))
    assert_analysis_ended(result, False)
    assert "positive definite" in result.messages


def test_plane_stress_ends_the_analysis(umat: UmatLibrary) -> None:
    before = STRESS_BEFORE[:3]
    result = umat.call(IDENTITY, IDENTITY, 1.0, PROPS, statev_at_start(False), before, ntens=3, ndi=2)
    assert result.stopped and "NTENS = 6" in result.messages
    assert np.array_equal(result.stress, before)


@pytest.mark.parametrize("change", [-1, 1])
def test_another_number_of_constants_ends_the_analysis(umat: UmatLibrary, change: int) -> None:
    props = np.resize(PROPS, len(PROPERTY_NAMES) + change)
    result = call(umat, IDENTITY, IDENTITY, False, props=props)
    assert result.stopped and "NPROPS" in result.messages


def test_too_few_state_variables_end_the_analysis(umat: UmatLibrary) -> None:
    result = umat.call(IDENTITY, IDENTITY, 1.0, PROPS, np.zeros(7), STRESS_BEFORE)
    assert result.stopped and "DEPVAR" in result.messages
