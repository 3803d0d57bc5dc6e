"""The audit in a terminal: one table of relations, one of compiled blocks."""

from __future__ import annotations

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from plyflow.audit.report import MEANT, Audit, Row

STYLES = {
    "follows": "green",
    "follows under a stated reading": "cyan",
    "misprint": "bold red",
    "cannot be evaluated": "yellow",
}
_LONGEST = 220


def show(audit: Audit, console: Console) -> None:
    """Print the audit."""
    console.print(_relations(audit))
    console.print(audit.stated, highlight=False, markup=False)
    console.print(_blocks(audit))
    console.print(", ".join(f"{count} {verdict}" for verdict, count in audit.counts.items()), highlight=False)
    console.print(f"Misprints: {audit.misprints}. {MEANT}", highlight=False, markup=False)


def _relations(audit: Audit) -> Table:
    table = Table(title="Printed against derived", box=box.SIMPLE_HEAD, padding=(0, 1), expand=True)
    table.add_column("relation", max_width=18)
    table.add_column("verdict", max_width=13)
    table.add_column("finding and consequence", ratio=1, overflow="fold")
    for row in audit.rows:
        where = Text.assemble((row.id, "bold"), "\n", (row.place.removeprefix("section "), "dim"))
        table.add_row(where, Text(row.outcome, STYLES[row.verdict]), _outcome(row))
    return table


def _outcome(row: Row) -> Text:
    """Finding, and for what does not follow its consequence."""
    text = Text(_cut(row.finding))
    if row.verdict != "follows":
        text.append(("\n" if row.finding else "") + row.consequence, "dim")
    if row.note:
        text.append(f"\nnote: {row.note}", "italic")
    return text


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST else text[: _LONGEST - 4].rsplit(" ", 1)[0] + " ..."


def _blocks(audit: Audit) -> Table:
    table = Table(title="Machine code against registered equations", box=box.SIMPLE_HEAD)
    for heading in ("block", "equation", "states", "largest relative difference", "in", ""):
        table.add_column(heading, justify="right" if heading in {"states", "largest relative difference"} else "left")
    for block in audit.blocks:
        verdict = Text("agrees", "green") if block.agrees else Text("DIFFERS", "bold red")
        table.add_row(block.name, block.equation, str(block.calls), f"{block.difference:.1e}", block.output, verdict)
    return table
