"""Derivations: premises, steps and what is to be compared, kept as data; one registered function for each relation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import sympy as sp

from umataudit.printed.formula import Formula, Value
from umataudit.printed.relation import Book, Reading, Relation
from umataudit.printed.tables import COLUMNS, TABLE_4, TABLES, Column


class Defined(str):
    """A premise that says what a letter means, or repeats the page: what follows from such alone is a tautology."""


@dataclass(frozen=True)
class Step:
    """One step: what is done, and what comes out (None when it is said in words)."""

    text: str
    value: Value | None = None


@dataclass(frozen=True)
class Comparison:
    """A printed and a derived value that must be equal; `label` says of what."""

    label: str
    printed: Value
    derived: Value


@dataclass(frozen=True)
class Derivation:
    """What follows from the stated premises.

    Parameters
    ----------
    premises : what is taken as given.
    steps : how the result is reached.
    comparisons : printed against derived; all equal means that the reading follows.
    result : the derived right-hand side, None when the premises do not determine it.
    shown : the result as a formula for people, when `result` is a tensor; checked against `result`.
    parts : names of the printed factors (or terms) and what each should be, to locate a fault.
    uses : ids of relations that are premises.
    taken_from : ids of relations from which a premise was read back because the paper does not give it.
    proviso : what has to be taken as read even when all comparisons hold.
    missing : why there is no result.
    """

    premises: tuple[str, ...]
    steps: tuple[Step, ...]
    comparisons: tuple[Comparison, ...]
    result: Value | None = None
    shown: Formula | None = None
    parts: Mapping[str, sp.Expr] = field(default_factory=dict)
    uses: tuple[str, ...] = ()
    proviso: str = ""
    missing: str = ""
    taken_from: tuple[str, ...] = ()


@dataclass(frozen=True)
class Printed:
    """What a derivation may look at: the relation, the reading in question, the book and the tables; `reads` notes what it did."""

    relation: Relation
    reading: Reading
    book: Book
    reads: set[str] = field(default_factory=set, compare=False)

    @property
    def value(self) -> Value:
        """Right-hand side of the reading."""
        return self.reading.formula.value

    @property
    def under(self) -> str:
        """Key of the premise that the reading takes."""
        return self.reading.under

    def of(self, relation_id: str) -> Value:
        """Right-hand side of another relation, in its last reading (the one with all characters restored)."""
        return self.look_up(relation_id).readings[-1].formula.value

    def look_up(self, relation_id: str) -> Relation:
        """Another relation."""
        self.reads.add(relation_id)
        return self.book[relation_id]

    @property
    def columns(self) -> tuple[Column, ...]:
        """Tables 2 and 3."""
        self.reads.add(TABLES[0])
        return COLUMNS

    @property
    def table_4(self) -> dict[str, sp.Rational]:
        """Table 4."""
        self.reads.add(TABLES[1])
        return {name: sp.Rational(text) for name, text in TABLE_4.items()}


Deriver = Callable[[Printed], Derivation]
_DERIVERS: dict[str, Deriver] = {}


class UnknownRelationError(KeyError):
    """There is no derivation for a relation."""


def derives(*relation_ids: str) -> Callable[[Deriver], Deriver]:
    """Decorator: the function derives these relations."""

    def add(function: Deriver) -> Deriver:
        _DERIVERS.update(dict.fromkeys(relation_ids, function))
        return function

    return add


def derivation_of(printed: Printed) -> Derivation:
    """Derivation of a reading.

    Raises
    ------
    UnknownRelationError
        Names the relation and where to add a derivation.
    """
    relation_id = printed.relation.id
    if relation_id not in _DERIVERS:
        raise UnknownRelationError(
            f"no derivation for relation '{relation_id}'; register one with @derives('{relation_id}')"
        )
    return _DERIVERS[relation_id](printed)


def equals(
    printed: Printed,
    result: Value,
    premises: tuple[str, ...],
    steps: tuple[Step, ...],
    uses: tuple[str, ...] = (),
    shown: str = "",
    parts: Mapping[str, sp.Expr] | None = None,
    also: tuple[Comparison, ...] = (),
    proviso: str = "",
    missing: str = "",
    taken_from: tuple[str, ...] = (),
) -> Derivation:
    """The usual derivation: the printed right-hand side must equal the derived one, and `also` what else is compared."""
    comparisons = (Comparison("right-hand side", printed.value, result), *also)
    formula = Formula(shown) if shown else None
    return Derivation(premises, steps, comparisons, result, formula, parts or {}, uses, proviso, missing, taken_from)
