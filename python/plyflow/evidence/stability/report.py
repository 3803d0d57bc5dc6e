"""The matrix as JSON, as one page, and as tables for the terminal."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from plyflow.evidence.stability.cells import WHOLE, Cell, Check, Verdict, worst_cell
from plyflow.evidence.stability.matrix import Matrix
from plyflow.show.page import Block, Card, Details, Items, Page, Section
from plyflow.show.table import Cell as Shown
from plyflow.show.table import Column, Table

NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?|[-+]?Inf(?:inity)?|NaN", re.IGNORECASE)
TONES = {Verdict.HOLDS: "good", Verdict.REFUSED: "warn", Verdict.FAILS: "bad"}
LEAD = (
    "Every cell is one check on one material and temperature [degC]: its worst measured number, green where it holds, "
    "yellow where the state has no answer and was refused with a message, red where it fails. The reasons of "
    "refusals stand below each table. Numbers are those of this run."
)


@dataclass(frozen=True)
class Row:
    """One row of a table: its check, its cells by column, the worst of them."""

    check: Check
    cells: Mapping[str, Cell]
    worst: Cell | None

    @property
    def remark(self) -> str:
        """A reason (of a failing cell, else of a refused one, else of the worst) and further numbers of the worst cell."""
        told = [
            f"{cell.column}: {cell.outcome.reason}" if cell.column != WHOLE else cell.outcome.reason
            for verdict in (Verdict.FAILS, Verdict.REFUSED)
            for cell in self.cells.values()
            if cell.outcome.verdict is verdict
        ]
        shown = self.worst or next(iter(self.cells.values()))
        numbers = ", ".join(
            f"{name.replace('_', ' ')} {value if isinstance(value, str) else number(value)}"
            for name, value in shown.outcome.details.items()
        )
        return "; ".join(part for part in ((told or [shown.outcome.reason])[0], numbers) if part)


def rows_by_group(matrix: Matrix) -> dict[str, list[Row]]:
    """Rows of every group, in order."""
    by_check: dict[Check, dict[str, Cell]] = {}
    for cell in matrix.cells:
        by_check.setdefault(cell.check, {})[cell.column] = cell
    groups: dict[str, list[Row]] = {}
    for check, cells in by_check.items():
        groups.setdefault(check.group, []).append(Row(check, cells, worst_cell(list(cells.values()))))
    return groups


def to_json(matrix: Matrix) -> str:
    """Every cell, the claims, the account and the provenance; not-a-number is written as null."""
    ledger = matrix.ledger
    content = {
        "summary": {str(verdict): matrix.count(verdict) for verdict in Verdict} | {"seconds": matrix.seconds},
        "claims": [
            {
                "claim": finding.statement,
                "holds": finding.holds,
                "measured": finding.worst.outcome.measured if finding.worst else None,
                "bound": finding.worst.check.bound if finding.worst else None,
                "where": finding.worst.column if finding.worst else None,
                "cells": {str(verdict): count for verdict, count in finding.counts.items()},
            }
            for finding in matrix.findings
        ],
        "account": {
            "calls": ledger.calls,
            "increments": ledger.increments,
            "refusals": ledger.refusals,
            "incidents": ledger.incidents,
        },
        "cells": [cell.as_dict() for cell in matrix.cells],
        "provenance": dict(matrix.provenance),
    }
    finite = json.loads(json.dumps(content), parse_constant=lambda _: None)
    return json.dumps(finite, indent=1) + "\n"


def number(value: float | None) -> str:
    """A measured number in few characters."""
    if value is None or not math.isfinite(value):
        return "" if value is None else f"{value}"
    if (value == round(value) and abs(value) < 1e7) or 1e3 <= abs(value) < 1e4:
        return f"{value:.0f}"
    return f"{value:.3g}" if 0.01 <= abs(value) < 1e4 else f"{value:.1e}".replace("e-0", "e-").replace("e+0", "e")


def bound(check: Check) -> str:
    """The bound with its direction."""
    return f"{'≥' if check.at_least else '≤'} {number(check.bound)}"


def messages(rows: Sequence[Row], verdict: Verdict) -> list[str]:
    """Distinct reasons of the cells with a verdict (equal but for their numbers), each with how often it came."""
    found: dict[str, list[str]] = {}
    for row in rows:
        for cell in row.cells.values():
            if cell.outcome.verdict is verdict:
                found.setdefault(NUMBER.sub("#", cell.outcome.reason), []).append(cell.outcome.reason)
    return [f"{len(same)} cell{'s' if len(same) > 1 else ''}: {same[0]}" for same in found.values()]


def failures(matrix: Matrix) -> list[str]:
    """Messages of the failing cells, each with its group."""
    groups = rows_by_group(matrix)
    return [f"{group}, {text}" for group, rows in groups.items() for text in messages(rows, Verdict.FAILS)]


def claims_table(matrix: Matrix) -> Table:
    """What must hold, and what was found."""
    columns = (Column("claim", wrap=True), Column("worst", align="right"), Column("bound", align="right"), "where", "")
    rows = []
    for finding in matrix.findings:
        worst = finding.worst
        place = (number(worst.outcome.measured), bound(worst.check), worst.column) if worst else ("", "", "")
        rows.append((finding.statement, *place, Shown("holds", "good") if finding.holds else Shown("fails", "bad")))
    return Table(columns, rows)


def groups_table(matrix: Matrix) -> Table:
    """How the cells of every group ended."""
    columns = [Column(str(verdict).removesuffix(" with message"), "d") for verdict in Verdict]
    rows = []
    for group in rows_by_group(matrix):
        ends = [cell.outcome.verdict for cell in matrix.cells if cell.check.group == group]
        rows.append((group, *(ends.count(verdict) for verdict in Verdict)))
    return Table((Column("group", wrap=True), *columns), rows)


def to_html(matrix: Matrix) -> str:
    """One page without scripts or outside references."""
    places = [column for column in dict.fromkeys(cell.column for cell in matrix.cells) if column != WHOLE]
    groups, failing, ledger = rows_by_group(matrix), failures(matrix), matrix.ledger
    looked_at = f"answers looked at: {ledger.calls} calls, {ledger.increments} increments of the driver"
    incidents = "incidents: NaN, Inf, wrong-sided stress, silent refusal, uncaught failure"
    return Page(
        "Stability of the UMAT and its driver",
        LEAD,
        [
            Section("Must hold", [claims_table(matrix)]),
            *([Section("Cells that fail", [Items(failing)])] if failing else []),
            *(Section(group, _group_blocks(rows, places)) for group, rows in groups.items()),
        ],
        cards=[
            *(Card(matrix.count(verdict), f"cells: {verdict}", TONES[verdict]) for verdict in Verdict),
            Card(ledger.calls + ledger.increments, looked_at),
            Card(ledger.total, incidents),
        ],
        provenance={**matrix.provenance, "time": f"{matrix.seconds:.0f} s"},
    ).html()


def _group_blocks(rows: Sequence[Row], places: Sequence[str]) -> list[Block]:
    by_column = any(WHOLE not in row.cells for row in rows)
    columns = [Column("check", wrap=True), Column("bound", align="right")]
    if by_column:
        parts = (place.rsplit(" ", 1) for place in places)
        columns += [Column(temperature, align="right", over=material) for material, temperature in parts]
    else:
        columns += [Column("measured", align="right"), Column("verdict and reason", wrap=True)]
    blocks: list[Block] = [Table(columns, [_shown(row, places if by_column else ()) for row in rows])]
    refusals = messages(rows, Verdict.REFUSED) if by_column else []
    numbers = [
        f"{row.check.name}{f' ({row.worst.column})' if row.worst else ''}: {row.remark}"
        for row in rows
        if row.remark and WHOLE not in row.cells
    ]
    for summary, lines in (
        (f"Messages of refusal ({len(refusals)})", refusals),
        ("Further numbers, at the worst cell of each row", numbers),
    ):
        blocks += [Details(summary, [Items(lines)])] if lines else []
    return blocks


def _shown(row: Row, places: Sequence[str]) -> list[Shown | str]:
    head: list[Shown | str] = [Shown(row.check.name, small=row.check.measures), bound(row.check)]
    if WHOLE in row.cells:
        outcome = row.cells[WHOLE].outcome
        tone, measured = TONES[outcome.verdict], number(outcome.measured)
        if places:
            return [*head, Shown("; ".join(filter(None, (measured, row.remark))), tone, span=len(places))]
        return [*head, Shown(measured, tone), "; ".join(filter(None, (str(outcome.verdict), row.remark)))]
    cells = [row.cells[place].outcome if place in row.cells else None for place in places]
    return head + [Shown(number(one.measured), TONES[one.verdict]) if one else "" for one in cells]
