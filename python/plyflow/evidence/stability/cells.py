"""What the stability matrix is made of: checks, their cells with a verdict, and the tasks that fill them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

WHOLE = "all"
"""Column of a cell that does not belong to one material and temperature."""
Detail = float | int | str


class Verdict(StrEnum):
    """How a cell ended."""

    HOLDS = "holds"
    REFUSED = "refused with message"
    FAILS = "fails"


@dataclass(frozen=True)
class Outcome:
    """Result of one cell: verdict, measured number (None if there is none), reason, further numbers."""

    verdict: Verdict
    measured: float | None
    reason: str
    details: Mapping[str, Detail] = field(default_factory=dict)


@dataclass(frozen=True)
class Check:
    """One row of the matrix.

    Parameters
    ----------
    group, name : title of the block of rows; what is claimed.
    measures : what the measured number is, with its unit.
    bound : number the measured one must not exceed.
    at_least : the measured number must reach the bound instead.
    may_refuse : the state may have no answer; elsewhere a refusal is a failure.
    claim : what must hold over the whole matrix that rests on this row.
    """

    group: str
    name: str
    measures: str
    bound: float
    at_least: bool = False
    may_refuse: bool = False
    claim: str = ""

    def admits(self, measured: float) -> bool:
        """Whether a number keeps the bound; what is not a number does not."""
        return measured >= self.bound if self.at_least else measured <= self.bound

    def judge(self, measured: float, reason: str = "", /, **details: Detail) -> Outcome:
        """Compare with the bound; what is not a number fails."""
        if self.admits(measured):
            return Outcome(Verdict.HOLDS, float(measured), reason, details)
        miss = f"{self.measures}: {measured:.3g} is {'below' if self.at_least else 'above'} {self.bound:.3g}"
        return Outcome(Verdict.FAILS, float(measured), f"{miss}; {reason}" if reason else miss, details)

    def refuse(self, message: str, measured: float | None = None, /, **details: Detail) -> Outcome:
        """Record a refusal: with a message, only where there may be no answer, what was measured before within its bound."""
        text = " ".join(message.split())
        if not text:
            return Outcome(Verdict.FAILS, measured, "refused without a message", details)
        if not self.may_refuse:
            return Outcome(Verdict.FAILS, measured, f"refused where there is an answer: {text}", details)
        if measured is not None and not self.admits(measured):
            return self.judge(measured, text, **details)
        return Outcome(Verdict.REFUSED, measured, text, details)

    def fail(self, reason: str, measured: float | None = None, /, **details: Detail) -> Outcome:
        """Record a failure that no number describes."""
        return Outcome(Verdict.FAILS, measured, reason, details)


@dataclass(frozen=True)
class Cell:
    """One finished cell: its row, its column (material and temperature, or `WHOLE`) and its outcome."""

    check: Check
    column: str
    outcome: Outcome

    def as_dict(self) -> dict[str, object]:
        """Plain data, ready for JSON; the bound with its direction."""
        check, outcome = self.check, self.outcome
        return {
            "group": check.group,
            "check": check.name,
            "column": self.column,
            "verdict": str(outcome.verdict),
            "measures": check.measures,
            "measured": outcome.measured,
            "bound": check.bound,
            "bound_is": "at least" if check.at_least else "at most",
            "reason": outcome.reason,
            "details": dict(outcome.details),
        }


@dataclass(frozen=True)
class Task:
    """A cell still to be filled."""

    check: Check
    column: str
    run: Callable[[], Outcome]


@dataclass(frozen=True)
class Finding:
    """A claim beside what was measured: worst number, its bound, where, and the verdict counts."""

    statement: str
    holds: bool
    worst: Cell | None
    counts: Mapping[Verdict, int]


def find(claims: Sequence[str], cells: Sequence[Cell]) -> list[Finding]:
    """Hold claims against the cells that they rest on."""
    findings = []
    for statement in claims:
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
