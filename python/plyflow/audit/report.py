"""The audit as data: one row a relation, from the printed page to the machine code."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import mpmath as mp

from plyflow.audit.asked import Answer, answers
from plyflow.audit.consequence import Consequences
from plyflow.audit.machine import TOLERANCE, BlockResult, compare_scene
from plyflow.case.assumptions import default_assumptions
from plyflow.umat.prepare import prepare_umat
from plyflow.umat.scenes import find_scene
from umataudit import PAPER, Entry, Finding, Judged, Verdict, audit_relations
from umataudit.domain import extensions, holds_in, premise_of
from umataudit.printed.tables import TABLES
from umataudit.render import plain, value_text

SOURCES = [*PAPER, *TABLES]
"""Whatever an entry may rest on, in the order of the paper."""
_SHOWN_DIGITS, _MOST_COORDINATES = 30, 12
_SORTS = {"formula": "in formulas", "number": "in numbers", "reference": "in cross-references"}
_PLURALS = {
    Verdict.FOLLOWS: "follow", Verdict.READING: "follow under a stated reading", Verdict.DEFINITION: "are definitions",
    Verdict.TAUTOLOGY: "are tautologies", Verdict.SCAN: "have a fault that may be the scan's", Verdict.MISPRINT: "are misprints",
    Verdict.CLAIM: "are claims that do not hold", Verdict.CANNOT: "cannot be evaluated",
}  # fmt: skip
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
    """One relation as the report shows it.

    `sort` is what is printed there (formula, number, words, reference), `note` what to know before the page is blamed; `numbers`
    a table of the consequence; `rests_on` the relations and tables used, `reads` those whose formula or numbers enter, `circular`
    whether they lead back; `premise` and `holds_in`, of a registered equation, what it takes for granted of the state and the states
    for which that is met.
    """

    id: str
    place: str
    says: str
    sort: str
    verdict: Verdict
    reason: str
    note: str
    premises: list[str]
    witness: list[str]
    units: str
    consequence: str
    left: str
    derived: str
    readings: list[Line]
    faults: list[Line]
    steps: list[Line]
    checks: list[Line]
    chain: list[Line]
    rests_on: list[str]
    reads: list[str]
    circular: bool
    premise: str
    holds_in: list[str]
    numbers: list[list[str]]

    @property
    def finding(self) -> str:
        """The outcome in one line."""
        if self.verdict not in {Verdict.MISPRINT, Verdict.CLAIM}:
            return self.reason
        said = f"{self.says}: " if self.sort in {"words", "reference"} else ""
        return f"{said}should be {self.derived or 'the derived form'}"

    @property
    def outcome(self) -> str:
        """The verdict, for a misprint with what is misprinted."""
        return self.verdict.value + (f" ({self.sort})" if self.verdict is Verdict.MISPRINT else "")

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        left = f"{self.left} = " if self.left else ""
        texts = {name: _plain(value) for name, value in vars(self).items() if name not in {"left", "derived", "verdict"}}
        equations = {
            "printed": left + (self.readings[0].formula if self.readings else "in words"),
            "derived": self.derived and left + self.derived,
        }
        return texts | {"verdict": self.verdict.value} | equations


def _plain(value: Any) -> Any:
    """Data without the marks of formulas in prose."""
    if isinstance(value, Line):
        return {"said": plain(value.said), "formula": value.formula}
    if isinstance(value, list):
        return [_plain(part) for part in value]
    return plain(value) if isinstance(value, str) else value


@dataclass(frozen=True)
class Audit:
    """The whole audit."""

    rows: list[Row]
    blocks: list[BlockResult]
    stated: str
    answers: list[Answer] = field(default_factory=list)
    extensions: list[tuple[str, str, str]] = field(default_factory=list)
    made_with: dict[str, str] = field(default_factory=dict)

    def entries(self) -> list[dict[str, Any]]:
        """Plain data for JSON: one entry a relation, each with what it was made with."""
        return [row.as_dict() | {"made_with": {**self.made_with, "reference": plain(self.stated)}} for row in self.rows]

    @property
    def counts(self) -> dict[Verdict, int]:
        """Number of relations by verdict, in a fixed order."""
        found = Counter(row.verdict for row in self.rows)
        return {verdict: found[verdict] for verdict in Verdict}

    @property
    def misprints(self) -> str:
        """How many misprints are formulas, numbers or cross-references, in words."""
        found = Counter(row.sort for row in self.rows if row.verdict is Verdict.MISPRINT)
        return ", ".join(f"{found[sort]} {name}" for sort, name in _SORTS.items() if found[sort])

    @property
    def summary(self) -> str:
        """The counts by class in one sentence, to be quoted."""
        said = [f"{count} {_PLURALS[verdict]}" for verdict, count in self.counts.items()]
        said[list(Verdict).index(Verdict.MISPRINT)] += f" ({self.misprints})"
        return f"Of {len(self.rows)} relations {', '.join(said[:-1])} and {said[-1]}."

    @property
    def agrees(self) -> bool:
        """Whether all machine code agrees with the registered equations, and these with the audited ones."""
        said = (line.said for row in self.rows for line in row.chain)
        return all(block.agrees for block in self.blocks) and not any(text.startswith("DIFFERS") for text in said)


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
    rows = [_row(entry, blocks, consequences) for entry in audit_relations(umat.manifest["blocks"], seen=seen)]
    made, assumed = umat.provenance, default_assumptions().values()
    made_with = {
        "plyflow": made.plyflow_version,
        "generator": made.generator_version,
        "scene": scene_name,
        "compiler": f"{made.compiler}, {made.compiler_flags}",
        "source sha256": made.source_sha256,
        "assumptions": "; ".join(entry.equation for entry in assumed),
    }
    law, held = consequences.reference.law, umat.manifest["scene"].get("after_lock") == "held"
    beyond = extensions(law.w0, law.h0, law.eps_lock, consequences.derived.strain, held)
    return Audit(rows, blocks, consequences.stated, answers(consequences.reference), beyond, made_with)


def _row(entry: Entry, blocks: list[BlockResult], consequences: Consequences) -> Row:
    finding, relation = entry.finding, entry.finding.relation
    shown = finding.shown
    derivation = shown.derivation
    premise = premise_of(entry) if entry.registered else ""
    return Row(
        relation.id, relation.place, relation.says, relation.sort, finding.verdict, finding.reason, relation.note,
        premises=list(derivation.premises),
        witness=_witness(shown),
        units=finding.units,
        consequence=consequences.text(entry.effect),
        left=relation.left,
        derived=derivation.shown.text if derivation.shown is not None else value_text(derivation.result),
        readings=[Line(r.name, r.formula.text) for r in relation.readings],
        faults=[Line(f"{name} should be", value_text(wanted)) for name, _, wanted in finding.faults],
        steps=[Line(step.text, value_text(step.value)) for step in derivation.steps],
        checks=_checks(finding),
        chain=_chain(entry, blocks),
        rests_on=sorted({*derivation.uses, *derivation.taken_from, *finding.reads}, key=SOURCES.index),
        reads=sorted(finding.reads, key=SOURCES.index),
        circular=bool(finding.circle),
        premise=premise,
        holds_in=list(holds_in(premise)) if entry.registered else [],
        numbers=[list(line) for line in entry.effect.table],
    )  # fmt: skip


def _checks(finding: Finding) -> list[Line]:
    """What was compared in every reading, and what is left of the difference."""
    lines = []
    for where, check in ((f"{j.reading.name}, {check.label}: ", check) for j in finding.judged for check in j.checks):
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
    point = sorted((value_text(name), mp.nstr(mp.mpf(value.p) / value.q, 8)) for name, value in witness.point.items())
    lines = ["at " + ", ".join(f"${name} = {value}$" for name, value in point)] if point else []
    if len(point) > _MOST_COORDINATES:
        lines = [f"at a random admissible point of {len(point)} coordinates"]
    with mp.workdps(_SHOWN_DIGITS + 10):
        lines += [f"{name} {mp.nstr(getattr(witness, name), _SHOWN_DIGITS).replace('j)', ' i)')}" for name in ("printed", "derived")]
    return [*lines, f"largest relative difference at 3 points {mp.nstr(identity.largest, 3)}"]


def _chain(entry: Entry, blocks: list[BlockResult]) -> list[Line]:
    """Printed -> derived -> registered in the model -> emitted -> compiled."""
    by_name = {block.name: block for block in blocks}
    said = [f"printed -> derived: {entry.finding.verdict.value}"]
    for link in entry.registered:
        said.append(f"{'derived = registered' if link.identity.holds else 'DIFFERS: derived and registered'}: `{link.name}`")
    if not entry.blocks:
        said.append("not emitted: no block computes it, and no emitted relation rests on it")
    for block in entry.blocks:
        compiled = by_name.get(block.name)
        outcome = "not called in this scene"
        if compiled is not None:
            agreement = "agree" if compiled.difference <= TOLERANCE else "DIFFER"
            outcome = (
                f"compiled: {compiled.calls} states, largest relative difference {compiled.difference:.1e} ({agreement})"
            )
        said.append(f"emitted: block {block.name}{f' (through {block.through})' if block.through else ''}; {outcome}")
    return list(map(Line, said))
