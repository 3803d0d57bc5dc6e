"""The exact multiplier: det F = 1 with the pressure as unknown."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from plyflow.driver.drive import Controls, DriverError, Step, UmatAddress, drive

Umat = Callable[[str], UmatAddress]
MU = 1.3


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
