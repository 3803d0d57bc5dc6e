"""Where the stress has two slopes DDSDDE is not called wrong for being one of them; elsewhere wrong stays wrong."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from plyflow.diagnose.case import programme
from plyflow.diagnose.check import diagnose
from plyflow.diagnose.library import load_umat
from plyflow.diagnose.mistakes import RIGHT, Point
from plyflow.diagnose.report import report_data
from plyflow.diagnose.slopes import certainly_wrong

Array = NDArray[np.float64]
SOURCE = Path(__file__).parent / "umats" / "neo_hooke.f"


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


def test_a_kink_along_the_path_is_told_from_a_wrong_tangent(tmp_path: Path) -> None:
    """A stress with |b22 - b33| in it, DDSDDE the slope to one side: two slopes while the stretches coincide, one after."""
    text, kink = SOURCE.read_text(), "      S(1,1) = S(1,1) + ABS(B(2,2) - B(3,3))/AJ\n"
    slope = "      C(1,2) = C(1,2) + 2.D0*B(2,2)/AJ\n      C(1,3) = C(1,3) - 2.D0*B(3,3)/AJ\n"
    for before, added in (("      DO M = 1, 6\n        T(M)", kink), ("      IF (MISTAKE.EQ.1 ", slope)):
        text = text.replace(before, added + before, 1)
    (tmp_path / "kinked.f").write_text(text)
    library, case = load_umat(tmp_path / "kinked.f"), programme("volumetric", [1.3, 4.1, 0], 0)
    further = [*case.lines, "begin step", "duration = 1.0", "F22 = 1.2", "end step"]
    diagnosis = diagnose(library, replace(case, lines=further))
    assert diagnosis.history.completed
    assert diagnosis.right
    assert (diagnosis.undecided, len(diagnosis.points)) == (10, 10)
    assert report_data(diagnosis)["increments_undecided"] == 10
