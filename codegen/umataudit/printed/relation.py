"""A printed relation as data: where it stands, what it says, and each way it can be read; the paper is the book of them."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from importlib import resources
from typing import Any

from umataudit.printed.formula import Formula


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
    glyphs : of an "ocr" reading, the confusions of characters that it takes, by their name in `glyphs.toml`.
    """

    formula: Formula
    name: str = "as printed"
    kind: str = "print"
    under: str = ""
    units_count: bool = True
    glyphs: tuple[str, ...] = ()


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
    sort : what is printed: "formula", "number", "words" (a sentence), "reference" (to an equation, table or section) or "code".
    note : what a reader should know before a fault is laid to the page, e.g. that the recovered text is doubtful.
    defines : the letter that the relation introduces, when it says what the letter means.
    effect : what the printed form would do, see `umataudit.effect.stated`.
    """

    id: str
    place: str
    left: str
    says: str
    readings: tuple[Reading, ...]
    sort: str = "formula"
    note: str = ""
    defines: str = ""
    effect: Mapping[str, Any] = field(default_factory=dict)

    def with_formula(self, index: int, text: str) -> Relation:
        """The same relation with another right-hand side in one reading."""
        changed = list(self.readings)
        changed[index] = replace(changed[index], formula=Formula(text))
        return replace(self, readings=tuple(changed))


def relation(id_: str, /, **entry: Any) -> Relation:
    """A relation from an entry of a file of this folder.

    Parameters
    ----------
    id_ : its id.
    entry : `place`, `says` and where they apply `left`, `sort`, `note`, `defines` and `effect`; `printed` is the text as recovered,
        `ocr` a list of further readings of the characters with what is read and the confusions that it takes, `meaning` the same
        characters (unless it has a `formula`) under another premise, with `name`, `under` and `units_count`.
    """
    readings = [Reading(Formula(entry.pop("printed")))] if "printed" in entry else []
    readings += [Reading(Formula(text), name, "ocr", glyphs=tuple(glyphs)) for text, name, *glyphs in entry.pop("ocr", ())]
    if "meaning" in entry:
        given = dict(entry.pop("meaning"))
        formula = Formula(given.pop("formula", "")) if "formula" in given else readings[0].formula
        readings.append(Reading(formula, kind="meaning", **given))
    return Relation(id_, entry.pop("place"), entry.pop("left", ""), entry.pop("says"), tuple(readings), **entry)


class Book(dict[str, Relation]):
    """Relations by id, in the order of the paper.

    Raises
    ------
    ValueError
        When an id is used twice.
    """

    def __init__(self, relations: Iterable[Relation]) -> None:
        super().__init__()
        for relation in relations:
            if relation.id in self:
                raise ValueError(f"relation '{relation.id}' is registered twice; give one another id")
            self[relation.id] = relation

    def with_relation(self, relation: Relation) -> Book:
        """The book with one relation replaced, or added at the end."""
        return Book((self | {relation.id: relation}).values())


def attested(glyph: str, elsewhere_than: str) -> bool:
    """Whether the recovered text confuses these characters, beyond doubt, at another place than a relation's."""
    return any(place != elsewhere_than for place, _ in GLYPHS.get(glyph, ()))


def _read(name: str) -> Iterator[Relation]:
    return (relation(id_, **entry) for id_, entry in _table(name).items())


def _table(name: str) -> dict[str, Any]:
    return tomllib.loads(resources.files("umataudit").joinpath(f"printed/{name}.toml").read_text(encoding="utf-8"))


GLYPHS: dict[str, list[tuple[str, str]]] = _table("glyphs")
PAPER = Book(entry for name in ("law", "potentials", "tangent", "table_4", "words", "witness") for entry in _read(name))
