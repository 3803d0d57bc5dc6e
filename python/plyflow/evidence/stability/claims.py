"""What must hold over the whole matrix, and what was found."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from plyflow.evidence.stability.cells import Cell, Verdict
from plyflow.evidence.stability.matrix import CLAIMS


@dataclass(frozen=True)
class Finding:
    """A claim beside what was measured: worst number, its bound, where, and the verdict counts."""

    statement: str
    holds: bool
    worst: Cell | None
    counts: Mapping[Verdict, int]


def find(cells: Sequence[Cell]) -> list[Finding]:
    """Hold every claim, in their order, against the cells that it rests on."""
    findings = []
    for statement in CLAIMS:
        own = [cell for cell in cells if cell.check.claim == statement]
        counts = {verdict: sum(cell.outcome.verdict is verdict for cell in own) for verdict in Verdict}
        findings.append(Finding(statement, bool(own) and not counts[Verdict.FAILS], worst_cell(own), counts))
    return findings


def worst_cell(cells: Sequence[Cell]) -> Cell | None:
    """Cell whose number is farthest towards or over its bound; a failing one without a number comes first."""
    for cell in cells:
        if cell.outcome.verdict is Verdict.FAILS and cell.outcome.measured is None:
            return cell
    return max((cell for cell in cells if cell.outcome.measured is not None), key=_badness, default=None)


def _badness(cell: Cell) -> float:
    value, check = float(cell.outcome.measured or 0.0), cell.check
    if math.isnan(value):
        return float("inf")
    if check.at_least:
        return check.bound - value
    return value / check.bound if check.bound > 0.0 else value
