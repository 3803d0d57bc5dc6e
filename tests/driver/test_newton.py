"""Newton on stress that grows like (strain increment)^0.05, the order of its last steps, and DDSDDE beside differences."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Literal

import numpy as np
import pytest

from plyflow.driver.drive import COMPONENTS, Controls, History, Step, UmatAddress, drive

Umat = Callable[[str], UmatAddress]
Newton = Literal["power", "plain"]
CONSISTENCY, EXPONENT, FLOOR = 1.0, 0.05, 1e-12
NEWTONS: tuple[Newton, Newton] = ("power", "plain")
MIXED = Step(1.0, {"22": 0.0, "33": 1.0}, {"22": "S", "33": "P"}, instant=True)
STRETCHED = Step(1.0, {"11": 1.4, "12": 0.5, "22": 0.0, "33": 0.0}, {"22": "S", "33": "S"})
CHECK = Controls(0.1, 0.1, 0.1, tangent_check=1)


def fluid(bulk: float = 0.0) -> list[float]:
    """Constants of power_law.f: consistency, exponent, bulk viscosity, rate floor, strain floor."""
    return [CONSISTENCY, EXPONENT, bulk, FLOOR, FLOOR]


def creep_rate(pressure: float) -> float:
    """Uniaxial strain at rate e: D33' = 2/3 e, r^2 = 2/3 (6/9) e^2 = (2/3 e)^2, s33 = K r^(n-1) 2/3 e."""
    return float(1.5 * (pressure / CONSISTENCY) ** (1 / EXPONENT))


def measured_order(histories: list[History]) -> float:
    """Slope of log(next residual) over log(residual), for residuals that are small and above rounding."""
    pairs = [
        (before, after)
        for history in histories
        for residuals in history.residuals
        for before, after in itertools.pairwise(residuals)
        if before < 0.03 and after > 1e-13
    ]
    assert len(pairs) >= 10
    before, after = np.log(np.array(pairs)).T
    return float(np.polyfit(before, after, 1)[0])


def elastic_histories(library: UmatAddress, newton: Newton, shear_factor: float = 1.0) -> list[History]:
    """Twenty combined loads of a neo-Hooke, each in one increment with six unknowns."""
    random = np.random.default_rng(7)
    one = Controls(1.0, 0.01, 1.0, residual_tolerance=1e-12, newton=newton, max_iterations=60)
    histories = []
    for _ in range(20):
        targets = dict(zip(COMPONENTS[:6], random.uniform(-1.0, 1.0, 6).tolist(), strict=True))
        load = Step(1.0, targets, dict.fromkeys(targets, "S"))
        histories.append(drive(library, [1.3, 4.1, shear_factor], 1, [load], one))
        assert histories[-1].completed, histories[-1].message
    return histories


@pytest.mark.parametrize("pressure", [0.4, 0.6, 0.8])
def test_creep_from_rest_converges_in_five_iterations(umat: Umat, pressure: float) -> None:
    """From a strain increment of 0 to one up to nine decades above the floor."""
    step = Step(1.0, {"33": pressure}, {"33": "P"}, instant=True)
    history = drive(umat("power_law"), fluid(), 0, [step], Controls(0.1, 0.1, 0.1))
    assert history.completed, history.message
    assert history.cutbacks == 0
    assert history.iterations[1:].max() <= 5
    strain_rate = -history.strain[1, 2] / history.increment[1]
    # The residual tolerance of 1e-6 in stress is 20 times as much in the rate.
    assert strain_rate == pytest.approx(creep_rate(pressure), rel=2e-5)


def test_plain_newton_needs_more_iterations_from_rest(umat: Umat) -> None:
    step = Step(1.0, {"33": 0.8}, {"33": "P"}, instant=True)
    power, plain = (
        drive(umat("power_law"), fluid(), 0, [step], Controls(0.1, 0.1, 0.1, newton=newton, extrapolation="none"))
        for newton in NEWTONS
    )
    assert plain.completed
    assert plain.strain[-1] == pytest.approx(power.strain[-1], rel=1e-4)
    assert plain.total_iterations > 1.5 * power.total_iterations


@pytest.mark.parametrize("load_drop", [0.9, 0.5, 0.1])
def test_unloading_from_above_converges(umat: Umat, load_drop: float) -> None:
    """Plain Newton diverges from above; here the last rate is the first guess and the stress falls."""
    steps = [Step(1.0, {"33": 0.8}, {"33": "P"}, instant=True), Step(1.0, {"33": 0.8 * load_drop}, {"33": "P"})]
    history = drive(umat("power_law"), fluid(), 0, steps, Controls(0.1, 0.1, 0.1))
    assert history.completed, history.message
    assert history.cutbacks == 0
    assert history.iterations.max() <= 6
    flow = -np.diff(history.strain[:, 2]) / np.diff(history.time)
    assert flow[-1] == pytest.approx(creep_rate(0.8 * load_drop), rel=1e-4, abs=1e-10)


def test_reversed_load_flows_back(umat: Umat) -> None:
    steps = [Step(1.0, {"33": 0.8}, {"33": "P"}, instant=True), Step(1.0, {"33": -0.8}, {"33": "P"}, instant=True)]
    history = drive(umat("power_law"), fluid(), 0, steps, Controls(0.1, 0.1, 0.1))
    assert history.completed, history.message
    assert history.cutbacks == 0
    assert history.strain[-1, 2] == pytest.approx(0.0, abs=1e-5 * np.abs(history.strain).max())


def test_free_edge_with_stiff_bulk_converges_without_cutbacks(umat: Umat) -> None:
    history = drive(umat("power_law"), fluid(bulk=1e4), 0, [MIXED], Controls(0.1, 0.1, 0.1))
    assert history.completed, history.message
    assert history.cutbacks == 0
    assert history.iterations.max() <= 8
    assert np.abs(history.stress[1:, 1]).max() < 1e-6


@pytest.mark.parametrize("newton", ["power", "plain"])
def test_elastic_steps_are_of_second_order(umat: Umat, newton: Newton) -> None:
    assert measured_order(elastic_histories(umat("neo_hooke"), newton)) > 1.9


@pytest.mark.parametrize("newton", ["power", "plain"])
def test_viscous_steps_are_of_second_order(umat: Umat, newton: Newton) -> None:
    controls = Controls(0.1, 0.1, 0.1, residual_tolerance=1e-12, newton=newton, extrapolation="none", max_iterations=60)
    histories = []
    for pressure in np.linspace(0.9, 1.1, 9):
        step = Step(1.0, {"22": 0.0, "33": float(pressure)}, {"22": "S", "33": "P"}, instant=True)
        histories.append(drive(umat("power_law"), fluid(bulk=1.0), 0, [step], controls))
        assert histories[-1].completed, histories[-1].message
    assert measured_order(histories) > 1.9


def test_planted_error_in_the_tangent_lowers_the_order(umat: Umat) -> None:
    """The measure of the order is shown to catch a shear stiffness that is 5 % wrong."""
    wrong = elastic_histories(umat("neo_hooke"), "power", shear_factor=1.05)
    right = elastic_histories(umat("neo_hooke"), "power")
    assert measured_order(wrong) < 1.2
    assert sum(h.total_iterations for h in wrong) > 1.3 * sum(h.total_iterations for h in right)


def test_right_tangent_agrees(umat: Umat) -> None:
    check = drive(umat("neo_hooke"), [1.3, 4.1], 1, [STRETCHED], CHECK).tangent_check
    assert check is not None
    # Central differences at a strain step of 1e-6 to 1e-4: rounding over step.
    assert check.difference < 1e-8


@pytest.mark.parametrize("error", [1e-3, 0.1])
def test_planted_error_is_found_where_it_is(umat: Umat, error: float) -> None:
    check = drive(umat("neo_hooke"), [1.3, 4.1, 1 + error], 1, [STRETCHED], CHECK).tangent_check
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
    assert drive(umat("neo_hooke"), [1.3, 4.1], 1, [STRETCHED]).tangent_check is None


def test_check_does_not_change_the_path(umat: Umat) -> None:
    checked = drive(umat("neo_hooke"), [1.3, 4.1], 1, [STRETCHED], CHECK)
    plain = drive(umat("neo_hooke"), [1.3, 4.1], 1, [STRETCHED], Controls(0.1, 0.1, 0.1))
    assert (checked.stress == plain.stress).all()
    assert (checked.statev == plain.statev).all()
    assert checked.umat_calls > plain.umat_calls
