"""The audit as tables in a terminal and as one page with typeset mathematics."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import fill

from markupsafe import Markup
from rich.console import Console

from plyflow.audit.report import MEANT, Audit, Line, Row
from plyflow.show.page import Block, Card, Details, Formula, Items, Note, Page, Section
from plyflow.show.table import Cell, Column, Table
from umataudit import Verdict
from umataudit.domain import BEYOND, places, shear_share
from umataudit.render import mathml, typeset, value_text

TONES = {
    Verdict.FOLLOWS: "good", Verdict.READING: "info", Verdict.DEFINITION: "soft", Verdict.TAUTOLOGY: "soft", Verdict.SCAN: "info",
    Verdict.MISPRINT: "bad", Verdict.CLAIM: "bad", Verdict.CANNOT: "warn",
}  # fmt: skip
HOLDS = {Verdict.FOLLOWS, Verdict.DEFINITION, Verdict.TAUTOLOGY}
_LONGEST = 220
_LEAD = (
    "Belnoue, Nixon-Pearson, Ivanov, Hallett, Mechanics of Materials (2016). Each relation as printed is compared with what "
    "follows from its stated premises. A verdict is the outcome of a symbolic identity, with a witness of 30 digits at random "
    "admissible points. The paper puts compaction on axis 1 and the fibre on axis 3; the code puts the fibre on axis 1."
)
_VERDICTS = Markup(
    "<b>follows</b>: the difference reduces to zero. <b>Follows under a stated reading</b>: it does when a premise is read as "
    "stated. <b>Definition</b>: it says what a letter means, <b>tautology</b>: it rests on such alone; neither could fail, so they "
    "are counted apart. <b>Fault that may be the scan's</b>: it follows when characters are read in a way in which the recovered "
    "text is wrong elsewhere too. <b>Misprint</b>: it does not follow from the paper's own definitions; the corrected form is "
    "given. <b>Claim that does not hold</b>: a sentence that the equations or tables contradict. <b>Cannot be evaluated</b>: no "
    "value, nothing it could follow from, or only premises that come from itself."
)
_RESTS = (
    "A row uses the columns that it has a mark in; a turning arrow marks a premise that leads back to the row itself. An alteration "
    "of two formulas at once is seen in one of them, unless they are joined by such an arrow."
)
_MACHINE = Markup(
    "Each emitted block is called by itself at random admissible states and compared with its registered equations in 30 "
    "digits; <i>umat</i> is the whole routine as shipped, its DDSDDE against the differentiated stress."
)


def show(audit: Audit, console: Console) -> None:
    """Print the audit: one table of relations, one of compiled blocks."""
    columns: list[Column | str] = ["relation", "verdict", Column("finding and consequence", wrap=True)]
    console.print(Table(columns, map(_summary, audit.rows), "Printed against derived").rich())
    console.print(audit.stated, highlight=False, markup=False)
    console.print(_asked(audit, "What an auditor asks next").rich())
    console.print(_blocks(audit, "Machine code against registered equations").rich())
    console.print(f"{audit.summary} {MEANT}", highlight=False, markup=False)


def _summary(row: Row) -> list[Cell]:
    """Id with place, verdict, and the finding with its consequence (of what does not follow) and note."""
    finding = row.finding if len(row.finding) <= _LONGEST else row.finding[: _LONGEST - 4].rsplit(" ", 1)[0] + " ..."
    below = [row.consequence if row.verdict not in HOLDS else "", f"note: {row.note}" if row.note else ""]
    return [
        Cell(row.id, "strong", small=fill(row.place.removeprefix("section "), 18)),
        Cell(fill(row.outcome, 13), TONES[row.verdict]),
        Cell(finding, small="\n".join(filter(None, below))),
    ]


def _blocks(audit: Audit, title: str = "") -> Table:
    agree = {True: Cell("agrees", "good"), False: Cell("DIFFERS", "bad")}
    numbers = [Column("states", "d"), Column("largest relative difference", ".1e")]
    columns: list[Column | str] = ["block", "equation", *numbers, "in", ""]
    rows = [[b.name, b.equation, b.calls, b.difference, b.output, agree[b.agrees]] for b in audit.blocks]
    return Table(columns, rows, title)


def page(audit: Audit) -> Page:
    """The audit as a page."""
    cards = [Card(count, verdict.value, TONES[verdict]) for verdict, count in audit.counts.items()]
    worst = max(block.difference for block in audit.blocks)
    said = "largest relative difference of machine code and registered equations"
    cards.append(Card(f"{worst:.1e}", said if audit.agrees else f"{said}: DIFFERS", "" if audit.agrees else "bad"))
    links = [
        Markup('<a href="#r{}">{}</a>').format(n, row.id)
        for n, row in enumerate(audit.rows, 1) if row.verdict is Verdict.MISPRINT
    ]  # fmt: skip
    overview = [
        [Cell(row.id, link=f"#r{n}"), row.place, Markup(typeset(row.says)), Cell(row.outcome, TONES[row.verdict])]
        for n, row in enumerate(audit.rows, 1)
    ]
    columns = [Column("no."), Column("where", wrap=True), Column("states", wrap=True), Column("verdict")]
    blocks: list[Block] = [
        _VERDICTS, f"{audit.summary} {MEANT}", Markup("To the misprints: ") + Markup(" ").join(links), audit.stated,
        Section("Overview", [Table(columns, overview)]),
        Section("What an auditor asks next", [_asked(audit)]),
        Section("Domain of validity", list(_domain(audit))),
        Section("Which entry rests on which", [_RESTS, _matrix(audit)]),
        Section("Machine code", [_MACHINE, _blocks(audit)]),
        Section("Relation by relation", [_filter(audit), *(_entry(n, row) for n, row in enumerate(audit.rows, 1))]),
    ]  # fmt: skip
    title = "The paper audited: printed, derived, emitted, compiled"
    return Page(title, _LEAD, blocks, cards, provenance=audit.made_with)


def _asked(audit: Audit, title: str = "") -> Table:
    rows = [[a.question, Cell("yes" if a.holds else "no", "good" if a.holds else "warn"), a.answer] for a in audit.answers]
    return Table([Column("question", wrap=True), "", Column("computed", wrap=True)], rows, title)


def _domain(audit: Audit) -> Iterator[Block]:
    """Strains in each state, and the states of each registered equation."""
    numbers = [Column(name, ".4f") for name in ("emitted", "printed, squeezing", "printed, bleeding", "norm printed over emitted")]
    rows = [[p.state, p.emitted, *("not real" if v is None else v for v in (p.squeeze, p.bleed)), p.norm] for p in places()]
    yield Markup(typeset(f"Where the printed invariants differ, {BEYOND}."))
    yield Table([Column("state", wrap=True), *numbers], rows, "Compaction strain: emitted, and by the printed invariants")
    held = [[row.id, row.printed_in or "any", "every state" if len(row.holds_in) == len(places()) else "; ".join(row.holds_in)]
            for row in audit.rows if row.holds_in]  # fmt: skip
    yield Table(["registered", "printed in", Column("holds as printed for", wrap=True)], held)
    yield Items([
        Markup("A shear rate meets {} of the stress that goes with the fibre term: eta_ply and the norm of a compaction, for want of "
               "a law of shear.").format(Markup(mathml("", value_text(shear_share()), block=False))),
        "After the lock nothing but viscosity holds the width: no constraint is left, and a load that pulls the edges widens the ply.",
    ])  # fmt: skip


def _matrix(audit: Audit) -> Table:
    """Rows: relations that rest on others; columns: what they rest on. A dot uses, a ring leads back to the row itself."""
    used = [row for row in audit.rows if any(row.id in other.rests_on for other in audit.rows)]
    marks = {False: Cell("\u25cf"), True: Cell("\u21ba", "warn")}
    rows = [
        [Cell(row.id, link=f"#r{n}"), *(marks[row.circular] if other.id in row.rests_on else "" for other in used)]
        for n, row in enumerate(audit.rows, 1) if row.rests_on
    ]  # fmt: skip
    return Table(["", *(row.id for row in used)], rows)


def _filter(audit: Audit) -> Markup:
    """Radio buttons for the verdicts; a style sheet alone hides the other entries."""
    rules, buttons = [], ['<label><input type="radio" name="verdict" checked> all</label>']
    for number, (verdict, count) in enumerate(audit.counts.items()):
        others = ", ".join(f"#r{n}" for n, row in enumerate(audit.rows, 1) if row.verdict is not verdict)
        rules.append(f"body:has(#v{number}:checked) :is({others}) {{ display: none; }}")
        buttons.append(f'<label><input type="radio" name="verdict" id="v{number}"> {verdict.value} ({count})</label>')
    style = "@media screen { " + " ".join(rules) + " } label { margin-right: .8rem; white-space: nowrap; }"
    return Markup(f"<style>{style}</style>Show: {' '.join(buttons)}")


def _entry(number: int, row: Row) -> Section:
    chip = (row.outcome, TONES[row.verdict])
    return Section(row.id, [*_printed(row), *_found(row), _details(row)], anchor=f"r{number}", chip=chip)


def _printed(row: Row) -> Iterator[Block]:
    """Place, what it states, and the readings."""
    yield Note(row.place)
    yield Markup(typeset(row.says))
    for n, reading in enumerate(row.readings):
        yield Note(Markup(typeset(f"reading: {reading.said}" if n else reading.said)))
        if n == 0 or reading.formula != row.readings[0].formula:
            yield Formula(mathml(row.left, reading.formula))


def _found(row: Row) -> Iterator[Block]:
    """The derived form, what is wrong, why, and with what consequence."""
    follows, cannot = row.verdict in HOLDS, row.verdict is Verdict.CANNOT
    if row.derived and not follows:
        yield Note("corrected" if row.verdict in {Verdict.MISPRINT, Verdict.CLAIM} else "derived")
        yield Formula(mathml(row.left, row.derived))
    yield from map(_typeset, row.faults)
    if row.reason and (cannot or row.reason not in [reading.said for reading in row.readings]):
        yield Markup(typeset(f"{'Why' if cannot else 'Reading'}: {row.reason}"))
    if row.note:
        yield Note(Markup(typeset(f"Note: {row.note}.")))
    if not follows:
        yield Note(Markup("<b>Consequence:</b> ") + Markup(typeset(row.consequence)), "warn")
    yield Items([line.said for line in row.chain])


def _details(row: Row) -> Details:
    parts: dict[str, tuple[Sequence[str], bool]] = {
        "premises": ([Markup(typeset(premise)) for premise in row.premises], False),
        "steps": ([_typeset(line) for line in row.steps], True),
        "comparison": ([_typeset(line) for line in row.checks], False),
        "witness": (row.witness, False),
        "units of the printed form": ([row.units] if row.units else [], False),
    }
    blocks: list[Block] = []
    for name, (lines, ordered) in parts.items():
        blocks += [Note(name), Items(lines, ordered)] if lines else []
    return Details("Derivation, comparison and witness", blocks)


def _typeset(line: Line) -> Markup:
    """A sentence with its formula behind it."""
    return Markup(typeset(line.said)) + Markup(f" {mathml('', line.formula, block=False)}" if line.formula else "")
