"""Does the recommendation reach the wanted accuracy in half the paper's run time? The ratios, and what limits them."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from plyflow.evidence.bench.accuracy import TARGET, WANTED_RATIO, Ratio, cost_at, pick, ratio, umat_calls
from plyflow.evidence.bench.measure import Point
from plyflow.evidence.bench.schemes import DEFAULT, PAPER, PAPER_REAL


@dataclass(frozen=True)
class Comparison:
    """One problem: cost of `scheme` over that of the paper's at `TARGET` in final thickness.

    `base` is the paper's scheme as printed where it gets there, else with the always-real invariants.
    `limit` is the ratio of calls if `scheme` needed no more than two calls an increment.
    """

    problem: str
    scheme: str
    base: str
    time: Ratio | None
    calls: float | None
    limit: float | None


def compare(points: Sequence[Point], problem: str, scheme: str, base: str) -> Comparison:
    """`scheme` against `base` on one problem."""
    mine, other = pick(points, problem, scheme), pick(points, problem, base)
    costs = [cost_at(group, "thickness", TARGET, umat_calls) for group in (mine, other)]
    steps = cost_at(mine, "thickness", TARGET, lambda p: float(p.increments))
    return Comparison(
        problem, scheme, base,
        ratio(points, problem, scheme, base, "thickness", TARGET),
        None if costs[0] is None or costs[1] is None else costs[0] / costs[1],
        None if steps is None or costs[1] is None else 2.0 * steps / costs[1],
    )  # fmt: skip


def comparisons(points: Sequence[Point], problems: Sequence[str], recommended: str) -> list[Comparison]:
    """Default scene and recommendation, each against the paper's scheme, as printed and with real invariants."""
    schemes = dict.fromkeys((recommended, DEFAULT))
    return [compare(points, problem, scheme, base) for scheme in schemes for base in (PAPER, PAPER_REAL)
            for problem in problems]  # fmt: skip


def finished(points: Sequence[Point], scheme: str, problems: Sequence[str]) -> tuple[int, int]:
    """Runs of a scheme that finished, and all of them, over the given problems."""
    mine = [point for problem in problems for point in pick(points, problem, scheme)]
    return sum(point.completed for point in mine), len(mine)


def overall(found: Sequence[Comparison]) -> Ratio | None:
    """Geometric mean over the problems; None if one of them has no ratio."""
    times = [one.time for one in found]
    known = [time for time in times if time is not None]
    if not known or len(known) < len(times):
        return None
    parts = [[getattr(time, name) for time in known] for name in ("median", "low", "high")]
    return Ratio(*(statistics.geometric_mean(part) for part in parts))


def statement(points: Sequence[Point], problems: Sequence[str], scheme: str, base: str) -> str:
    """One sentence: the ratio, whether it meets the target, and the limit where it does not."""
    found = [compare(points, problem, scheme, base) for problem in problems]
    done, total = finished(points, base, problems)
    told = base if base == PAPER else f"scene '{base}'"
    who = f" Paper scheme: {told}; {done} of its {total} runs finish."
    mean = overall(found)
    known = [one.time.median for one in found if one.time is not None]
    if mean is None:
        missing = ", ".join(one.problem for one in found if one.time is None)
        elsewhere = ", ".join(f"{one.problem} {one.time.median:.2f}" for one in found if one.time is not None)
        return (
            f"{scheme}: no ratio to the paper scheme's run time on {missing}, where one of the two does not reach "
            f"{_short(TARGET)} in final thickness{f' (elsewhere {elsewhere})' if elsewhere else ''}.{who}"
        )
    verdict = "met" if mean.median <= WANTED_RATIO else "missed"
    spread = f"{min(known):.2f} to {max(known):.2f} by programme; " if len(known) > 1 else f"{problems[0]} alone; "
    text = (
        f"{scheme} reaches {_short(TARGET)} in final thickness in {mean.median:.2f} of the paper scheme's run time "
        f"({spread}quartiles of the repeats {mean.low:.2f} to {mean.high:.2f}; target at most {WANTED_RATIO:g}): {verdict}.{who}"
    )
    over = [one for one in found if one.time is not None and one.time.median > WANTED_RATIO and one.limit is not None]
    if over:
        limits = ", ".join(f"{one.problem} {one.limit:.2f}" for one in over)
        text += (
            f" Where the ratio is above {WANTED_RATIO:g}, two calls an increment, the least that Newton can do, would "
            f"still leave the ratio of calls at: {limits}."
        )
    return text


def _short(value: float) -> str:
    """1e-4, not 0.0001 or 1e-04."""
    mantissa, exponent = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(exponent)}"
