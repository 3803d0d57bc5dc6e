"""A printed relation as data: where it stands, what it says, and each way it can be read."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from umataudit.printed.formula import Formula

PRINT, OCR, MEANING = "print", "ocr", "meaning"
FORMULA, NUMBER, WORDS, REFERENCE = "formula", "number", "words", "reference"


@dataclass(frozen=True)
class Reading:
    """One way to read a relation.

    Parameters
    ----------
    formula : right-hand side.
    name : "as printed", or what is read differently, one line.
    kind : "print" (the text as recovered), "ocr" (another reading of the characters) or "meaning" (the same characters
        under another meaning of a letter or premise).
    under : key that tells the derivation which premise to take; "" for the paper's own.
    units_count : whether the units of both sides have to fit.
    """

    formula: Formula
    name: str = "as printed"
    kind: str = PRINT
    under: str = ""
    units_count: bool = True


@dataclass(frozen=True)
class Relation:
    """A relation of the paper.

    Parameters
    ----------
    id : number in the paper, with a suffix for unnumbered relations ("13", "13-J2", "T1.1", "A.1").
    place : where it stands.
    left : left-hand side, as a formula; "" for a statement in words.
    says : what it states, one line.
    readings : at least one, the first as recovered from the page; none when it is printed in words only.
    sort : what is printed: "formula", "number", "words" (a sentence) or "reference" (to an equation, table or section).
    note : what a reader should know before a fault is laid to the page, e.g. that the recovered text is doubtful.
    """

    id: str
    place: str
    left: str
    says: str
    readings: tuple[Reading, ...]
    sort: str = FORMULA
    note: str = ""

    def with_formula(self, index: int, text: str) -> Relation:
        """The same relation with another right-hand side in one reading."""
        changed = list(self.readings)
        changed[index] = replace(changed[index], formula=Formula(text))
        return replace(self, readings=tuple(changed))


class Book(Mapping[str, Relation]):
    """Relations by id, in the order of the paper.

    Raises
    ------
    ValueError
        When an id is used twice.
    """

    def __init__(self, relations: Iterable[Relation]) -> None:
        self._by_id: dict[str, Relation] = {}
        for relation in relations:
            if relation.id in self._by_id:
                raise ValueError(f"relation '{relation.id}' is registered twice; give one another id")
            self._by_id[relation.id] = relation

    def __getitem__(self, key: str) -> Relation:
        return self._by_id[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_id)

    def __len__(self) -> int:
        return len(self._by_id)

    def with_relation(self, relation: Relation) -> Book:
        """The book with one relation replaced, or added at the end."""
        return Book((self._by_id | {relation.id: relation}).values())


def printed(formula: str) -> Reading:
    """The reading of the page as recovered."""
    return Reading(Formula(formula))


def ocr(formula: str, name: str) -> Reading:
    """Another reading of doubtful characters."""
    return Reading(Formula(formula), name, OCR)


def meaning(formula: str, under: str, name: str, units_count: bool = True) -> Reading:
    """The same characters under another meaning; `under` selects the premise in the derivation."""
    return Reading(Formula(formula), name, MEANING, under, units_count)


def relation(
    id_: str, place: str, left: str, says: str, *readings: Reading, sort: str = FORMULA, note: str = ""
) -> Relation:
    """A relation with any number of readings."""
    return Relation(id_, place, left, says, readings, sort, note)
