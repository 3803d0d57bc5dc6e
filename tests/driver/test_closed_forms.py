"""Stress, stretch and work of neo-Hooke and rate-form elasticity in closed form; rigid rotation; the exact multiplier."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
from scipy.optimize import brentq

from plyflow.driver.drive import COMPONENTS, Controls, DriverError, Kind, Step, UmatAddress, drive

Umat = Callable[[str], UmatAddress]
MU, LAMBDA = 1.3, 4.1
FREE_SIDES: dict[str, Kind] = {"22": "S", "33": "S"}
# Tolerance of the stress residual; the results below follow it by the stiffness, hence a factor of 10.
TIGHT = 1e-11
STRETCH = np.array([[1.3, 0.2, 0.0], [0.2, 0.9, 0.1], [0.0, 0.1, 1.1]])


def uniaxial_neo_hooke(stretch: float) -> tuple[float, float]:
    """Lateral stretch and axial stress: mu (l_t^2 - 1) + lambda ln(l l_t^2) = 0."""

    def lateral_stress(lateral: float) -> float:
        return float(MU * (lateral**2 - 1) + LAMBDA * np.log(stretch * lateral**2))

    lateral = brentq(lateral_stress, 0.2, 2.0, xtol=1e-15, rtol=1e-14)
    jacobian = stretch * lateral**2
    return lateral, (MU * (stretch**2 - 1) + LAMBDA * np.log(jacobian)) / jacobian


@pytest.mark.parametrize("stretch", [0.4, 0.95, 1.7, 3.0])
def test_uniaxial_stress_with_free_sides(umat: Umat, stretch: float) -> None:
    step = Step(1.0, {"11": stretch, "22": 0.0, "33": 0.0}, FREE_SIDES)
    history = drive(umat("neo_hooke"), [MU, LAMBDA], 1, [step], Controls(residual_tolerance=TIGHT))
    lateral, axial = uniaxial_neo_hooke(stretch)
    assert history.completed, history.message
    assert history.deformation_gradient[-1, 1, 1] == pytest.approx(lateral, rel=10 * TIGHT)
    assert history.deformation_gradient[-1, 2, 2] == pytest.approx(lateral, rel=10 * TIGHT)
    assert history.stress[-1, 0] == pytest.approx(axial, rel=10 * TIGHT)


def test_prescribed_stress_gives_the_stretch_back(umat: Umat) -> None:
    lateral, axial = uniaxial_neo_hooke(1.7)
    step = Step(1.0, {"11": axial, "22": 0.0, "33": 0.0}, {"11": "S", **FREE_SIDES})
    history = drive(umat("neo_hooke"), [MU, LAMBDA], 1, [step], Controls(residual_tolerance=TIGHT))
    assert history.deformation_gradient[-1].diagonal() == pytest.approx([1.7, lateral, lateral], rel=20 * TIGHT)


def test_plate_pressure_is_minus_the_stress(umat: Umat) -> None:
    pressure = drive(umat("neo_hooke"), [MU, LAMBDA], 1, [Step(1.0, {"33": 0.8}, {"33": "P"})])
    stress = drive(umat("neo_hooke"), [MU, LAMBDA], 1, [Step(1.0, {"33": -0.8}, {"33": "S"})])
    assert pressure.deformation_gradient[-1, 2, 2] < 1.0
    assert np.array_equal(pressure.deformation_gradient, stress.deformation_gradient)


@pytest.mark.parametrize("component", ["12", "13", "23"])
def test_simple_shear(umat: Umat, component: str) -> None:
    shear = 0.9
    history = drive(umat("neo_hooke"), [MU, LAMBDA], 1, [Step(1.0, {component: shear})])
    expected = np.zeros(6)
    expected[{"12": 3, "13": 4, "23": 5}[component]] = MU * shear
    expected[int(component[0]) - 1] = MU * shear**2
    assert history.stress[-1] == pytest.approx(expected, abs=1e-14)
    assert history.umat_calls == history.increments


def test_pure_shear_stress(umat: Umat) -> None:
    """J sigma = mu (b - I) + lambda ln J I with sigma = t e12 gives det b = c (c^2 - (J t / mu)^2) = J^2."""
    shear = 0.7
    targets = {"12": shear, "11": 0.0, "22": 0.0, "33": 0.0}
    step = Step(1.0, targets, dict.fromkeys(targets, "S"))
    history = drive(umat("neo_hooke"), [MU, LAMBDA], 1, [step], Controls(residual_tolerance=TIGHT))

    def determinant_error(jacobian: float) -> float:
        c = 1 - LAMBDA * np.log(jacobian) / MU
        return float(c * (c**2 - (jacobian * shear / MU) ** 2) - jacobian**2)

    jacobian = brentq(determinant_error, 0.9, 1.0, xtol=1e-15, rtol=1e-14)
    c = 1 - LAMBDA * np.log(jacobian) / MU
    finger = np.array([[c, jacobian * shear / MU, 0], [jacobian * shear / MU, c, 0], [0, 0, c]])
    deformation = history.deformation_gradient[-1]
    assert deformation @ deformation.T == pytest.approx(finger, rel=100 * TIGHT, abs=100 * TIGHT)
    assert deformation[1, 0] == 0.0


def test_unloading_returns_to_the_start(umat: Umat) -> None:
    kinds: dict[str, Kind] = {"11": "S", "12": "S", **FREE_SIDES}
    load = Step(1.0, {"11": 2.0, "12": 0.5, "22": 0.0, "33": 0.0}, kinds)
    unload = Step(1.0, {"11": 0.0, "12": 0.0, "22": 0.0, "33": 0.0}, kinds)
    history = drive(umat("neo_hooke"), [MU, LAMBDA], 1, [load, unload], Controls(residual_tolerance=TIGHT))
    assert history.completed, history.message
    assert np.abs(history.deformation_gradient[-1] - np.eye(3)).max() < 10 * TIGHT
    assert history.work[-1] == pytest.approx(0.0, abs=1e-2 * history.work.max())


def test_trapezoidal_work_is_the_stored_energy_to_second_order(umat: Umat) -> None:
    errors = []
    for size in (0.05, 0.025, 0.0125):
        fixed = Controls(size, size, size, residual_tolerance=TIGHT)
        step = Step(1.0, {"11": 1.8, "12": 0.6, "22": 0.0}, {"22": "S"})
        history = drive(umat("neo_hooke"), [MU, LAMBDA], 1, [step], fixed)
        errors.append(abs(history.work[-1] / history.energies[-1, 0] - 1))
        right_error = abs(history.work_right[-1] / history.energies[-1, 0] - 1)
        assert right_error > 10 * errors[-1]
    # A second-order error falls by 4; 3.8 allows for the terms beyond.
    assert errors[0] / errors[1] > 3.8
    assert errors[1] / errors[2] > 3.8


def test_strain_increments_add_up_to_the_logarithm(umat: Umat) -> None:
    """Hughes and Winget's midpoint strain is second-order: the sum tends to ln(stretch) by a factor 4."""
    errors = []
    for size in (0.02, 0.01):
        step = Step(1.0, {"33": 1.5})
        history = drive(umat("hypoelastic"), [1.0, 2.0], 6, [step], Controls(size, size, size))
        assert history.strain[-1] == pytest.approx(history.statev[-1], abs=1e-15)
        errors.append(abs(history.strain[-1, 2] - np.log(1.5)))
    assert errors[0] < 1e-4
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.01)


@pytest.mark.parametrize("name", ["neo_hooke", "hypoelastic"])
def test_four_components_agree_with_six_in_plane_strain(umat: Umat, name: str) -> None:
    step = Step(1.0, {"11": 1.2, "22": 0.0, "12": 0.3}, {"22": "S"})
    six, four = (drive(umat(name), [MU, LAMBDA], 6, [step], ntens=ntens) for ntens in (6, 4))
    assert four.completed, four.message
    assert four.deformation_gradient == pytest.approx(six.deformation_gradient, rel=1e-13, abs=1e-13)
    assert four.stress == pytest.approx(six.stress, rel=1e-13, abs=1e-13)


def test_held_and_ramped_components_follow_the_programme(umat: Umat) -> None:
    """A ramp starts at the last command, or at the actual value where the kind of control has changed."""
    steps = [
        Step(1.0, {"11": 1.4, "22": 0.0}, {"22": "S"}),
        Step(2.0, {"22": -0.5}, {"22": "S"}),
        Step(1.0, {"22": 1.0}),
    ]
    fixed = Controls(0.5, 0.5, 0.5, residual_tolerance=TIGHT)
    history = drive(umat("neo_hooke"), [MU, LAMBDA], 1, steps, fixed)
    assert history.time == pytest.approx([0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0], abs=0)
    assert history.deformation_gradient[:, 0, 0] == pytest.approx([1.0, 1.2] + [1.4] * 7, rel=1e-15)
    assert history.stress[3:7, 1] == pytest.approx([-0.125, -0.25, -0.375, -0.5], rel=1e-9)
    half_way = 0.5 * (history.deformation_gradient[6, 1, 1] + 1.0)
    assert history.deformation_gradient[7:, 1, 1] == pytest.approx([half_way, 1.0], rel=1e-15)


def test_instant_load_holds_from_the_first_increment(umat: Umat) -> None:
    step = Step(1.0, {"33": 0.8}, {"33": "P"}, instant=True)
    history = drive(umat("neo_hooke"), [MU, LAMBDA], 1, [step], Controls(0.25, 0.25, 0.25))
    assert history.stress[1:, 2] == pytest.approx([-0.8] * 4, rel=1e-5)


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


@pytest.mark.parametrize("stretch", [0.5, 1.8])
def test_uniaxial_neo_hooke_keeps_its_volume(umat: Umat, stretch: float) -> None:
    """With J = 1: s11 = mu (l^2 - 1/l), the other stretches 1/sqrt(l)."""
    step = Step(1.0, {"11": stretch, "22": 0.0, "33": 0.0}, {"22": "S", "33": "S"})
    controls = Controls(incompressible=True, residual_tolerance=1e-11)
    history = drive(umat("neo_hooke"), [MU, 0.0], 1, [step], controls)
    assert history.completed, history.message
    assert np.abs(np.linalg.det(history.deformation_gradient) - 1).max() < 1e-12
    assert history.stress[-1, 0] == pytest.approx(MU * (stretch**2 - 1 / stretch), rel=1e-10)
    assert history.deformation_gradient[-1, 1, 1] == pytest.approx(stretch**-0.5, rel=1e-10)
    # The multiplier carries what the UMAT's own stress lacks on the free sides.
    assert history.pressure[-1] == pytest.approx(-MU * (1 / stretch - 1), rel=1e-10)


def test_power_law_creep_between_plates_converges_from_rest(umat: Umat) -> None:
    """Plane strain compaction with a free edge: s33 - s22 = K r^(n-1) (D33 - D22), r^2 = 2/3 2 D33^2."""
    step = Step(1.0, {"22": 0.0, "33": 0.8}, {"22": "S", "33": "P"}, instant=True)
    controls = Controls(0.1, 0.1, 0.1, incompressible=True)
    history = drive(umat("power_law"), [1.0, 0.05, 0.0, 1e-12, 1e-12], 0, [step], controls)
    assert history.completed, history.message
    assert history.cutbacks == 0
    assert history.iterations.max() <= 5
    assert np.abs(np.linalg.det(history.deformation_gradient) - 1).max() < 1e-12
    unit = np.sqrt(4 / 3) ** (0.05 - 1) * 2
    rate = (0.8 / unit) ** 20
    assert -np.log(history.deformation_gradient[-1, 2, 2]) == pytest.approx(rate, rel=1e-4)


def test_state_variable_releases_the_multiplier(umat: Umat) -> None:
    """STATEV(1) of this UMAT counts increments, here from -1: 0 after the first, 1 after the second, which is solved without."""
    step = Step(1.0, {"11": 1.5, "22": 0.0, "33": 0.0}, {"22": "S", "33": "S"})
    controls = Controls(0.1, 0.1, 0.1, incompressible=True, constraint_release_statev=1, residual_tolerance=1e-11)
    history = drive(umat("neo_hooke"), [MU, 4.1], 1, [step], controls, statev=[-1.0])
    volume = np.linalg.det(history.deformation_gradient)
    assert abs(volume[1] - 1) < 1e-12
    assert history.pressure[1] != 0.0
    assert (history.pressure[2:] == 0.0).all()
    assert volume[-1] > 1.01
    free = drive(umat("neo_hooke"), [MU, 4.1], 1, [step], Controls(residual_tolerance=1e-11))
    assert history.stress[-1] == pytest.approx(free.stress[-1], abs=1e-9)


def test_a_programme_without_a_free_component_is_refused(umat: Umat) -> None:
    with pytest.raises(DriverError, match="needs a component free"):
        drive(umat("neo_hooke"), [MU, 0.0], 1, [Step(1.0, {"33": 0.9})], Controls(incompressible=True))
