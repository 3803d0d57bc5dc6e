"""The matrix as JSON, Markdown, one HTML file, and a table for the terminal."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

import jinja2
from rich import box
from rich.table import Table

from plyflow.evidence.stability.cells import WHOLE, Cell, Check, Verdict
from plyflow.evidence.stability.claims import CLAIMS, Finding, find, worst_cell
from plyflow.evidence.stability.matrix import Matrix

NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?|[-+]?Inf(?:inity)?|NaN", re.IGNORECASE)


@dataclass(frozen=True)
class Row:
    """One row of a table: its check, its cells by column, the worst of them."""

    check: Check
    cells: Mapping[str, Cell]
    worst: Cell | None

    @property
    def whole(self) -> bool:
        """Whether the row is one cell that belongs to no material."""
        return WHOLE in self.cells

    def count(self, verdict: Verdict) -> int:
        """Cells of the row with a verdict."""
        return sum(cell.outcome.verdict is verdict for cell in self.cells.values())

    @property
    def verdict(self) -> Verdict:
        """Worst verdict of the row."""
        for verdict in (Verdict.FAILS, Verdict.REFUSED):
            if self.count(verdict):
                return verdict
        return Verdict.HOLDS

    @property
    def reason(self) -> str:
        """Why: the reason of a failing cell, else a message of refusal, else what the worst cell adds."""
        for verdict in (Verdict.FAILS, Verdict.REFUSED):
            for cell in self.cells.values():
                if cell.outcome.verdict is verdict:
                    return f"{cell.column}: {cell.outcome.reason}" if cell.column != WHOLE else cell.outcome.reason
        return self.worst.outcome.reason if self.worst else ""

    @property
    def remark(self) -> str:
        """The reason, and the further numbers of the worst cell."""
        numbers = ", ".join(f"{name} {value}" for name, value in details(self))
        return "; ".join(part for part in (self.reason, numbers) if part)


def rows_by_group(matrix: Matrix) -> dict[str, list[Row]]:
    """Rows of every group, in order."""
    groups: dict[str, list[Row]] = {}
    for check in dict.fromkeys(cell.check for cell in matrix.cells):
        cells = [cell for cell in matrix.cells if cell.check == check]
        row = Row(check, {cell.column: cell for cell in cells}, worst_cell(cells))
        groups.setdefault(check.group, []).append(row)
    return groups


def to_json(matrix: Matrix) -> str:
    """Every cell, the claims, the account and the provenance; not-a-number is written as null."""
    content = {
        "summary": {str(verdict): matrix.count(verdict) for verdict in Verdict} | {"seconds": matrix.seconds},
        "claims": [_finding_data(finding) for finding in find(CLAIMS, matrix.cells)],
        "account": {
            "calls": matrix.ledger.calls,
            "increments": matrix.ledger.increments,
            "refusals": matrix.ledger.refusals,
            "incidents": matrix.ledger.incidents,
        },
        "cells": [cell.as_dict() for cell in matrix.cells],
        "provenance": dict(matrix.provenance),
    }
    return json.dumps(_finite(content), indent=1, allow_nan=False) + "\n"


def _finding_data(finding: Finding) -> dict[str, Any]:
    worst = finding.worst
    return {
        "claim": finding.statement,
        "holds": finding.holds,
        "measured": worst.outcome.measured if worst else None,
        "bound": worst.check.bound if worst else None,
        "where": worst.column if worst else None,
        "cells": {str(verdict): count for verdict, count in finding.counts.items()},
    }


def _finite(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, Mapping):
        return {str(key): _finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    return value


def number(value: float | None) -> str:
    """A measured number in few characters."""
    if value is None:
        return ""
    if value == round(value) and abs(value) < 1e7:
        return f"{value:.0f}"
    if 1e3 <= abs(value) < 1e4:
        return f"{value:.0f}"
    return f"{value:.3g}" if 0.01 <= abs(value) < 1e4 else f"{value:.1e}".replace("e-0", "e-").replace("e+0", "e")


def bound(check: Check) -> str:
    """The bound with its direction."""
    return f"{'≥' if check.at_least else '≤'} {number(check.bound)}"


def to_markdown(matrix: Matrix) -> str:
    """Claims, one table for each group, provenance."""
    lines = ["# Stability of the UMAT and its driver", "", _summary_line(matrix), "", "## Must hold", ""]
    lines += ["| claim | holds | worst measured | bound | where |", "| --- | --- | --- | --- | --- |"]
    for finding in find(CLAIMS, matrix.cells):
        worst = finding.worst
        place = (number(worst.outcome.measured), bound(worst.check), worst.column) if worst else ("", "", "")
        lines.append(f"| {finding.statement} | {'yes' if finding.holds else '**no**'} | {' | '.join(place)} |")
    for group, rows in rows_by_group(matrix).items():
        lines += ["", f"## {group}", ""]
        lines += ["| check | measured | bound | holds | refused | fails | worst | where | reason |", "| --- " * 9 + "|"]
        lines += [_markdown_row(row) for row in rows]
    lines += ["", "## Made with", ""]
    lines += [f"- {name.replace('_', ' ')}: {_plain(value)}" for name, value in matrix.provenance.items()]
    return "\n".join(lines) + "\n"


def _markdown_row(row: Row) -> str:
    worst = row.worst
    counts = [str(row.count(verdict)) for verdict in Verdict]
    place = [number(worst.outcome.measured), worst.column] if worst else ["", ""]
    cells = [row.check.name, row.check.measures, bound(row.check), *counts, *place, row.remark]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _plain(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{name} = {entry}" for name, entry in value.items())
    return "; ".join(map(str, value)) if isinstance(value, list) else str(value)


def _summary_line(matrix: Matrix) -> str:
    counts = ", ".join(f"{matrix.count(verdict)} {verdict}" for verdict in Verdict)
    ledger = matrix.ledger
    return (
        f"{len(matrix.cells)} cells: {counts}. {ledger.calls} calls and {ledger.increments} increments looked at, "
        f"{ledger.refusals} refusals, {ledger.total} incidents."
    )


def to_html(matrix: Matrix) -> str:
    """One page without scripts or outside references."""
    template = resources.files("plyflow") / "evidence" / "stability" / "template.html.j2"
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {"number": number, "bound": bound, "plain": _plain}
    page = environment.from_string(template.read_text(encoding="utf-8"))
    columns = [column for column in dict.fromkeys(cell.column for cell in matrix.cells) if column != WHOLE]
    materials = list(dict.fromkeys(column.rsplit(" ", 1)[0] for column in columns))
    return page.render(
        groups=rows_by_group(matrix),
        findings=find(CLAIMS, matrix.cells),
        columns=columns,
        whole=WHOLE,
        materials=[(name, [c for c in columns if c.rsplit(" ", 1)[0] == name]) for name in materials],
        matrix=matrix,
        verdicts=list(Verdict),
        counts={verdict: matrix.count(verdict) for verdict in Verdict},
        messages=messages,
        details=details,
    )


def messages(rows: Sequence[Row], verdict: Verdict) -> list[tuple[str, int]]:
    """Distinct reasons of the cells with a verdict (equal but for their numbers), and how often they came."""
    first: dict[str, str] = {}
    counts: dict[str, int] = {}
    for row in rows:
        for cell in row.cells.values():
            if cell.outcome.verdict is verdict:
                key = NUMBER.sub("#", cell.outcome.reason)
                first.setdefault(key, cell.outcome.reason)
                counts[key] = counts.get(key, 0) + 1
    return [(first[key], count) for key, count in counts.items()]


def details(row: Row) -> list[tuple[str, str]]:
    """Further numbers of the worst cell of a row."""
    cell = row.worst or next(iter(row.cells.values()))
    entries = cell.outcome.details.items()
    return [(name.replace("_", " "), v if isinstance(v, str) else number(v)) for name, v in entries]


def terminal_tables(matrix: Matrix) -> list[Table]:
    """Claims and groups for the terminal, 80 columns at most."""
    claims = Table(title="Must hold", title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1))
    for heading in ("claim", "worst", "bound", ""):
        claims.add_column(heading, justify="left" if heading in ("claim", "") else "right")
    for finding in find(CLAIMS, matrix.cells):
        worst = finding.worst
        place = (number(worst.outcome.measured), bound(worst.check)) if worst else ("", "")
        claims.add_row(finding.statement, *place, "holds" if finding.holds else "[red]fails[/red]")
    groups = Table(title="Cells", title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1))
    groups.add_column("group")
    for verdict in Verdict:
        groups.add_column(str(verdict).removesuffix(" with message"), justify="right")
    for group, rows in rows_by_group(matrix).items():
        groups.add_row(group, *(str(sum(row.count(verdict) for row in rows)) for verdict in Verdict))
    return [claims, groups]
