"""Audit of a book of relations: findings, their link to the model and to the emitted blocks, and what they would do."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from umataudit.effect import Effect, effect
from umataudit.printed.relation import PAPER, Book
from umataudit.registered import Registered, registered
from umataudit.verdict import Finding, judge

_CARRIED = {
    "17-push": "17", "17-C'": "17", "13-I1s": "4.3", "T4.G23": "Table 4", "4.4-rule": "4.4", "10-I3": "4.3", "4.3-I1": "4.3",
    "4.3-J2": "4.2",
}  # fmt: skip
"""What a block says that it carries, for relations that have no number of their own; the others go by their id."""


@dataclass(frozen=True)
class BlockLink:
    """An emitted block that holds a relation; `through` names the relation by which it enters, "" when directly."""

    name: str
    through: str = ""


@dataclass(frozen=True)
class Entry:
    """One relation, audited."""

    finding: Finding
    effect: Effect
    registered: tuple[Registered, ...]
    blocks: tuple[BlockLink, ...]


def equation_ids(equation: str) -> list[str]:
    """Ids in what a block or a stage says that it carries ("13, 15"; semicolons too)."""
    return [part.strip() for part in re.split("[,;]", equation) if part.strip()]


def audit_relations(
    blocks: Iterable[Mapping[str, Any]], book: Book = PAPER, seen: Callable[[str], None] = lambda relation_id: None
) -> list[Entry]:
    """Judge every relation of a book and link it to the emitted blocks.

    Parameters
    ----------
    blocks : the manifest's blocks, each with name and equation.
    book : relations; the paper's by default.
    seen : called with the id of each relation once it is judged.
    """
    findings: dict[str, Finding] = {}
    for relation_id, relation in book.items():
        findings[relation_id] = judge(relation, book)
        seen(relation_id)
    by_equation: dict[str, list[str]] = {}
    for block in blocks:
        for equation in equation_ids(str(block["equation"])):
            by_equation.setdefault(equation, []).append(str(block["name"]))
    return [
        Entry(f, effect(f), tuple(registered(f)), tuple(_links(relation_id, findings, by_equation)))
        for relation_id, f in findings.items()
    ]


def _links(relation_id: str, findings: Mapping[str, Finding], by_equation: Mapping[str, list[str]]) -> list[BlockLink]:
    """Blocks that carry the relation, else those of the relations it is a premise of, nearest first."""
    seen, level = {relation_id}, {relation_id: ""}
    while level:
        found = {
            name: BlockLink(name, through)
            for current, through in level.items()
            for name in by_equation.get(_CARRIED.get(current, current), ())
        }
        if found:
            return list(found.values())
        level = {
            user: user for current in level for user, finding in findings.items()
            if user not in seen and current in finding.judged[-1].derivation.uses
        }  # fmt: skip
        seen |= set(level)
    return []
