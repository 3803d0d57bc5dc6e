"""Verdicts, computed: a relation is judged by what its readings' comparisons come to."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from functools import cache

import sympy as sp

from umataudit.derive.derivation import Defined, Derivation, Printed, derivation_of
from umataudit.identity import Identity, compare
from umataudit.printed.formula import Formula, Value
from umataudit.printed.relation import Book, Reading, Relation, attested
from umataudit.printed.tensors import IndexNotationError
from umataudit.printed.units import CONSISTENT, check_units


class ShownError(ValueError):
    """A result is shown as a formula that it does not equal."""


class Verdict(Enum):
    """What an audit can say of a relation."""

    FOLLOWS = "follows"
    READING = "follows under a stated reading"
    DEFINITION = "definition"
    TAUTOLOGY = "tautology"
    SCAN = "fault that may be the scan's"
    MISPRINT = "misprint"
    CLAIM = "claim that does not hold"
    CANNOT = "cannot be evaluated"


@dataclass(frozen=True)
class Check:
    """One comparison and what came out; `malformed` says why the printed form has no value."""

    label: str
    identity: Identity | None
    malformed: str = ""

    @property
    def holds(self) -> bool:
        """Whether printed and derived are equal."""
        return self.identity is not None and self.identity.holds


@dataclass(frozen=True)
class Judged:
    """One reading with its derivation and checks, and the relations and tables that its derivation read."""

    reading: Reading
    derivation: Derivation
    checks: tuple[Check, ...]
    reads: frozenset[str] = frozenset()

    def check_shown(self) -> None:
        """Compare the formula in which a result is shown with the result.

        Raises
        ------
        ShownError
            When they differ: the formula is not what was derived.
        """
        shown, result = self.derivation.shown, self.derivation.result
        result = result.as_immutable() if isinstance(result, sp.MatrixBase) else result
        if shown is not None and not _shown_holds(shown, result):
            raise ShownError(f"shown as '{shown.text}', which is not the derived result; correct the formula")

    @property
    def holds(self) -> bool:
        """Whether every check holds (and there is one)."""
        return bool(self.checks) and all(check.holds for check in self.checks)

    @property
    def real(self) -> bool:
        """Whether the printed form has real values at the witness points."""
        return all(check.identity is None or check.identity.real for check in self.checks)

    @property
    def faults(self) -> tuple[tuple[str, Value, Value], ...]:
        """The printed factors or terms that differ: (name, printed, derived), where the derivation names them."""
        expected, formula = self.derivation.parts, self.reading.formula
        for found in (formula.factors(), formula.terms()) if expected else ():
            if len(found) == len(expected):
                pairs = zip(expected.items(), found, strict=True)
                differing = ((n, part, want) for (n, want), part in pairs if not compare(part, want, f"part/{n}").holds)
                return tuple(differing)
        return ()


@cache
def _shown_holds(shown: Formula, result: Value) -> bool:
    return compare(shown.value, result, f"shown/{shown.text}").holds


@dataclass(frozen=True)
class Finding:
    """A judged relation.

    Parameters
    ----------
    verdict : computed from `judged`.
    judged : every reading, in order; `first` is the page as recovered.
    faults : printed parts that differ: (name, printed, derived).
    units : what the unit check of the first reading says, "" when there is none.
    """

    relation: Relation
    verdict: Verdict
    judged: tuple[Judged, ...]
    faults: tuple[tuple[str, Value, Value], ...] = ()
    units: str = ""
    circle: str = ""

    @property
    def first(self) -> Judged:
        """The reading as recovered."""
        return self.judged[0]

    @property
    def reads(self) -> frozenset[str]:
        """Relations and tables whose formulas or numbers enter."""
        return frozenset().union(*(judged.reads for judged in self.judged))

    @property
    def passing(self) -> Judged | None:
        """The first reading that holds."""
        return next((judged for judged in self.judged if judged.holds), None)

    @property
    def shown(self) -> Judged:
        """The reading to show: the one that holds, the page as recovered where it is at fault."""
        return self.first if self.verdict in {Verdict.MISPRINT, Verdict.CLAIM} else self.passing or self.first

    @property
    def reason(self) -> str:
        """Why it cannot be evaluated, or the reading under which it follows."""
        if self.verdict is Verdict.CANNOT:
            missing = (self.passing or self.first).derivation.missing or "the printed form has no real value at admissible states"
            return f"{self.circle}; {missing}" if self.circle else missing
        if self.passing is not None and self.verdict is not Verdict.MISPRINT:
            return self.passing.reading.name if not self.first.holds else self.passing.derivation.proviso
        return ""


def judge(relation: Relation, book: Book) -> Finding:
    """Judge one relation; premises are read from `book`."""
    if not relation.readings:
        words = Reading(Formula("0"), "in words")
        return Finding(relation, Verdict.CANNOT, (Judged(words, derivation_of(Printed(relation, words, book)), ()),))
    judged = tuple(_judge_reading(Printed(relation, reading, book)) for reading in relation.readings)
    passing = next((other for other in judged if other.holds), None)
    circle = circle_of(relation, passing.derivation.taken_from, book) if passing else ""
    first, verdict = judged[0], _verdict(relation, judged, passing, circle)
    if verdict is Verdict.MISPRINT:
        first.check_shown()
    faults = first.faults if verdict is Verdict.MISPRINT else ()
    return Finding(relation, verdict, judged, faults, _units(relation, first.reading), circle)


def _verdict(relation: Relation, judged: tuple[Judged, ...], passing: Judged | None, circle: str) -> Verdict:
    """What does not hold is a misprint, or a claim in words; what holds is judged by what it takes to hold."""
    first = judged[0]
    scanned = passing is not None and passing.reading.kind == "ocr"
    if passing is None or (scanned and not all(attested(glyph, relation.id) for glyph in passing.reading.glyphs)):
        if first.derivation.result is None or (first.derivation.missing and not first.real):
            return Verdict.CANNOT
        return Verdict.CLAIM if relation.sort == "words" else Verdict.MISPRINT
    stated = passing is not first or passing.derivation.proviso
    tautology = not stated and all(isinstance(premise, Defined) for premise in passing.derivation.premises)
    classes = {
        Verdict.CANNOT: circle, Verdict.SCAN: scanned, Verdict.DEFINITION: relation.defines, Verdict.TAUTOLOGY: tautology,
        Verdict.READING: stated,
    }  # fmt: skip
    return next((verdict for verdict, applies in classes.items() if applies), Verdict.FOLLOWS)


def circle_of(relation: Relation, taken_from: tuple[str, ...], book: Book, above: tuple[str, ...] = ()) -> str:
    """How a premise that was read back leads to the relation again, or to one that is circular itself; "" when it does not."""
    for source in taken_from:
        if source == relation.id:
            return "consistent, but circular: a premise is read back from the relation itself"
        if relation.id in rests_on(source, book):
            return f"consistent with {source}, but circular: a premise is taken from {source}, which rests on {relation.id}"
        if source not in above and (inner := circle_of(book[source], edges(source, book)[1], book, (*above, relation.id))):
            return f"consistent with {source}, from which a premise is taken; {source} itself: {inner}"
    return ""


_EDGES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {}


def edges(relation_id: str, book: Book) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Ids that a relation uses, and that a premise was read back from: the same whatever the formulas."""
    if relation_id not in _EDGES:
        relation = book[relation_id]
        reading = relation.readings[-1] if relation.readings else Reading(Formula("0"), "in words")
        found = _judge_reading(Printed(relation, reading, book)).derivation
        _EDGES[relation_id] = (found.uses, found.taken_from)
    return _EDGES[relation_id]


def rests_on(relation_id: str, book: Book) -> set[str]:
    """Every relation that a relation rests on, directly or through others."""
    found: set[str] = set()
    ahead = [relation_id]
    while ahead:
        for other in sum(edges(ahead.pop(), book), ()):
            if other not in found:
                found.add(other)
                ahead.append(other)
    return found


def _judge_reading(printed: Printed) -> Judged:
    try:
        derivation = derivation_of(printed)
        checks = tuple(
            Check(c.label, compare(c.printed, c.derived, f"{printed.relation.id}/{printed.reading.name}/{c.label}"))
            for c in derivation.comparisons
        )
        said = _units(printed.relation, printed.reading)
        if said and said != CONSISTENT:
            checks = (*checks, Check("units", None, said))
    except IndexNotationError as error:
        stand_in = replace(printed.reading, formula=Formula(f"0*{printed.relation.left}"))
        derivation = derivation_of(replace(printed, reading=stand_in))
        checks = (Check("index notation", None, str(error)),)
    return Judged(printed.reading, derivation, checks, frozenset(printed.reads))


def _units(relation: Relation, reading: Reading) -> str:
    return _units_of(relation.left, reading.formula) if reading.units_count else ""


@cache
def _units_of(left: str, formula: Formula) -> str:
    return check_units(left, formula.tree)
