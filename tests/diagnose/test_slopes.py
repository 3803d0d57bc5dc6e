"""Where the stress has two slopes DDSDDE is not called wrong for being one of them; elsewhere wrong stays wrong."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from plyflow.diagnose.case import programme
from plyflow.diagnose.check import diagnose
from plyflow.diagnose.mistakes import RIGHT, Point
from plyflow.diagnose.report import report_data
from plyflow.diagnose.slopes import certainly_wrong
from plyflow.umat.prepare import prepare_umat

Array = NDArray[np.float64]


def kinked(f: Array) -> Array:
    """Cauchy stress whose Kirchhoff stress in direction 11 has the slope 3 in extension, 1 in compression."""
    strain = float(np.log(f[0, 0]))
    return np.array([(3.0 if strain > 0.0 else 1.0) * strain, 0.0, 0.0, 0.0, 0.0, 0.0]) / np.linalg.det(f)


def point(slope: float) -> Point:
    right, given = np.zeros((6, 6)), np.zeros((6, 6))
    right[0, 0], given[0, 0] = 2.0, slope  # central differences take the mean
    return Point(np.eye(3), kinked(np.eye(3)), right, given)


@pytest.mark.parametrize(("slope", "wrong"), [(3.0, False), (1.0, False), (2.0, False), (3.01, True), (0.99, True)])
def test_between_the_slopes_of_a_kink_nothing_is_certain(slope: float, wrong: bool) -> None:
    assert certainly_wrong(point(slope), kinked, 1e-2, RIGHT) == wrong


def test_where_the_stress_is_smooth_a_wrong_component_is_certain() -> None:
    def smooth(f: Array) -> Array:
        return np.array([3.0 * np.log(f[0, 0]), 0.0, 0.0, 0.0, 0.0, 0.0]) / np.linalg.det(f)

    assert certainly_wrong(point(3.001), smooth, 1e-2, RIGHT)
    assert not certainly_wrong(point(3.0), smooth, 1e-2, RIGHT)


def test_a_stress_that_cannot_be_evaluated_leaves_everything_open() -> None:
    assert not certainly_wrong(point(100.0), lambda f: None, 1e-2, RIGHT)


def test_coincident_transverse_stretches_are_told_from_a_wrong_tangent() -> None:
    """The fibre pulled with free sides: the smallest transverse stretch has two directions, the stress two slopes."""
    umat = prepare_umat()
    changes = {"kappa": 100.0}
    props = [changes.get(row["name"], float(row["default"])) for row in umat.manifest["props"]]
    diagnosis = diagnose(umat.library, programme("uniaxial", props, 8))
    assert diagnosis.history.completed
    assert diagnosis.right
    assert diagnosis.undecided > 0
    assert report_data(diagnosis)["increments_undecided"] == diagnosis.undecided
    assert diagnose(umat.library, programme("general", props, 8)).undecided == 0
