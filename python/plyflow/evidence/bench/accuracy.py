"""From points to statements: fronts, what an accuracy costs, and the ratio of two schemes with its spread."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from plyflow.evidence.bench.measure import Point

TARGET = 1e-4
WANTED_RATIO = 0.5
MARGIN = 0.9  # another scheme is recommended only if it is faster than the default one by more than this factor
Cost = Callable[[Point], float]


@dataclass(frozen=True)
class Ratio:
    """Cost of one scheme over that of another at the same accuracy: median, quartiles over the repeats."""

    median: float
    low: float
    high: float


def median_seconds(point: Point) -> float:
    """Run time in s."""
    return point.median


def umat_calls(point: Point) -> float:
    """Calls of the UMAT: the same on every machine."""
    return float(point.umat_calls)


def front(points: Iterable[Point], quantity: str, cost: Cost) -> list[Point]:
    """Points that no other beats in both cost and error, cheapest first."""
    ordered = sorted((p for p in points if quantity in p.errors), key=lambda p: (cost(p), p.errors[quantity]))
    found: list[Point] = []
    for point in ordered:
        if not found or point.errors[quantity] < found[-1].errors[quantity]:
            found.append(point)
    return found


def cost_at(points: Iterable[Point], quantity: str, target: float, cost: Cost) -> float | None:
    """Cost of an accuracy, read between the points of the front in logarithms; None if it is not reached."""
    before: Point | None = None
    for point in front(points, quantity, cost):
        error = point.errors[quantity]
        if error <= target:
            if before is None or error <= 0.0:
                return cost(point)
            part = math.log(before.errors[quantity] / target) / math.log(before.errors[quantity] / error)
            return float(cost(before) * (cost(point) / cost(before)) ** part)
        before = point
    return None


def pick(points: Iterable[Point], problem: str, scheme: str) -> list[Point]:
    """Points of one scheme on one problem."""
    return [p for p in points if p.problem == problem and p.scheme == scheme]


def ratio(points: Sequence[Point], problem: str, scheme: str, base: str, quantity: str, target: float) -> Ratio | None:
    """Run time of `scheme` over that of `base` at equal accuracy, turn by turn; None if one does not reach it."""
    mine, other = pick(points, problem, scheme), pick(points, problem, base)
    turns = min((len(p.seconds) for p in (*mine, *other) if p.completed), default=0)
    found = []
    for turn in range(turns):
        pair = [cost_at(group, quantity, target, lambda p, t=turn: p.seconds[t]) for group in (mine, other)]  # type: ignore[misc]
        if pair[0] is None or pair[1] is None:
            return None
        found.append(pair[0] / pair[1])
    if not found:
        return None
    ordered = sorted(found)
    quarter = len(ordered) // 4
    return Ratio(statistics.median(ordered), ordered[quarter], ordered[-1 - quarter])


def recommended(points: Sequence[Point], problems: Sequence[str], candidates: Sequence[str], default: str) -> str:
    """The candidate with the least run time to `TARGET` in final thickness, geometric mean over the problems.

    It must also hold the final width to `TARGET` in every finished run; the default one stays unless beaten by more than
    `MARGIN`.
    """
    times: dict[str, float] = {}
    for name in candidates:
        costs = [cost_at(pick(points, problem, name), "thickness", TARGET, median_seconds) for problem in problems]
        widths = [p.errors["width"] for problem in problems for p in pick(points, problem, name) if p.completed]
        if all(cost is not None for cost in costs) and widths and max(widths) <= TARGET:
            times[name] = statistics.geometric_mean([cost for cost in costs if cost is not None])
    if not times:
        return default
    best = min(times, key=lambda name: times[name])
    return best if default not in times or times[best] < MARGIN * times[default] else default
