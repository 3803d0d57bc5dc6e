"""The audit as data: one row a relation, from the printed page to the machine code."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import mpmath as mp

from plyflow.audit.consequence import Consequences
from plyflow.audit.machine import TOLERANCE, BlockResult, compare_scene
from plyflow.case.assumptions import default_assumptions
from plyflow.umat.prepare import prepare_umat
from plyflow.umat.scenes import find_scene
from umataudit import Entry, Finding, Judged, Verdict, audit_relations
from umataudit.printed.relation import FORMULA, NUMBER, REFERENCE, WORDS
from umataudit.render import value_text

_SHOWN_DIGITS, _MOST_COORDINATES = 30, 12
_SORTS = {FORMULA: "in formulas", NUMBER: "in numbers", WORDS: "in words", REFERENCE: "in cross-references"}
MEANT = (
    "A misprint is said of the page: it does not fit the paper's own definitions, equations or tables. It is not said of the "
    "model or of the results, which need not have been computed with the printed form. Where the recovered text is doubtful, "
    "a note says so."
)


@dataclass(frozen=True)
class Line:
    """A formula with what is said of it; `formula` is text that can be typeset, or ""."""

    said: str
    formula: str = ""


@dataclass(frozen=True)
class Row:
    """One relation as the report shows it; every field is text.

    `sort` is what is printed there (formula, number, words, reference), `note` what to know before the page is blamed.
    """

    id: str
    place: str
    says: str
    sort: str
    verdict: str
    reason: str
    note: str
    left: str
    readings: list[Line]
    derived: str
    faults: list[Line]
    premises: list[str]
    steps: list[Line]
    checks: list[Line]
    witness: list[str]
    units: str
    consequence: str
    chain: list[Line]

    @property
    def printed(self) -> str:
        """The first reading as an equation in plain text."""
        right = self.readings[0].formula if self.readings else "in words"
        return f"{self.left} = {right}" if self.left else right

    @property
    def finding(self) -> str:
        """The outcome in one line."""
        if self.verdict != Verdict.MISPRINT.value:
            return self.reason
        said = f"{self.says}: " if self.sort in {WORDS, REFERENCE} else ""
        return f"{said}should be {self.derived or 'the derived form'}"

    @property
    def outcome(self) -> str:
        """The verdict, for a misprint with what is misprinted."""
        return f"{self.verdict} ({self.sort})" if self.verdict == Verdict.MISPRINT.value else self.verdict

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        shown = (
            "id", "place", "says", "sort", "verdict", "reason", "note", "premises", "witness", "units", "consequence",
        )  # fmt: skip
        result: dict[str, Any] = {name: getattr(self, name) for name in shown}
        result["printed"] = self.printed
        result["derived"] = f"{self.left} = {self.derived}" if self.derived and self.left else self.derived
        for name in ("readings", "faults", "steps", "checks", "chain"):
            result[name] = [{"said": line.said, "formula": line.formula} for line in getattr(self, name)]
        return result


@dataclass(frozen=True)
class Audit:
    """The whole audit."""

    rows: list[Row]
    blocks: list[BlockResult]
    stated: str
    made_with: dict[str, str] = field(default_factory=dict)

    def entries(self) -> list[dict[str, Any]]:
        """Plain data for JSON: one entry a relation, each with what it was made with."""
        return [row.as_dict() | {"made_with": {**self.made_with, "reference": self.stated}} for row in self.rows]

    @property
    def counts(self) -> dict[str, int]:
        """Number of relations by verdict, in a fixed order."""
        found = Counter(row.verdict for row in self.rows)
        return {verdict.value: found[verdict.value] for verdict in Verdict}

    @property
    def misprints(self) -> str:
        """How many misprints are formulas, numbers, words or cross-references, in words."""
        found = Counter(row.sort for row in self.rows if row.verdict == Verdict.MISPRINT.value)
        return ", ".join(f"{found[sort]} {name}" for sort, name in _SORTS.items() if found[sort])

    @property
    def agrees(self) -> bool:
        """Whether all machine code agrees with the registered equations, and these with the audited ones."""
        return all(block.agrees for block in self.blocks) and not any(
            line.said.startswith("DIFFERS") for row in self.rows for line in row.chain
        )


def run_audit(scene_name: str = "default", seen: Callable[[str], None] = lambda what: None) -> Audit:
    """Audit the paper and the compiled code of a scene.

    Parameters
    ----------
    scene_name : a shipped scene, or a file NAME.toml.
    seen : called with the name of each part that is done: "compiled blocks", then each relation.

    Raises
    ------
    InputError
        Unknown scene, or one whose blocks have no registered equations.
    ToolError
        The compiler is missing or refuses the source.
    """
    blocks = compare_scene(find_scene(scene_name))
    umat = prepare_umat(scene_name)
    seen("compiled blocks")
    consequences = Consequences()
    rows = []
    for entry in audit_relations(umat.manifest["blocks"], seen=seen):
        rows.append(_row(entry, blocks, consequences))
    made = umat.provenance
    made_with = {
        "plyflow": made.plyflow_version,
        "generator": made.generator_version,
        "scene": scene_name,
        "compiler": f"{made.compiler}, {made.compiler_flags}",
        "source sha256": made.source_sha256,
        "assumptions": "; ".join(_assumed()),
    }
    return Audit(rows, blocks, consequences.stated, made_with)


def _assumed() -> list[str]:
    """The declared assumptions with value and unit."""
    return [entry.equation for entry in default_assumptions().values()]


def _row(entry: Entry, blocks: list[BlockResult], consequences: Consequences) -> Row:
    finding, relation = entry.finding, entry.finding.relation
    shown = finding.passing or finding.first
    return Row(
        id=relation.id,
        place=relation.place,
        says=relation.says,
        sort=relation.sort,
        verdict=finding.verdict.value,
        reason=finding.reason,
        note=relation.note,
        left=relation.left,
        readings=[Line(r.name, r.formula.text) for r in relation.readings],
        derived=_derived(finding, shown),
        faults=[Line(f"{name} should be", value_text(wanted)) for name, _, wanted in finding.faults],
        premises=list(shown.derivation.premises),
        steps=[Line(step.text, value_text(step.value)) for step in shown.derivation.steps],
        checks=_checks(finding),
        witness=_witness(shown),
        units=finding.units,
        consequence=consequences.text(entry.effect),
        chain=_chain(entry, blocks),
    )


def _derived(finding: Finding, shown: Judged) -> str:
    """The derived right-hand side: of the reading that holds, else from the paper's own premises."""
    derivation = shown.derivation
    return derivation.shown.text if derivation.shown is not None else value_text(derivation.result)


def _checks(finding: Finding) -> list[Line]:
    """What was compared in every reading, and what is left of the difference."""
    lines = []
    for judged in finding.judged:
        for check in judged.checks:
            where = f"{judged.reading.name}, {check.label}: "
            if check.identity is None:
                lines.append(Line(where + check.malformed))
            elif check.holds:
                lines.append(Line(where + "printed - derived reduces to 0"))
            else:
                difference = value_text(check.identity.difference)
                lines.append(Line(where + "printed - derived is not 0" + (":" if difference else ""), difference))
    return lines


def _witness(shown: Judged) -> list[str]:
    """The first witness point of the most telling check: failing if there is one."""
    identities = [check.identity for check in shown.checks if check.identity is not None]
    if not identities:
        return []
    identity = next((i for i in identities if not i.holds), identities[0])
    witness = identity.witnesses[0]
    point = ", ".join(f"{name} = {mp.nstr(mp.mpf(value.p) / value.q, 8)}" for name, value in _short(witness.point))
    lines = [f"at {point}"] if point else []
    if len(witness.point) > _MOST_COORDINATES:
        lines = [f"at a random admissible point of {len(witness.point)} coordinates"]
    with mp.workdps(_SHOWN_DIGITS + 10):
        lines += [
            f"printed {mp.nstr(witness.printed, _SHOWN_DIGITS)}",
            f"derived {mp.nstr(witness.derived, _SHOWN_DIGITS)}",
        ]
    return [*lines, f"largest relative difference at 3 points {mp.nstr(identity.largest, 3)}"]


def _short(point: dict[Any, Any]) -> list[tuple[str, Any]]:
    """The coordinates in alphabetical order, none when there are too many to read."""
    ordered = sorted(((value_text(symbol), value) for symbol, value in point.items()), key=lambda pair: pair[0])
    return ordered if len(ordered) <= _MOST_COORDINATES else []


def _chain(entry: Entry, blocks: list[BlockResult]) -> list[Line]:
    """Printed -> derived -> registered in the model -> emitted -> compiled."""
    by_name = {block.name: block for block in blocks}
    lines = [Line(f"printed -> derived: {entry.finding.verdict.value}")]
    for link in entry.registered:
        said = "derived = registered" if link.identity.holds else "DIFFERS: derived and registered"
        lines.append(Line(f"{said}: {link.name}"))
    if not entry.blocks:
        lines.append(Line("not emitted: no block computes it, and no emitted relation rests on it"))
    for block in entry.blocks:
        compiled = by_name.get(block.name)
        through = f" (through {block.through})" if block.through else ""
        if compiled is None:
            lines.append(Line(f"emitted: block {block.name}{through}; not called in this scene"))
            continue
        agreement = "agree" if compiled.difference <= TOLERANCE else "DIFFER"
        lines.append(
            Line(
                f"emitted: block {block.name}{through}; compiled: {compiled.calls} states, largest relative "
                f"difference {compiled.difference:.1e} ({agreement})"
            )
        )
    return lines
