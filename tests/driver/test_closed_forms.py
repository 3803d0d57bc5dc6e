"""Stress, stretch and work of a compressible neo-Hooke and of rate-form elasticity against closed forms."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import brentq

from plyflow.driver.drive import Controls, Kind, Step, UmatAddress, drive

Umat = Callable[[str], UmatAddress]
MU, LAMBDA = 1.3, 4.1
FREE_SIDES: dict[str, Kind] = {"22": "S", "33": "S"}
# Tolerance of the stress residual; the results below follow it by the stiffness, hence a factor of 10.
TIGHT = 1e-11


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
