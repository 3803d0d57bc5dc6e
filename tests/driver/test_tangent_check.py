"""The comparison of DDSDDE with differences along the path."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from plyflow.driver.drive import Controls, Step, UmatAddress, drive

Umat = Callable[[str], UmatAddress]
MIXED = Step(1.0, {"11": 1.4, "12": 0.5, "22": 0.0, "33": 0.0}, {"22": "S", "33": "S"})
CHECK = Controls(0.1, 0.1, 0.1, tangent_check=1)


def test_right_tangent_agrees(umat: Umat) -> None:
    check = drive(umat("neo_hooke"), [1.3, 4.1], 1, [MIXED], CHECK).tangent_check
    assert check is not None
    # Central differences at a strain step of 1e-6 to 1e-4: rounding over step.
    assert check.difference < 1e-8


@pytest.mark.parametrize("error", [1e-3, 0.1])
def test_planted_error_is_found_where_it_is(umat: Umat, error: float) -> None:
    check = drive(umat("neo_hooke"), [1.3, 4.1, 1 + error], 1, [MIXED], CHECK).tangent_check
    assert check is not None
    row, column = check.entry
    assert row >= 3
    assert column >= 3
    shear_stiffness = check.numerical[row, column]
    expected = error * shear_stiffness / check.numerical.max()
    assert check.difference == pytest.approx(expected, rel=1e-4)
    assert check.ddsdde[row, column] == pytest.approx((1 + error) * shear_stiffness, rel=1e-6)


def test_nearly_rate_independent_tangent_agrees(umat: Umat) -> None:
    """Stress of power 0.05: increments too small for differences are not judged, the others agree."""
    load = Step(1.0, {"22": 0.0, "33": 0.9}, {"22": "S", "33": "P"})
    history = drive(umat("power_law"), [1.0, 0.05, 1.0, 1e-12, 1e-12], 0, [load], CHECK)
    assert history.completed, history.message
    assert history.tangent_check is not None
    assert np.abs(np.diff(history.strain[:, 2])).min() < 1e-12
    # Differences count if they agree with each other to 1e-3.
    assert history.tangent_check.difference < 1e-3


def test_without_the_option_there_is_no_check(umat: Umat) -> None:
    assert drive(umat("neo_hooke"), [1.3, 4.1], 1, [MIXED]).tangent_check is None


def test_check_does_not_change_the_path(umat: Umat) -> None:
    checked = drive(umat("neo_hooke"), [1.3, 4.1], 1, [MIXED], CHECK)
    plain = drive(umat("neo_hooke"), [1.3, 4.1], 1, [MIXED], Controls(0.1, 0.1, 0.1))
    assert (checked.stress == plain.stress).all()
    assert (checked.statev == plain.statev).all()
    assert checked.umat_calls > plain.umat_calls
