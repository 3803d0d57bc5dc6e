"""What the stability matrix is made of: families of checks, filled into cells with a verdict.

A family lives in one module of this folder: it makes a `Family` and enters its cells with `Family.cells`. The matrix
finds it there; nothing else has to be told.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import partial
from itertools import product
from typing import Any, NamedTuple, TypeVar

from plyflow.evidence.stability.subject import Column, Subject

WHOLE = "all"
"""Column of a cell that does not belong to one material and temperature."""
Detail = float | int | str
T = TypeVar("T")


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


class Claim(NamedTuple):
    """What must hold over the whole matrix, and its place in the list of claims."""

    place: int
    statement: str


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
    claim: Claim | None = None

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
class Entry:
    """A row with what fills it: a function, its arguments, and where and in which matrix it is filled."""

    check: Check
    fill: Callable[..., Outcome]
    how: Mapping[str, Any]
    whole: bool
    quick: bool
    few: int


@dataclass
class Family:
    """A group of rows.

    Parameters
    ----------
    title : heading of the rows.
    place : where the group stands among the others.
    by_column : fill all rows of a material and temperature before those of the next.
    """

    title: str
    place: int
    by_column: bool = False
    entries: list[Entry] = field(default_factory=list)

    def __post_init__(self) -> None:
        FAMILIES[self.title] = self

    def cells(
        self,
        name: str | Callable[..., str],
        measures: str | Callable[..., str],
        bound: float | Callable[..., float],
        *,
        at_least: bool = False,
        may_refuse: bool | Callable[..., bool] = False,
        claim: Claim | Callable[..., Claim | None] | None = None,
        whole: bool = False,
        quick: Callable[..., bool] = lambda **_: True,
        few: int = 0,
        **axes: Iterable[Any],
    ) -> Callable[[Callable[..., Outcome]], Callable[..., Outcome]]:
        """Enter rows that one function fills: one for every combination of the axes.

        The function gets the check, the subject, the column (not if `whole`) and the axes by name. Name (a format),
        measures, bound, may_refuse and claim may depend on the axes; `quick` tells which the reduced matrix has, `few`
        how many columns it takes (0: all).
        """

        def enter(fill: Callable[..., Outcome]) -> Callable[..., Outcome]:
            for values in product(*axes.values()):
                how = dict(zip(axes, values, strict=True))
                check = Check(
                    self.title,
                    _for(how, name).format(**how),
                    _for(how, measures),
                    _for(how, bound),
                    at_least,
                    _for(how, may_refuse),
                    _for(how, claim),
                )
                self.entries.append(Entry(check, fill, how, whole, quick(**how), few))
            return fill

        return enter

    def tasks(self, subject: Subject) -> Iterator[Task]:
        """List the cells in order; rows by column come before the others."""
        entries = [entry for entry in self.entries if entry.quick or not subject.quick]
        for column in subject.columns if self.by_column else ():
            yield from (_task(entry, subject, column) for entry in entries if not entry.whole and not entry.few)
        for entry in entries:
            if entry.whole:
                yield _task(entry, subject, None)
            elif entry.few or not self.by_column:
                columns = subject.few(subject.columns, entry.few or len(subject.columns))
                yield from (_task(entry, subject, column) for column in columns)


FAMILIES: dict[str, Family] = {}


def _for(how: Mapping[str, Any], value: T | Callable[..., T]) -> T:
    return value(**how) if callable(value) else value


def _task(entry: Entry, subject: Subject, column: Column | None) -> Task:
    if column is None:
        return Task(entry.check, WHOLE, partial(entry.fill, entry.check, subject, **entry.how))
    return Task(entry.check, column.label, partial(entry.fill, entry.check, subject, column, **entry.how))
