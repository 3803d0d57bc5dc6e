"""Sizes of increments: growth, cuts, PNEWDT, the strain tolerance, and the limits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from plyflow.driver.drive import Controls, Step, UmatAddress, drive

Umat = Callable[[str], UmatAddress]
ELASTIC = [1.3, 4.1]
PULL = Step(1.0, {"33": 0.5}, {"33": "S"})
ASK_SMALLER, NOT_FINITE, ASK_LARGER, STOP, ECHO, WARN = 1.0, 2.0, 3.0, 4.0, 5.0, 6.0


def test_growth_after_two_easy_increments(umat: Umat) -> None:
    history = drive(umat("neo_hooke"), ELASTIC, 1, [PULL], Controls(0.04, 0.04, 1.0))
    assert history.increment[1:7] == pytest.approx(0.04 * np.array([1, 1, 1.5, 1.5**2, 1.5**3, 1.5**4]))
    assert history.step_time[-1] == 1.0


def test_fixed_increments_hit_every_step_end(umat: Umat) -> None:
    steps = [PULL, Step(0.35, {"33": 0.0}, {"33": "S"})]
    history = drive(umat("neo_hooke"), ELASTIC, 1, steps, Controls(0.1, 0.1, 0.1))
    assert history.increments == 10 + 4
    assert history.time[10] == 1.0
    assert history.time[-1] == 1.35
    assert history.increment[-1] == pytest.approx(0.05)


def test_pnewdt_below_one_abandons_the_attempt_and_restores_the_state(umat: Umat) -> None:
    history = drive(umat("misbehaving"), [ASK_SMALLER, 2.0, 0.02], 6, [PULL], Controls(0.5))
    table = history.increment_table
    assert history.completed, history.message
    assert table["increment_size"].iloc[:4].to_list() == pytest.approx([0.5, 0.15, 0.045, 0.0135])
    assert table["note"].iloc[:4].to_list() == ["pnewdt"] * 3 + ["converged"]
    assert history.increment.max() <= 0.02
    assert history.cutbacks_by_reason.keys() == {"pnewdt"}
    # A state variable that every call raises by one counts accepted increments only.
    assert history.statev[-1, 0] == history.increments


def test_attempts_ended_through_pnewdt_are_attempts(umat: Umat) -> None:
    history = drive(umat("misbehaving"), [ASK_SMALLER, 2.0, 1e-5], 6, [PULL], Controls(1.0))
    assert history.increment_table["note"].to_list() == ["pnewdt"] * 5
    assert "all 5 attempts are used" in history.message


def test_attempts_after_failed_iterations_begin_without_motion(umat: Umat) -> None:
    """From the rate before a fall of the load plain Newton overshoots, however short the increment; from rest it arrives."""
    steps = [Step(1.0, {"33": 0.8}, {"33": "P"}, instant=True), Step(1.0, {"33": 0.0}, {"33": "P"})]
    controls = Controls(0.3, 0.3 * 0.25**4, 0.3, newton="plain")
    history = drive(umat("power_law"), [1.0, 0.05, 0.0, 1e-12, 1e-12], 0, steps, controls)
    table = history.increment_table
    assert history.completed, history.message
    assert history.cutbacks >= 1
    assert set(table["note"][table["attempt"] == 2]) == {"converged"}


@pytest.mark.parametrize("growth", [1.2, 3.0])
def test_pnewdt_above_one_is_the_growth(umat: Umat, growth: float) -> None:
    history = drive(umat("misbehaving"), [ASK_LARGER, 2.0, growth], 6, [PULL], Controls(0.01, maximum_increment=0.2))
    sizes = history.increment[1:-1]
    assert sizes[:3] == pytest.approx(0.01 * growth ** np.arange(3))
    assert sizes.max() <= 0.2


def test_failed_attempts_are_cut_to_a_quarter_at_most_five_times(umat: Umat) -> None:
    history = drive(umat("misbehaving"), [NOT_FINITE, 2.0, 0.0], 6, [PULL], Controls(0.5))
    table = history.increment_table
    assert not history.completed
    assert table["increment_size"].to_list() == pytest.approx(list(0.5 * 0.25 ** np.arange(5)))
    assert "all 5 attempts are used" in history.message
    assert history.increments == 0


def test_cut_increments_recover(umat: Umat) -> None:
    """Five iterations do not do for the whole load in one increment, but for a quarter of it."""
    step = Step(1.0, {"11": 40.0, "22": 0.0, "33": 0.0}, {"11": "S", "22": "S", "33": "S"})
    history = drive(umat("neo_hooke"), ELASTIC, 1, [step], Controls(1.0, max_iterations=5))
    assert history.completed, history.message
    assert history.cutbacks_by_reason.get("max_iterations", 0) >= 1
    assert history.iterations.max() <= 5
    # The stretch obeys the load whatever the increments were.
    assert history.stress[-1, :3] == pytest.approx([40.0, 0.0, 0.0], abs=1e-4)


def test_below_the_minimum_increment_the_analysis_ends_with_a_message(umat: Umat) -> None:
    history = drive(umat("misbehaving"), [ASK_SMALLER, 2.0, 0.001], 6, [PULL], Controls(0.1, 0.01))
    assert not history.completed
    assert "step 1, increment 1" in history.message
    assert "below the minimum of 1.000E-02 s" in history.message
    assert "PNEWDT asked for less" in history.message
    # The minimum itself has been tried before.
    assert history.increment_table["increment_size"].iloc[-1] == pytest.approx(0.01)
    assert history.failure is not None
    assert history.failure.increment_size == pytest.approx(0.01)


def test_nan_is_never_accepted(umat: Umat) -> None:
    history = drive(umat("misbehaving"), [NOT_FINITE, 2.0, 0.55], 6, [PULL], Controls(0.1, 0.01))
    assert not history.completed
    assert "NaN or Inf from the UMAT" in history.message
    assert np.isfinite(history.stress).all()
    assert history.time[-1] < 0.55
    assert history.time[-1] > 0.5
    assert history.failure is not None
    assert history.failure.outcome == "not_finite"
    assert history.failure.total_time == history.time[-1]


def test_a_stop_of_the_umat_ends_the_analysis_with_its_words(umat: Umat) -> None:
    history = drive(umat("misbehaving"), [STOP, 2.0, 0.5], 6, [PULL], Controls(0.1, 0.1, 0.1))
    assert not history.completed
    assert history.cutbacks_by_reason == {"stopped": 1}
    assert history.message.endswith("UMAT: element 1 point 1: the spring is broken")
    again = drive(umat("misbehaving"), [STOP, 2.0, 2.0], 6, [PULL], Controls(0.1, 0.1, 0.1))
    assert again.completed, "the message of the last run must not leak into the next"


def test_warnings_are_kept_and_bounded(umat: Umat) -> None:
    history = drive(umat("misbehaving"), [WARN, 2.0, 0.0], 6, [PULL], Controls(0.05, 0.05, 0.05))
    assert history.completed
    assert history.warnings.startswith("w" * 300)
    assert len(history.warnings) <= 2048


def test_the_umat_gets_its_name_step_increment_and_temperature(umat: Umat) -> None:
    steps = [PULL, PULL]
    fixed = Controls(0.25, 0.25, 0.25)
    history = drive(umat("misbehaving"), [ECHO, 2.0, 0.0], 6, steps, fixed, temperature=70.0, material_name="RESIN")
    assert history.statev[-1, 1:] == pytest.approx([80, ord("R"), 2, 4, 70.0])


def test_strain_tolerance_bounds_the_error_of_prediction(umat: Umat) -> None:
    """Strain is a smooth function of time here: a tighter tolerance takes smaller increments."""
    load = Step(1.0, {"11": 30.0, "22": 0.0, "33": 0.0}, {"11": "S", "22": "S", "33": "S"})
    errors, increments = [], []
    for tolerance in (1e-2, 1e-3, 1e-4):
        controls = Controls(1e-4, strain_tolerance=tolerance, reject_factor=2.0)
        history = drive(umat("neo_hooke"), ELASTIC, 1, [load], controls)
        assert history.completed, history.message
        rates = np.diff(history.strain, axis=0) / history.increment[1:, None]
        errors.append(np.abs(np.diff(rates, axis=0) * history.increment[2:, None]).max())
        increments.append(history.increments)
        assert errors[-1] <= 2.0 * tolerance
    assert increments[0] < increments[1] < increments[2]


def test_without_a_reject_factor_nothing_is_rejected(umat: Umat) -> None:
    load = Step(1.0, {"33": 30.0}, {"33": "S"})
    controls = Controls(0.01, strain_tolerance=1e-6)
    assert drive(umat("neo_hooke"), ELASTIC, 1, [load], controls).cutbacks == 0


def test_max_increments_ends_the_analysis(umat: Umat) -> None:
    history = drive(umat("neo_hooke"), ELASTIC, 1, [PULL], Controls(0.01, 0.01, 0.01, max_increments=7))
    assert history.increments == 7
    assert "max_increments" in history.message
    assert history.failure is None


def test_histories_longer_than_the_first_allocation_are_whole(umat: Umat) -> None:
    history = drive(umat("neo_hooke"), ELASTIC, 1, [PULL], Controls(1e-3, 1e-3, 1e-3))
    assert history.increments == 1000
    assert history.statev[:, 0] == pytest.approx(np.arange(1001))
    assert history.time == pytest.approx(np.arange(1001) * 1e-3)
