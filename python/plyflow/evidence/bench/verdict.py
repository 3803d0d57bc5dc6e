"""Does the recommendation reach the wanted accuracy in half the paper's run time? The ratios, and what limits them."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from plyflow.evidence.bench.accuracy import TARGET, cost_at, increments, over, pick, time_ratio, umat_calls
from plyflow.evidence.bench.measure import Point
from plyflow.evidence.bench.schemes import DEFAULT, PAPER, PAPER_REAL
from plyflow.evidence.bench.spread import Spread

WANTED_RATIO = 0.5
REACHED = f"{TARGET:.0e}".replace("e-0", "e-") + " in final thickness"


@dataclass(frozen=True)
class Comparison:
    """One problem: cost of `scheme` over that of the paper's at `TARGET` in final thickness.

    `base` is the paper's scheme as printed where it gets there, else with the always-real invariants.
    `limit` is the ratio of calls if `scheme` needed no more than two calls an increment.
    """

    problem: str
    scheme: str
    base: str
    time: Spread | None
    calls: float | None
    limit: float | None

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return asdict(self) | {"time": None if self.time is None else self.time._asdict()}


def compare(points: Sequence[Point], problem: str, scheme: str, base: str) -> Comparison:
    """`scheme` against `base` on one problem."""
    mine, other = pick(points, problem, scheme), pick(points, problem, base)
    calls, steps, base_calls = cost_at(mine, umat_calls), cost_at(mine, increments), cost_at(other, umat_calls)
    least = None if steps is None else 2.0 * steps
    time = time_ratio(points, problem, scheme, base)
    return Comparison(problem, scheme, base, time, over(calls, base_calls), over(least, base_calls))


def comparisons(points: Sequence[Point], problems: Sequence[str], recommended: str) -> list[Comparison]:
    """Default scene and recommendation, each against the paper's scheme, as printed and with real invariants."""
    schemes = dict.fromkeys((recommended, DEFAULT))
    return [compare(points, problem, scheme, base) for scheme in schemes for base in (PAPER, PAPER_REAL)
            for problem in problems]  # fmt: skip


def finished(points: Sequence[Point], scheme: str, problems: Sequence[str]) -> tuple[int, int]:
    """Runs of a scheme that finished, and all of them, over the given problems."""
    mine = [point for problem in problems for point in pick(points, problem, scheme)]
    return sum(point.completed for point in mine), len(mine)


def statement(points: Sequence[Point], problems: Sequence[str], scheme: str, base: str) -> str:
    """One sentence: the ratio, whether it meets the target, and the limit where it does not."""
    found = [compare(points, problem, scheme, base) for problem in problems]
    known = {one.problem: one.time for one in found if one.time is not None}
    told = base if base == PAPER else f"scene '{base}'"
    done, total = finished(points, base, problems)
    who = f" Paper scheme: {told}; {done} of its {total} runs finish."
    if len(known) < len(found):
        missing = ", ".join(problem for problem in problems if problem not in known)
        elsewhere = ", ".join(f"{problem} {time.median:.2f}" for problem, time in known.items())
        return (
            f"{scheme}: no ratio to the paper scheme's run time on {missing}, where one of the two does not reach "
            f"{REACHED}{f' (elsewhere {elsewhere})' if elsewhere else ''}.{who}"
        )
    median, low, high = (statistics.geometric_mean(part) for part in zip(*known.values(), strict=True))
    medians = [time.median for time in known.values()]
    spread = f"{min(medians):.2f} to {max(medians):.2f} by programme" if len(medians) > 1 else f"{problems[0]} alone"
    text = (
        f"{scheme} reaches {REACHED} in {median:.2f} of the paper scheme's run time ({spread}; quartiles of the repeats "
        f"{low:.2f} to {high:.2f}; target at most {WANTED_RATIO:g}): {'met' if median <= WANTED_RATIO else 'missed'}.{who}"
    )
    limits = [f"{one.problem} {one.limit:.2f}" for one in found
              if known[one.problem].median > WANTED_RATIO and one.limit is not None]  # fmt: skip
    if limits:
        text += (
            f" Where the ratio is above {WANTED_RATIO:g}, two calls an increment, the least that Newton can do, would "
            f"still leave the ratio of calls at: {', '.join(limits)}."
        )
    return text
