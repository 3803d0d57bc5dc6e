"""The whole matrix: every group of cells in order, each cell filled whatever happens in the others."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import numpy as np

from plyflow.case.assumptions import default_assumptions
from plyflow.evidence.stability import (
    constraint,
    cycles,
    elasticity,
    energy,
    invariants,
    iterations,
    limit,
    lock,
    objectivity,
    order,
    programmes,
    rates,
    refusals,
    rounding,
    shear,
)
from plyflow.evidence.stability.bench import SEED, Bench
from plyflow.evidence.stability.cells import WHOLE, Cell, Check, Outcome, Task, Verdict
from plyflow.evidence.stability.ledger import Ledger
from plyflow.provenance import package_version
from plyflow.umat import compile as compiling

GROUPS: tuple[ModuleType, ...] = (
    refusals,
    rates,
    limit,
    lock,
    programmes,
    constraint,
    elasticity,
    shear,
    cycles,
    objectivity,
    invariants,
    iterations,
    order,
    energy,
    rounding,
)
ACCOUNT_GROUP = "The account of every call and increment"
ACCOUNT = {
    kind: Check(ACCOUNT_GROUP, claim, "incidents", 0)
    for kind, claim in (
        ("not finite", "no NaN and no Inf in any answer"),
        ("wrong-sided", "no stress from the wrong side, no dissipation that falls"),
        ("unsaid", "every refusal comes with a message"),
        ("uncaught", "no failure that nothing caught"),
    )
}


@dataclass(frozen=True)
class Matrix:
    """A finished matrix: cells in order, the account, what it was made with, seconds it took."""

    cells: Sequence[Cell]
    ledger: Ledger
    provenance: Mapping[str, Any]
    seconds: float
    groups: Sequence[str] = field(default=())

    def count(self, verdict: Verdict) -> int:
        """Cells with a verdict."""
        return sum(cell.outcome.verdict is verdict for cell in self.cells)

    @property
    def failing(self) -> list[Cell]:
        """Cells that fail."""
        return [cell for cell in self.cells if cell.outcome.verdict is Verdict.FAILS]


def run_matrix(bench: Bench, advance: Callable[[int, int, Task], None] | None = None) -> Matrix:
    """Fill every cell.

    Parameters
    ----------
    bench : Bench
        Scenes, materials and account; `bench.quick` chooses the reduced matrix.
    advance : callable, optional
        Called after every cell with its number from 1, their total, and the task done.
    """
    begin = time.perf_counter()
    todo = [task for group in GROUPS for task in group.tasks(bench)]
    cells = []
    for number, task in enumerate(todo, start=1):
        cells.append(Cell(task.check, task.column, fill(bench, task)))
        if advance is not None:
            advance(number, len(todo), task)
    cells += [Cell(check, WHOLE, _account(bench, kind)) for kind, check in ACCOUNT.items()]
    names = tuple(dict.fromkeys(cell.check.group for cell in cells))
    return Matrix(cells, bench.ledger, provenance(bench), time.perf_counter() - begin, names)


def fill(bench: Bench, task: Task) -> Outcome:
    """Fill one cell; an incident on the way or an exception makes it fail."""
    before = bench.ledger.marks()
    try:
        outcome = task.run()
    except Exception as error:  # the matrix must end and tell; the cell carries the reason
        line = f"{task.check.name}, {task.column}: {type(error).__name__}: {error}"
        bench.ledger.incidents["uncaught"].append(line)
        return task.check.fail(f"uncaught: {line}")
    new = bench.ledger.lines(before)
    if new and outcome.verdict is not Verdict.FAILS:
        return task.check.fail(new[0], outcome.measured, **outcome.details)
    return outcome


def _account(bench: Bench, kind: str) -> Outcome:
    lines, ledger = bench.ledger.incidents[kind], bench.ledger
    numbers = {"calls": ledger.calls, "increments": ledger.increments, "refusals": ledger.refusals}
    return ACCOUNT[kind].judge(len(lines), lines[0] if lines else "", **numbers)


def provenance(bench: Bench) -> dict[str, Any]:
    """What the matrix was made with: versions, compiler, sources, inputs, assumptions."""
    columns = bench.columns
    materials = {
        name: [column.temperature for column in columns if column.material == name]
        for name in dict.fromkeys(column.material for column in columns)
    }
    numerics = bench.values(columns[0])
    return {
        "plyflow_version": package_version(),
        "generator_version": bench.scene().manifest["generator_version"],
        "compiler": compiling.compiler_version(),
        "compiler_flags": " ".join(compiling.FLAGS),
        "quadruple_flags": " ".join(compiling.QUAD_FLAGS),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "machine": platform.machine(),
        "seed": SEED,
        "matrix": "quick" if bench.quick else "whole",
        "materials": {name: f"{temperatures} degC" for name, temperatures in materials.items()},
        "numerical_parameters": {name: numerics[name] for name in ("kappa", "rate_floor", "strain_floor")},
        "assumptions": [str(entry) for entry in default_assumptions().values()],
        "sources_sha256": bench.source_hashes(),
    }
