"""What the wanted accuracy costs against what it may: processor time over the paper's, UMAT calls over bdf1's, increments."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from plyflow.evidence.bench.accuracy import TARGET, cost_at, increments, over, pick, time_ratio, umat_calls
from plyflow.evidence.bench.measure import Point
from plyflow.evidence.bench.schemes import BACKWARD, DEFAULT, PAPER, PAPER_REAL
from plyflow.evidence.bench.spread import Spread

WANTED_RATIO = 0.12  # of the paper scheme's run time
WANTED_CALLS = 0.25  # of those of the backward difference with the consistent tangent
WANTED_INCREMENTS = {"blocked": 25, "slow": 40, "cold": 25}
WIDEST = 0.2  # relative spread of a ratio over the repeats, above which there is no verdict
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
    widest = max(time.relative for time in known.values())
    if widest > WIDEST:
        return (
            f"{scheme}: no verdict on run time, its repeats spread by {100 * widest:.0f} % (at most {100 * WIDEST:.0f}): run again on "
            f"an idle machine; median {median:.2f} of the paper scheme's.{who}"
        )
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


def counted(points: Sequence[Point], problems: Sequence[str], scheme: str, plain: str) -> list[str]:
    """What does not depend on the machine: UMAT calls over those of bdf1, increments with both of Newton's kinds."""
    ratios = {problem: over(*(cost_at(pick(points, problem, one), umat_calls) for one in (scheme, BACKWARD))) for problem in problems}
    lines = [f"UMAT calls of {scheme} over those of {BACKWARD} for {REACHED}: {_against(ratios, dict.fromkeys(ratios, WANTED_CALLS))}"]
    for name in (scheme, plain):
        counts = {problem: fewest(pick(points, problem, name)) for problem in problems}
        lines.append(f"increments of {name} for {REACHED}: {_against(counts, WANTED_INCREMENTS)}")
    return lines


def fewest(points: Sequence[Point]) -> int | None:
    """Least increments of a run that reached `TARGET` in final thickness; None if none did."""
    return min((p.increments for p in points if p.errors.get("thickness", 1.0) <= TARGET), default=None)


def _against(found: Mapping[str, float | None], wanted: Mapping[str, float]) -> str:
    """Each problem's figure with its target, and whether all are met."""
    told = [f"{problem} {'not reached' if one is None else f'{one:.2g}'} (target {wanted[problem]:g})"
            for problem, one in found.items()]  # fmt: skip
    met = all(one is not None and one <= wanted[problem] for problem, one in found.items())
    return f"{', '.join(told)}: {'met' if met else 'missed'}"
