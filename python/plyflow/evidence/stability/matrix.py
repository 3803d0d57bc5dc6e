"""The whole matrix: the table of cells (matrix.toml), each filled whatever happens in the others.

A family of cells is one section of the table; the functions that fill its cells get the check, the subject, the column
(unless `whole`) and the values of the axes by name.
"""

from __future__ import annotations

import platform
import time
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module, resources
from itertools import product
from typing import Any

import numpy as np

from plyflow.case.assumptions import default_assumptions
from plyflow.case.materials import known_materials
from plyflow.evidence.stability.cells import WHOLE, Cell, Check, Finding, Outcome, Task, Verdict, find
from plyflow.evidence.stability.ledger import Ledger
from plyflow.evidence.stability.subject import SEED, Column, RefusedError, Subject
from plyflow.provenance import package_version, source_hash
from plyflow.show.progress import Advance
from plyflow.umat import compile as compiling

TABLE = tomllib.loads((resources.files(__package__) / "matrix.toml").read_text(encoding="utf-8"))
SAID = ("name", "measures", "bound", "at_least", "may_refuse", "claim", "slow")
CLAIMS: list[str] = TABLE["claims"]
ACCOUNT = {kind: Check(TABLE["account"]["title"], **rest) for kind, rest in TABLE["account"]["kinds"].items()}


@dataclass(frozen=True)
class Matrix:
    """A finished matrix: cells in order, the account, what it was made with, seconds it took."""

    cells: Sequence[Cell]
    ledger: Ledger
    provenance: Mapping[str, Any]
    seconds: float

    def count(self, verdict: Verdict) -> int:
        """Cells with a verdict."""
        return sum(cell.outcome.verdict is verdict for cell in self.cells)

    @property
    def findings(self) -> list[Finding]:
        """What was found for every claim of the table."""
        return find(CLAIMS, self.cells)

    @property
    def failing(self) -> list[Cell]:
        """Cells that fail."""
        return [cell for cell in self.cells if cell.outcome.verdict is Verdict.FAILS]


def all_tasks(subject: Subject, families: Sequence[str] = ()) -> list[Task]:
    """Every cell of the matrix in order, or those of some families; without those of the account."""
    return [
        task
        for family in TABLE["family"]
        if not families or family["title"] in families
        for task in _tasks(family, subject)
    ]


def _tasks(family: Mapping[str, Any], subject: Subject) -> Iterator[Task]:
    """Rows by column come before the others."""
    rows = [row for cells in family["cells"] for row in _rows({**family, **cells}) if not (subject.quick and row.slow)]
    for column in subject.columns if family.get("by_column") else ():
        yield from (row.task(subject, column) for row in rows if not row.whole and not row.few)
    for row in rows:
        if row.whole:
            yield row.task(subject)
        elif row.few or not family.get("by_column"):
            columns = subject.few(subject.columns, row.few or len(subject.columns))
            yield from (row.task(subject, column) for column in columns)


@dataclass(frozen=True)
class _Row:
    """A check with the function that fills its cells, the function's own arguments, and where and when it is filled."""

    check: Check
    fill: Callable[..., Outcome]
    how: Mapping[str, Any]
    slow: bool
    whole: bool
    few: int

    def task(self, subject: Subject, *column: Column) -> Task:
        """The cell of a column, or the only one."""
        label = column[0].label if column else WHOLE
        return Task(self.check, label, partial(self.fill, self.check, subject, *column, **self.how))


def _rows(cells: Mapping[str, Any]) -> Iterator[_Row]:
    """Rows of one entry of the table: one for every combination of its axes."""
    module, name = cells["fill"].split(".")
    fill = getattr(import_module(f"{__package__}.{module}"), name)
    axes = cells.get("axes", {})
    for values in product(*axes.values()):
        how = dict(zip(axes, values, strict=True))
        said = {key: _said(cells[key], how) for key in SAID if key in cells}
        slow = said.pop("slow", False)
        check = Check(cells["title"], **{key: value for key, value in said.items() if value is not None})
        yield _Row(check, fill, how, bool(slow), cells.get("whole", False), cells.get("few", 0))


def _said(value: Any, how: Mapping[str, Any]) -> Any:
    """An entry for one combination of the axes: a table asks for an axis and then its value, a text is a format."""
    while isinstance(value, dict) and len(value) == 1 and next(iter(value)) in how:
        ((axis, options),) = value.items()
        value = options.get(str(how[axis]))
    return value.format(**how) if isinstance(value, str) else value


def run_matrix(subject: Subject, tasks: Sequence[Task], advance: Advance | None = None) -> Matrix:
    """Fill cells, then those of the account; `advance` hears of each with the group it belongs to."""
    begin, cells = time.perf_counter(), []
    for task in tasks:
        cells.append(Cell(task.check, task.column, fill(subject, task)))
        if advance is not None:
            advance(task.check.group)
    ledger = subject.ledger
    numbers = {"calls": ledger.calls, "increments": ledger.increments, "refusals": ledger.refusals}
    for kind, check in ACCOUNT.items():
        lines = ledger.incidents[kind]
        cells.append(Cell(check, WHOLE, check.judge(len(lines), lines[0] if lines else "", **numbers)))
    return Matrix(cells, ledger, provenance(subject), time.perf_counter() - begin)


def fill(subject: Subject, task: Task) -> Outcome:
    """Fill one cell; an incident on the way or an exception makes it fail."""
    before = subject.ledger.marks()
    try:
        outcome = task.run()
    except RefusedError as refusal:
        outcome = task.check.refuse(str(refusal))
    except Exception as error:  # the matrix must end and tell; the cell carries the reason
        line = f"{task.check.name}, {task.column}: {type(error).__name__}: {error}"
        subject.ledger.incidents["uncaught"].append(line)
        return task.check.fail(f"uncaught: {line}")
    new = subject.ledger.lines(before)
    if new and outcome.verdict is not Verdict.FAILS:
        return task.check.fail(new[0], outcome.measured, **outcome.details)
    return outcome


def provenance(subject: Subject) -> dict[str, Any]:
    """What the matrix was made with: versions, compiler, sources, inputs, assumptions."""
    numerics = subject.values(subject.columns[0])
    return {
        "plyflow_version": package_version(),
        "generator_version": subject.scene()[1]["generator_version"],
        "compiler": compiling.compiler_version(),
        "compiler_flags": " ".join(compiling.FLAGS),
        "quadruple_flags": " ".join(compiling.QUAD_FLAGS),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "machine": platform.machine(),
        "seed": SEED,
        "matrix": "quick" if subject.quick else "whole",
        "materials": {name: f"{list(one.table.temperature)} degC" for name, one in known_materials().items()},
        "numerical_parameters": {name: numerics[name] for name in ("kappa", "rate_floor", "strain_floor")},
        "assumptions": [str(entry) for entry in default_assumptions().values()],
        "sources_sha256": {name: source_hash(source) for name, source in sorted(subject.sources.items())},
    }
