"""What must hold over the whole matrix, each claim with the cells that decide it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from plyflow.evidence.stability import (
    constraint,
    elasticity,
    energy,
    iterations,
    limit,
    lock,
    matrix,
    objectivity,
    order,
    programmes,
    rounding,
)
from plyflow.evidence.stability.cells import Cell, Check, Verdict


@dataclass(frozen=True)
class Claim:
    """One statement and the checks it rests on, all with the same measure."""

    statement: str
    checks: frozenset[Check]


@dataclass(frozen=True)
class Finding:
    """A claim beside what was measured: worst number, its bound, where, and the verdict counts."""

    statement: str
    holds: bool
    worst: Cell | None
    counts: Mapping[Verdict, int]


def _claim(statement: str, checks: Iterable[Check]) -> Claim:
    return Claim(statement, frozenset(checks))


CLAIMS = (
    _claim("0 NaN, 0 Inf", [matrix.ACCOUNT["not finite"]]),
    _claim("0 wrong-sided stresses", [matrix.ACCOUNT["wrong-sided"]]),
    _claim("0 uncaught failures", [matrix.ACCOUNT["uncaught"]]),
    _claim("each refused state refused with its message", [matrix.ACCOUNT["unsaid"], limit.OVERSTEPPED, limit.BEYOND]),
    _claim("dissipation never negative", [energy.DISSIPATED]),
    _claim("SSE + dissipation = external work to 1e-6", energy.BALANCED.values()),
    _claim(
        "consistent tangent: order of the last Newton steps at least 1.9",
        [check for (_, scene), check in order.CHECKS.items() if scene == "default"],
    ),
    _claim("median iterations at most 4 over the 84 cases", [iterations.MEDIAN]),
    _claim("worst iterations at most 12", [iterations.WORST]),
    _claim("no failed increments besides located events", [iterations.FAILED]),
    _claim(
        "double against quadruple at most 1e-12 where conditioned better than 1e3",
        [elasticity.RANDOM, rounding.DRAWN],
    ),
    _claim(
        "elsewhere the error is that of the input",
        [elasticity.RANDOM_ILL, *rounding.ALONG.values(), *limit.APPROACHED.values()],
    ),
    _claim(
        "stress and DDSDDE turn with a superposed rotation to 1e-12",
        [objectivity.TURNED[objectivity.BOTH], objectivity.TURNED[objectivity.END_ONLY]],
    ),
    *(
        _claim(
            f"final width = exp(-eps_lock) within 1e-3 whatever the step sizes, {scene} scene",
            [check for (name, _, _), check in programmes.CHECKS.items() if name == scene]
            + [check for name, check in lock.BACK_AND_FORTH.items() if name == scene],
        )
        for scene in programmes.SCENES
    ),
    _claim("augmented: J - 1 to 1e-8 at moderate kappa", [constraint.QUIET["augmented"]]),
)


def worst_cell(cells: Sequence[Cell]) -> Cell | None:
    """Cell whose number is farthest towards or over its bound; a failing one without a number comes first."""
    failing = [cell for cell in cells if cell.outcome.verdict is Verdict.FAILS and cell.outcome.measured is None]
    if failing:
        return failing[0]
    measured = [cell for cell in cells if cell.outcome.measured is not None]
    return max(measured, key=_badness, default=None)


def _badness(cell: Cell) -> float:
    value, check = float(cell.outcome.measured or 0.0), cell.check
    if math.isnan(value):
        return float("inf")
    if check.at_least:
        return check.bound - value
    return value / check.bound if check.bound > 0.0 else value


def find(claims: Sequence[Claim], cells: Sequence[Cell]) -> list[Finding]:
    """Hold every claim against the cells."""
    findings = []
    for claim in claims:
        own = [cell for cell in cells if cell.check in claim.checks]
        counts = {verdict: sum(cell.outcome.verdict is verdict for cell in own) for verdict in Verdict}
        holds = bool(own) and counts[Verdict.FAILS] == 0
        findings.append(Finding(claim.statement, holds, worst_cell(own), counts))
    return findings
