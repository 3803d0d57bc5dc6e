"""The generated UMAT through the compaction programme, beside the one-dimensional law."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from plyflow.case.case import Case, all_cases
from plyflow.errors import InputError, RunError
from plyflow.run.case_run import RunResult, case_controls, run_case
from plyflow.umat.prepare import Umat

THICKNESS_BOUND, WIDTH_BOUND = 1e-3, 2e-3
ENDS = {f"{quantity}_ratio_{which}" for quantity in ("thickness", "width") for which in ("final", "1d")}
COUNTS = {"increments", "iterations", "cutbacks", "cutbacks_by_reason", "run_time_s"}
PROMISED = ENDS | COUNTS | {"assumptions", "provenance"}
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
    soft = replace(BLOCKED, settings={"kappa": 1.0})
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


def test_the_error_falls_at_first_order_under_refinement_by_2_4_and_8(umat: Umat) -> None:
    levels = errors(SOME, umat, (1.0, 2.0, 4.0, 8.0))
    check_first_order(levels)
    with pytest.raises(AssertionError):  # an error that stops falling is noticed
        check_first_order([level + 1e-5 for level in levels])


def test_the_umat_locks_when_the_law_does(umat: Umat) -> None:
    result = run_case(Case("IMA-M21", 80.0, "CP", 30.0), umat, case_controls(8.0))
    assert result.lock_time is not None
    assert result.lock_time == pytest.approx(result.law.lock_time, rel=5e-3)
    width = result.width_ratio[result.history.time > result.lock_time]
    assert np.max(np.abs(width - width[0])) < 1e-5


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
