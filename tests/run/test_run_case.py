"""The generated UMAT through the compaction programme, beside the one-dimensional law."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from plyflow.case.case import Case, all_cases
from plyflow.errors import InputError, RunError
from plyflow.run.accuracy import estimated, reach
from plyflow.run.case_run import RunResult, case_controls, run_case
from plyflow.umat.prepare import Umat

THICKNESS_BOUND, WIDTH_BOUND = 1e-3, 2e-3
ENDS = {f"{quantity}_ratio_{which}" for quantity in ("thickness", "width") for which in ("final", "1d")}
COUNTS = {"increments", "iterations", "cutbacks", "cutbacks_by_reason", "run_time_s"}
ERRORS = {"accuracy", "error_estimate", "error_1d", "refinement", "increments_in_all", "umat_calls", "umat_calls_in_all"}
PROMISED = ENDS | COUNTS | ERRORS | {"assumptions", "provenance"}
BLOCKED = Case("IM7-8552", 70.0, "BP", 15.0)
SOME = all_cases()[::9]


def check_end(result: RunResult) -> None:
    summary = result.summary()
    thickness = summary["thickness_ratio_final"] - summary["thickness_ratio_1d"]
    width = summary["width_ratio_final"] - summary["width_ratio_1d"]
    assert abs(thickness) < THICKNESS_BOUND, (result.case.label, thickness)
    assert abs(width) < WIDTH_BOUND, (result.case.label, width)


ENDING = [*all_cases(), *all_cases("monotonic")[::9]]


@pytest.mark.parametrize("case", ENDING, ids=lambda case: case.label.replace(" ", "_"))
def test_both_programmes_end_on_the_one_dimensional_law(case: Case, umat: Umat) -> None:
    check_end(run_case(case, umat))


def test_a_umat_that_is_compressible_before_the_lock_is_noticed(umat: Umat) -> None:
    soft = Case("IMA-M21", 80.0, "CP", 30.0, settings={"kappa": 1.0})
    with pytest.raises(AssertionError):
        check_end(run_case(soft, umat))


def test_a_umat_with_another_k_is_noticed(umat: Umat) -> None:
    other = run_case(replace(BLOCKED, settings={"k": 0.82}), umat)
    with pytest.raises(AssertionError):
        check_end(replace(other, law=run_case(BLOCKED, umat, case_controls(0.5)).law))


def errors(cases: list[Case], umat: Umat, refinements: tuple[float, ...]) -> list[np.ndarray]:
    return [
        np.array([difference(run_case(case, umat, case_controls(refinement))) for case in cases])
        for refinement in refinements
    ]


def difference(result: RunResult) -> float:
    return float(result.thickness_ratio[-1] - result.law.thickness_ratio[-1])


def check_first_order(levels: list[np.ndarray]) -> None:
    """Halving every increment halves the error; 1.9 to 2.1: increments do not quite fit a step."""
    for coarse, fine in pairwise(levels):
        ratio = coarse / fine
        assert np.min(ratio) > 1.9, ratio
        assert np.max(ratio) < 2.1, ratio


def test_the_error_falls_at_first_order_under_refinement_by_2_4_and_8(bdf1: Umat) -> None:
    levels = errors(SOME, bdf1, (1.0, 2.0, 4.0, 8.0))
    check_first_order(levels)
    with pytest.raises(AssertionError):  # an error that stops falling is noticed
        check_first_order([level + 1e-5 for level in levels])


def test_the_umat_locks_when_the_law_does_inside_an_increment(umat: Umat, bdf1: Umat) -> None:
    case = Case("IMA-M21", 80.0, "CP", 30.0)
    result, first_order = run_case(case, umat), run_case(case, bdf1, case_controls(8.0))
    assert result.lock_time is not None
    assert result.lock_time == pytest.approx(result.law.lock_time, rel=1e-3)  # the increment is 30 s long
    assert first_order.lock_time == pytest.approx(result.law.lock_time, rel=5e-3)
    assert result.lock_time < result.history.time[np.argmax(result.locked)] - 1.0
    width = result.width_ratio[result.history.time > result.lock_time]
    assert np.max(np.abs(width - width[0])) < 1e-5


@pytest.mark.parametrize("case", [*all_cases()[::7], *all_cases("monotonic")[::7]], ids=lambda case: case.label.replace(" ", "_"))
def test_default_increments_are_few_and_their_error_is_well_below_1e_4(case: Case, umat: Umat) -> None:
    found = run_case(case, umat).summary()
    assert abs(found["error_1d"]) < 6e-5 and found["increments"] <= 90


@pytest.mark.parametrize("case", [*all_cases()[::11], *all_cases("monotonic")[::11]], ids=lambda case: case.label.replace(" ", "_"))
def test_a_wanted_accuracy_is_reached_and_its_estimate_does_not_flatter(case: Case, umat: Umat) -> None:
    for wanted in (1e-3, 1e-4, 1e-5):
        found = run_case(case, umat, accuracy=wanted).summary()
        assert abs(found["error_1d"]) < wanted and found["error_estimate"] <= wanted == found["accuracy"]
        assert abs(found["error_1d"]) < 2.0 * found["error_estimate"] + 1e-6  # the second: elasticity, which the law has not
        assert found["increments_in_all"] > found["increments"]


def test_an_accuracy_costs_the_creep_exact_increment_a_fraction_of_the_backward_difference(umat: Umat, bdf1: Umat) -> None:
    for load, fraction in (("ramp-dwell", 0.05), ("monotonic", 0.3)):
        mine, base = (run_case(replace(BLOCKED, load=load), one, accuracy=1e-5).summary() for one in (umat, bdf1))
        assert abs(base["error_1d"]) < 1e-5 and mine["umat_calls_in_all"] < fraction * base["umat_calls_in_all"]


def test_estimates_follow_the_order_and_doubt_what_does_not_show_it() -> None:
    assert estimated([1.0], 2) == np.inf
    assert estimated([1.0, 1.3], 2) == pytest.approx(0.3)  # the order is not shown yet
    assert estimated([1.0, 1.4, 1.5], 2) == pytest.approx(0.1 / 3.0)
    assert estimated([1.0, 1.1, 1.4], 2) == pytest.approx(0.3)
    assert estimated([1.0, 1.9, 2.0], 1) == pytest.approx(0.1)


def test_an_accuracy_out_of_reach_or_beside_controls_is_refused(umat: Umat) -> None:
    for accuracy in (0.0, 1e-9, 1.0, float("nan")):
        with pytest.raises(InputError, match=r"accuracy .* must lie between 1e-07 and 0.1"):
            run_case(BLOCKED, umat, accuracy=accuracy)
    with pytest.raises(InputError, match="controls and accuracy exclude each other"):
        run_case(BLOCKED, umat, case_controls(), accuracy=1e-4)
    with pytest.raises(RunError, match=r"accuracy 1e-07 is not reached with 40000 increments .*integrator 'creep'"):
        reach(1e-7, 1, 1.0, lambda refinement: refinement, lambda one: (1.0 / one, int(1e4 * one), 0))


def test_a_coarse_run_that_fails_is_passed_over_and_a_fine_one_is_not() -> None:
    def run(refinement: float) -> float:
        if refinement < first:
            raise RunError("failed")
        return refinement

    first = 0.5
    found = reach(1e-2, 1, 0.125, run, lambda one: (1e-2 / one, 10, 20))
    assert (found.refinement, found.runs, found.increments, found.umat_calls) == (1.0, 2, 20, 40)
    first = 4.0
    with pytest.raises(RunError, match="failed"):
        reach(1e-2, 1, 0.125, run, lambda one: (1e-2 / one, 10, 20))


def test_the_summary_is_plain_json_with_what_was_promised(umat: Umat) -> None:
    result = run_case(BLOCKED, umat)
    read = json.loads(result.to_json())
    assert set(read) >= PROMISED
    assert sum(read["cutbacks_by_reason"].values()) == read["cutbacks"]
    assert read["increments"] == len(result.history_table()) - 1
    assert read["iterations"] >= read["increments"]
    assert len(read["provenance"]["source_sha256"]) == 64
    assert read["provenance"]["inputs"]["k"] == 0.813


def test_a_run_that_cannot_finish_says_where_it_stopped(umat: Umat) -> None:
    with pytest.raises(RunError, match=r"IM7-8552 70 degC BP 15 mm ramp-dwell: stopped at .* s of 1200 s: "):
        run_case(BLOCKED, umat, replace(case_controls(), max_increments=5))


@pytest.mark.parametrize("refinement", [0.0, -1.0, float("nan"), float("inf")])
def test_impossible_refinements_are_refused(refinement: float) -> None:
    with pytest.raises(InputError, match="refinement"):
        case_controls(refinement)
