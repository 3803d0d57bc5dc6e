"""From points to statements: fronts, what an accuracy costs, and the ratio of two schemes with its spread."""

from __future__ import annotations

import math
import statistics
from collections.abc import Callable, Iterable, Sequence
from operator import attrgetter

from plyflow.evidence.bench.measure import Point
from plyflow.evidence.bench.spread import Spread, spread_of

TARGET = 1e-4
MARGIN = 0.9  # another scheme is recommended only if it is faster than the default one by more than this factor
Cost = Callable[[Point], float]
median_seconds: Cost = attrgetter("time.median")
umat_calls: Cost = attrgetter("umat_calls")  # the same on every machine
increments: Cost = attrgetter("increments")


def front(points: Iterable[Point], quantity: str, cost: Cost) -> list[Point]:
    """Points that no other beats in both cost and error, cheapest first."""
    found: list[Point] = []
    for point in sorted((p for p in points if quantity in p.errors), key=lambda p: (cost(p), p.errors[quantity])):
        if not found or point.errors[quantity] < found[-1].errors[quantity]:
            found.append(point)
    return found


def cost_at(points: Iterable[Point], cost: Cost, quantity: str = "thickness", target: float = TARGET) -> float | None:
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


def over(mine: float | None, base: float | None) -> float | None:
    """Ratio of two costs; None if one of them is."""
    return None if mine is None or base is None else mine / base


def time_ratio(points: Sequence[Point], problem: str, scheme: str, base: str, target: float = TARGET) -> Spread | None:
    """Run time of `scheme` over that of `base` at equal final thickness, turn by turn; None if one does not reach it."""
    pair = [pick(points, problem, name) for name in (scheme, base)]
    turns = min((len(p.seconds) for group in pair for p in group if p.completed), default=0)
    found = []
    for turn in range(turns):
        costs = [cost_at(group, lambda p, t=turn: p.seconds[t], target=target) for group in pair]  # type: ignore[misc]
        found.append(over(*costs))
    known = [one for one in found if one is not None]
    return spread_of(known) if known and len(known) == turns else None


def recommended(points: Sequence[Point], problems: Sequence[str], candidates: Sequence[str], default: str) -> str:
    """The candidate with the least run time to `TARGET` in final thickness, geometric mean over the problems.

    It must also hold the final width to `TARGET` in every finished run; the default one stays unless beaten by more than
    `MARGIN`.
    """
    times: dict[str, float] = {}
    for name in candidates:
        costs = [cost_at(pick(points, problem, name), median_seconds) for problem in problems]
        known = [cost for cost in costs if cost is not None]
        widths = [p.errors["width"] for problem in problems for p in pick(points, problem, name) if p.completed]
        if len(known) == len(costs) and widths and max(widths) <= TARGET:
            times[name] = statistics.geometric_mean(known)
    best = min(times, key=lambda name: times[name], default=default)
    return best if default not in times or times[best] < MARGIN * times[default] else default
