"""Rigid rotation: the Cauchy stress turns with the body, whether the call is global or co-rotated."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

from plyflow.driver.drive import COMPONENTS, Controls, Step, UmatAddress, drive

Umat = Callable[[str], UmatAddress]
MU, LAMBDA = 1.3, 4.1
STRETCH = np.array([[1.3, 0.2, 0.0], [0.2, 0.9, 0.1], [0.0, 0.1, 1.1]])


def rotation(angle: float, axis: tuple[float, float, float] = (1.0, 2.0, 2.0)) -> npt.NDArray[np.float64]:
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    spin = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * spin + (1 - np.cos(angle)) * spin @ spin)


def to_gradient(gradient: npt.NDArray[np.float64], *, instant: bool = True) -> Step:
    targets = {name: float(gradient[int(name[0]) - 1, int(name[1]) - 1]) for name in COMPONENTS}
    return Step(1.0, targets, instant=instant)


def matrix(voigt: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    s11, s22, s33, s12, s13, s23 = voigt
    return np.array([[s11, s12, s13], [s12, s22, s23], [s13, s23, s33]])


@pytest.mark.parametrize("corotated", [False, True])
@pytest.mark.parametrize("name", ["neo_hooke", "hypoelastic"])
def test_stress_turns_with_the_body_through_180_degrees(umat: Umat, name: str, corotated: bool) -> None:
    angles = np.linspace(0.0, np.pi, 13)[1:]
    steps = [to_gradient(STRETCH)] + [to_gradient(rotation(angle) @ STRETCH) for angle in angles]
    once = Controls(1.0, 1.0, 1.0)
    history = drive(umat(name), [MU, LAMBDA], 6, steps, once, corotated=corotated)
    stretched = matrix(history.stress[1])
    assert np.abs(stretched).max() > 0.3
    for angle, stress in zip(angles, history.stress[2:], strict=True):
        turned = rotation(angle) @ stretched @ rotation(angle).T
        # Rounding of twelve increments, each a few ulps of the stress.
        assert np.abs(matrix(stress) - turned).max() < 1e-13 * 12


@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (1.0, 2.0, 2.0)])
def test_a_half_turn_in_one_increment(umat: Umat, axis: tuple[float, float, float]) -> None:
    """There is no middle configuration: the driver takes the polar decomposition of the increment."""
    steps = [to_gradient(STRETCH), to_gradient(rotation(np.pi, axis) @ STRETCH)]
    history = drive(umat("hypoelastic"), [MU, LAMBDA], 6, steps, Controls(1.0, 1.0, 1.0))
    turned = rotation(np.pi, axis) @ matrix(history.stress[1]) @ rotation(np.pi, axis).T
    assert matrix(history.stress[2]) == pytest.approx(turned, abs=1e-13)


def test_global_and_corotated_calls_agree_under_mixed_control(umat: Umat) -> None:
    """Shear by stress with free normal components: a non-symmetric F, solved in both forms of the call."""
    targets = {"12": 0.9, "13": 0.4, "11": 0.2, "22": 0.0, "33": -0.3, "21": 0.25, "32": -0.4}
    step = Step(1.0, targets, {name: "S" for name in targets if name not in ("21", "32")})
    tight = Controls(residual_tolerance=1e-12)
    plain, turning = (
        drive(umat("neo_hooke"), [MU, LAMBDA], 1, [step], tight, corotated=flag) for flag in (False, True)
    )
    assert plain.completed
    assert turning.completed
    assert turning.deformation_gradient[-1] == pytest.approx(plain.deformation_gradient[-1], abs=1e-11)
    assert turning.total_iterations == plain.total_iterations
    assert plain.iterations.max() <= 5


def test_rotation_with_a_free_component_keeps_the_lateral_stretch(umat: Umat) -> None:
    """Rotate about axis 3 by 180 degrees in 18 steps while F33 is found from zero stress."""
    planar = np.diag([1.3, 0.9, 1.0])
    steps = []
    for angle in np.linspace(0.0, np.pi, 19):
        turned = rotation(angle, (0.0, 0.0, 1.0)) @ planar
        targets = {name: float(turned[int(name[0]) - 1, int(name[1]) - 1]) for name in ("11", "22", "12", "21")}
        steps.append(Step(1.0, {**targets, "33": 0.0}, {"33": "S"}, instant=True))
    controls = Controls(1.0, 1.0, 1.0, residual_tolerance=1e-12)
    history = drive(umat("neo_hooke"), [MU, LAMBDA], 1, steps, controls)
    assert history.completed, history.message
    assert history.deformation_gradient[2:, 2, 2] == pytest.approx(history.deformation_gradient[1, 2, 2], abs=1e-11)
    assert history.stress[-1] == pytest.approx(history.stress[1], abs=1e-11)
