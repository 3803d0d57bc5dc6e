"""Fronts, costs at an accuracy, ratios and the recommendation, on points whose answers are known."""

from __future__ import annotations

from dataclasses import replace

import pytest

from plyflow.evidence.bench.accuracy import cost_at, front, median_seconds, pick, recommended, time_ratio, umat_calls
from plyflow.evidence.bench.measure import Point
from plyflow.evidence.bench.schemes import PAPER
from plyflow.evidence.bench.verdict import compare, counted, finished, statement


def point(scheme: str, seconds: float, error: float, calls: int = 100, **more: float) -> Point:
    """One finished point of problem "p"; three repeats that differ by 10 %."""
    return Point(
        problem="p", scheme=scheme, control=f"growth {seconds:g}", family="growth", increments=calls // 2, iterations=calls,
        umat_calls=calls, message="", errors={"thickness": error, "width": more.get("width", 1e-6)},
        seconds=[seconds, 1.1 * seconds, 0.9 * seconds],
    )  # fmt: skip


def first_order(scheme: str, factor: float, calls: float = 1.0) -> list[Point]:
    """Error = 1e-3 factor / seconds."""
    return [point(scheme, s, 1e-3 * factor / s, int(100 * s * calls)) for s in (1.0, 4.0, 40.0)]


def test_a_front_holds_what_no_other_beats() -> None:
    beaten = point("a", 5.0, 1e-3)
    points = [point("a", 1.0, 1e-3), point("b", 2.0, 1e-4), beaten, point("a", 8.0, 1e-6)]
    found = front(points, "thickness", median_seconds)
    assert [p.time.median for p in found] == [1.0, 2.0, 8.0]
    assert beaten not in found


def test_a_cost_is_read_between_points_in_logarithms() -> None:
    assert cost_at(first_order("a", 1.0), median_seconds, target=1e-4) == pytest.approx(10.0)
    assert cost_at(first_order("a", 1.0), median_seconds, target=1e-2) == 1.0
    assert cost_at(first_order("a", 1.0), median_seconds, target=1e-6) is None
    assert cost_at(first_order("a", 2.0), median_seconds, target=1e-4) != pytest.approx(10.0)


def test_a_ratio_is_taken_turn_by_turn() -> None:
    points = first_order("fast", 0.4) + first_order("paper", 1.0)
    found = time_ratio(points, "p", "fast", "paper")
    assert found is not None
    assert found.median == pytest.approx(0.4)
    assert found.low == pytest.approx(found.high)  # a slow turn slows both
    assert time_ratio(points, "p", "fast", "paper", 1e-9) is None
    assert time_ratio(points, "p", "fast", "nobody") is None


def test_the_statement_says_whether_the_ratio_holds_and_the_limit_where_not() -> None:
    good = first_order("default", 0.1) + first_order("paper", 1.0)
    told = statement(good, ["p"], "default", "paper")
    assert told.startswith("default reaches 1e-4 in final thickness in 0.10 of the paper scheme's run time (p alone; ")
    assert "target at most 0.12): met. Paper scheme: scene 'paper'; 3 of its 3 runs finish." in told
    bad = first_order("default", 0.8) + first_order("paper", 1.0)
    said = statement(bad, ["p"], "default", "paper")
    assert "target at most 0.12): missed." in said and "would still leave the ratio of calls at: p 0.80" in said
    nobody = statement(bad, ["p"], "default", PAPER)
    assert "no ratio to the paper scheme's run time on p" in nobody
    assert nobody.endswith("Paper scheme: Eq. 16 tangent, invariants as printed; 0 of its 0 runs finish.")
    one = compare(bad, "p", "default", "paper")
    assert one.calls == pytest.approx(0.8) and one.limit == pytest.approx(0.8)


def test_repeats_that_spread_by_more_than_a_fifth_give_no_verdict() -> None:
    uneven = first_order("default", 0.1)
    for one in uneven:
        one.seconds = [one.seconds[0], 1.6 * one.seconds[1], 0.6 * one.seconds[2]]
    told = statement(uneven + first_order("paper", 1.0), ["p"], "default", "paper")
    assert "no verdict on run time, its repeats spread by 50 % (at most 20)" in told and "met" not in told


def test_calls_and_increments_are_held_against_what_is_wanted() -> None:
    names = ("blocked", "slow", "cold")
    points = [replace(one, problem=name) for name in names for one in
              (point("default", 1.0, 5e-5, 40), point("plain", 1.0, 5e-5, 56), point("bdf1", 5.0, 5e-5, 400))]  # fmt: skip
    calls, own, plain = counted(points, names, "default", "plain")
    assert calls.endswith("blocked 0.1 (target 0.25), slow 0.1 (target 0.25), cold 0.1 (target 0.25): met")
    assert own.endswith("blocked 20 (target 25), slow 20 (target 40), cold 20 (target 25): met")
    assert plain.endswith("blocked 28 (target 25), slow 28 (target 40), cold 28 (target 25): missed")
    assert "slow not reached (target 40)" in counted(points[:1], names, "default", "plain")[1]


def test_only_a_clearly_faster_scheme_that_keeps_the_width_is_recommended() -> None:
    default, close, fast = first_order("default", 1.0), first_order("close", 0.95), first_order("fast", 0.5)
    wide = [point("wide", p.seconds[0], p.errors["thickness"], width=1e-2) for p in first_order("wide", 0.1)]
    points = default + close + fast + wide
    assert recommended(points, ["p"], ["default", "close"], "default") == "default"
    assert recommended(points, ["p"], ["default", "close", "fast", "wide"], "default") == "fast"
    assert recommended(points, ["p"], ["nobody"], "default") == "default"


def test_a_stopped_run_counts_as_such() -> None:
    stopped = point("a", 1.0, 1.0)
    stopped.errors, stopped.message = {}, "PNEWDT asked for less"
    points = [stopped, *first_order("a", 1.0)]
    assert finished(points, "a", ["p"]) == (3, 4)
    assert pick(points, "p", "a")[0].completed is False
    assert cost_at([stopped], umat_calls, target=1e-4) is None
