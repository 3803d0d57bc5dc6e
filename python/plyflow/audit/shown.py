"""The audit as tables in a terminal and as one page with typeset mathematics."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import fill

from markupsafe import Markup
from rich.console import Console

from plyflow.audit.cell import cell
from plyflow.audit.report import MEANT, Audit, Line, Row
from plyflow.show.page import Block, Card, Details, Formula, Items, Note, Page, Section
from plyflow.show.table import Cell, Column, Table
from umataudit import Verdict
from umataudit.domain import PREMISES, holds_in, places
from umataudit.render import mathml, plain, typeset

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
    "<b>Follows</b>: the difference reduces to zero. <b>Follows under a stated reading</b>: it does when a premise is read as "
    "stated. <b>Definition</b>: it says what a letter means, <b>tautology</b>: it rests on such alone, or on numbers that the page "
    "repeats; neither tests the law, so they are counted apart. <b>Fault that may be the scan's</b>: it follows when characters are "
    "read in a way in which the recovered text is wrong elsewhere too. <b>Misprint</b>: it does not follow from the paper's own "
    "definitions; the corrected form is given. <b>Claim that does not hold</b>: a sentence that the equations or tables contradict. "
    "<b>Cannot be evaluated</b>: no value, nothing it could follow from, or only premises that come from itself."
)
_RESTS = (
    "A row rests on the columns that it has a mark in: a full dot where their formula or numbers enter, a ring where a premise names "
    "them, a turning arrow where a premise leads back to the row itself. An alteration of two entries at once is seen in one of them, "
    "unless such an arrow joins them, or the row does nothing but repeat a table."
)
_MACHINE = Markup(
    "Each emitted block is called by itself at random admissible states and compared with its registered equations in 30 "
    "digits; <i>umat</i> is the whole routine as shipped, its DDSDDE against the differentiated stress."
)
_STYLE = (
    "#rests td, #rests th { padding: .1rem 0; text-align: center; } #rests td:first-child { padding-right: .3rem; text-align: left; } "
    "#rests table { font-size: .72rem; width: auto; } #rests .wide { max-height: none; } "
    "#rests th span { writing-mode: vertical-rl; font-weight: 400; line-height: 1.4; } "
    "@media (max-width: 40rem) { #rests table { font-size: .4rem; } #rests th span { line-height: 1; } } "
    "@media print { #show { display: none; } #rests table { font-size: .5rem; } #rests th span { line-height: 1.2; } } "
    "label { margin-right: .8rem; white-space: nowrap; }"
)


def show(audit: Audit, console: Console) -> None:
    """Print the audit: one table of relations, one of compiled blocks."""
    columns: list[Column | str] = ["relation", "verdict", Column("finding and consequence", wrap=True)]
    asked = [[plain(a.question), _answer(a.holds), plain(a.answer)] for a in audit.answers]
    console.print(Table(columns, map(_summary, audit.rows), "Printed against derived").rich())
    console.print(plain(audit.stated), highlight=False, markup=False)
    console.print(Table([Column("question", wrap=True), "", Column("computed", wrap=True)], asked, "What an auditor asks next").rich())
    console.print(_blocks(audit, "Machine code against registered equations").rich())
    console.print(f"{audit.summary} {MEANT}", highlight=False, markup=False)


def _summary(row: Row) -> list[Cell]:
    """Id with place, verdict, and the finding with its consequence (of what does not follow) and note."""
    said = plain(row.finding)
    finding = said if len(said) <= _LONGEST else said[: _LONGEST - 4].rsplit(" ", 1)[0] + " ..."
    below = [row.consequence if row.verdict not in HOLDS else "", f"note: {row.note}" if row.note else ""]
    return [
        Cell(row.id, "strong", small=fill(row.place.removeprefix("section "), 18)),
        Cell(fill(row.outcome, 13), TONES[row.verdict]),
        Cell(finding, small=plain("\n".join(filter(None, below)))),
    ]


def _answer(holds: bool) -> Cell:
    return Cell("yes" if holds else "no", "good" if holds else "warn")


def _blocks(audit: Audit, title: str = "") -> Table:
    agree = {True: ("agrees", "good"), False: ("DIFFERS", "bad")}
    columns: list[Column | str] = ["block", Column("states", "d"), Column("largest relative difference", ".1e"), ""]
    rows = [
        [Cell(b.name, small=b.equation), b.calls, b.difference, Cell(*agree[b.agrees], small=b.output)]
        for b in audit.blocks
    ]  # fmt: skip
    return Table(columns, rows, title)


def page(audit: Audit) -> Page:
    """The audit as a page."""
    cards = [Card(count, verdict.value, TONES[verdict]) for verdict, count in audit.counts.items()]
    worst = max(block.difference for block in audit.blocks)
    said = "largest relative difference of machine code and registered equations"
    cards.append(Card(f"{worst:.1e}", said if audit.agrees else f"{said}: DIFFERS", "" if audit.agrees else "bad"))
    numbered = list(enumerate(audit.rows, 1))
    links = [Markup('<a href="#r{}">{}</a>').format(n, row.id) for n, row in numbered if row.verdict is Verdict.MISPRINT]
    overview = [
        [Cell(row.id, TONES[row.verdict], link=f"#r{n}"), Cell(typeset(row.says), small=f"{row.place}: {row.outcome}")]
        for n, row in numbered
    ]  # fmt: skip
    asked = [[_answer(a.holds), Cell(typeset(a.question), small=typeset(a.answer))] for a in audit.answers]
    blocks: list[Block] = [
        Note(f"{audit.summary} {MEANT}", "info"), _VERDICTS, Markup("To the misprints: ") + Markup(" ").join(links),
        typeset(audit.stated),
        Section("Overview", [Table(["no.", Column("what it states", wrap=True)], overview)]),
        Section("What an auditor asks next", [Table(["", Column("question and what was computed", wrap=True)], asked)]),
        Section("Domain of validity", list(_domain(audit))),
        Section("Which entry rests on which", [_RESTS, _matrix(audit)], anchor="rests"),
        Section("Machine code", [_MACHINE, _blocks(audit)]),
        Section("Relation by relation", [_filter(audit), *(_entry(n, row) for n, row in numbered)]),
    ]  # fmt: skip
    title = "The paper audited: printed, derived, emitted, compiled"
    return Page(title, _LEAD, blocks, cards, provenance=audit.made_with)


def _domain(audit: Audit) -> Iterator[Block]:
    """What the registered equations take for granted, the states in which it is met, and how the emitted law goes beyond."""
    premises = [
        [", ".join(row.id for row in audit.rows if row.holds_in and row.premise == key), Cell(typeset(said), small=_states(key))]
        for key, said in PREMISES.items()
    ]  # fmt: skip
    yield Table([Column("equation", wrap=True), Column("taken for granted, and the states in which it is met", wrap=True)], premises)
    numbers = [Column(name, ".3g") for name in ("emitted", "Eq. 13", "Eq. 14", "norm")]
    rows = [
        [typeset(p.state), *("none" if v is None else round(float(v), 6) for v in (p.emitted, p.squeeze, p.bleed, p.norm))]
        for p in places()
    ]  # fmt: skip
    title = "Compaction strain as emitted and by the invariants of Eqs. 13 and 14; their norm over the transverse one"
    yield Table([Column("state", wrap=True), *numbers], rows, title)
    yield "Beyond that the emitted law goes further than the printed one:"
    yield Items([typeset(f"{what}. Why: {why}. What it comes to: {number}.") for what, why, number in audit.extensions])


def _states(premise: str) -> Markup:
    met = holds_in(premise)
    return typeset("every state" if len(met) == len(places()) else "; ".join(met))


def _matrix(audit: Audit) -> Table:
    """Rows: relations that rest on others; columns: what they rest on."""
    used = list(dict.fromkeys(name for row in audit.rows for name in row.rests_on))
    used.sort(key=[*(row.id for row in audit.rows), *used].index)
    rows_by_id = {row.id: row for row in audit.rows}

    def reached(name: str, seen: frozenset[str] = frozenset()) -> frozenset[str]:
        for other in rows_by_id[name].rests_on if name in rows_by_id else ():
            seen = seen if other in seen else reached(other, seen | {other})
        return seen

    def mark(row: Row, name: str) -> Cell:
        if name not in row.rests_on:
            return Cell("")
        back = name == row.id or row.id in reached(name) or (name in rows_by_id and rows_by_id[name].circular)
        return Cell("\u21ba", "warn") if row.circular and back else Cell("\u25cf" if name in row.reads else "\u25cb")

    rows = [
        [Cell(row.id, link=f"#r{n}"), *(mark(row, name) for name in used)] for n, row in enumerate(audit.rows, 1) if row.rests_on
    ]  # fmt: skip
    return Table(["", *(Column(Markup("<span>{}</span>").format(name)) for name in used)], rows)


def _filter(audit: Audit) -> Markup:
    """Radio buttons for the verdicts; a style sheet alone hides the other entries."""
    rules, buttons = [], ['<label><input type="radio" name="verdict" checked> all</label>']
    for number, (verdict, count) in enumerate(audit.counts.items()):
        others = ", ".join(f"#r{n}" for n, row in enumerate(audit.rows, 1) if row.verdict is not verdict)
        rules.append(f"body:has(#v{number}:checked) :is({others}) {{ display: none; }}")
        buttons.append(f'<label><input type="radio" name="verdict" id="v{number}"> {verdict.value} ({count})</label>')
    style = f"@media screen {{ {' '.join(rules)} }} {_STYLE}"
    return Markup(f'<style>{style}</style><span id="show">Show: {" ".join(buttons)}</span>')


def _entry(number: int, row: Row) -> Section:
    chip = (row.outcome, TONES[row.verdict])
    return Section(row.id, [*_printed(row), *_found(row), _details(row)], anchor=f"r{number}", chip=chip)


def _printed(row: Row) -> Iterator[Block]:
    """Place, what it states, and the readings."""
    yield Note(row.place)
    yield typeset(row.says)
    for n, reading in enumerate(row.readings):
        yield Note(typeset(f"reading: {reading.said}" if n else reading.said))
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
        yield typeset(f"{'Why' if cannot else 'Reading'}: {row.reason}")
    if row.note:
        yield Note(typeset(f"Note: {row.note}."))
    if not follows:
        yield Note(Markup("<b>Consequence:</b> ") + typeset(row.consequence), "warn")
    if row.id == "A.1":
        yield cell()
    if row.numbers:
        yield Table([Column(typeset(name)) for name in row.numbers[0]], row.numbers[1:])
    yield Items([typeset(line.said) for line in row.chain])


def _details(row: Row) -> Details:
    parts: dict[str, tuple[Sequence[str], bool]] = {
        "premises": ([typeset(premise) for premise in row.premises], False),
        "steps": ([_typeset(line) for line in row.steps], True),
        "comparison": ([_typeset(line) for line in row.checks], False),
        "witness": ([typeset(line) for line in row.witness], False),
        "units of the printed form": ([typeset(row.units)] if row.units else [], False),
    }
    blocks: list[Block] = []
    for name, (lines, ordered) in parts.items():
        blocks += [Note(name), Items(lines, ordered)] if lines else []
    return Details("Derivation, comparison and witness", blocks)


def _typeset(line: Line) -> Markup:
    """A sentence with its formula behind it."""
    between = Markup(" " if line.said.endswith((":", "=", " is", " gives", " be")) else ": ")
    return typeset(line.said) + (between + mathml("", line.formula) if line.formula else "")
