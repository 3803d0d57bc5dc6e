"""The audit as Markdown, with formulas as LaTeX between dollar signs."""

from __future__ import annotations

from plyflow.audit.report import MEANT, Audit, Line, Row
from umataudit.render import latex


def render_markdown(audit: Audit) -> str:
    """The audit as Markdown text."""
    counts = ", ".join(f"{count} {verdict}" for verdict, count in audit.counts.items())
    parts = [
        "# The paper audited: printed, derived, emitted, compiled",
        f"{len(audit.rows)} relations: {counts}. Misprints: {audit.misprints}.",
        MEANT,
        audit.stated,
    ]
    parts.append(_overview(audit))
    parts += ["## Compiled blocks", _blocks(audit)]
    parts += [_section(row) for row in audit.rows]
    parts += ["## Made with", "\n".join(f"- {name}: {value}" for name, value in audit.made_with.items())]
    return "\n\n".join(parts) + "\n"


def _overview(audit: Audit) -> str:
    lines = ["| no. | where | verdict |", "| --- | --- | --- |"]
    return "\n".join([*lines, *(f"| {row.id} | {_cell(row.place)} | {row.outcome} |" for row in audit.rows)])


def _blocks(audit: Audit) -> str:
    lines = ["| block | equation | states | largest relative difference | agrees |", "| --- | --- | --- | --- | --- |"]
    lines += [
        f"| {b.name} | {b.equation} | {b.calls} | {b.difference:.1e} in {b.output} | {'yes' if b.agrees else 'NO'} |"
        for b in audit.blocks
    ]
    return "\n".join(lines)


def _section(row: Row) -> str:
    parts = [f"## {row.id} ({row.place}): {row.outcome}", row.says]
    parts += [f"{line.said}: {equation(row.left, line.formula)}" for line in row.readings]
    if row.reason:
        parts.append(f"Reading or reason: {row.reason}")
    if row.note:
        parts.append(f"Note: {row.note}")
    if row.derived:
        parts.append(f"Derived: {equation(row.left, row.derived)}")
    parts += [f"- {_with_formula(line)}" for line in row.faults]
    parts.append(f"Consequence: {row.consequence}")
    parts.append("\n".join(f"- premise: {premise}" for premise in row.premises))
    parts.append("\n".join(f"{n}. {_with_formula(line)}" for n, line in enumerate(row.steps, 1)))
    parts.append("\n".join(f"- {_with_formula(line)}" for line in row.checks))
    parts.append("\n".join(f"- witness: {line}" for line in row.witness))
    if row.units:
        parts.append(f"Units: {row.units}")
    parts.append("\n".join(f"- {line.said}" for line in row.chain))
    return "\n\n".join(part for part in parts if part)


def equation(left: str, right: str) -> str:
    """An equation as LaTeX between dollar signs; words as they are."""
    return f"${latex(left)} = {latex(right)}$" if left else f"${latex(right)}$"


def _with_formula(line: Line) -> str:
    return f"{line.said} ${latex(line.formula)}$" if line.formula else line.said


def _cell(text: str) -> str:
    return text.replace("|", r"\|")
