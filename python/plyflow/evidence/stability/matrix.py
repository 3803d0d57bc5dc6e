"""The whole matrix: every family of cells in order, each cell filled whatever happens in the others."""

from __future__ import annotations

import pkgutil
import platform
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from plyflow.case.assumptions import default_assumptions
from plyflow.case.materials import known_materials
from plyflow.evidence.stability.cells import FAMILIES, WHOLE, Cell, Check, Claim, Family, Outcome, Task, Verdict
from plyflow.evidence.stability.claims import REFUSED
from plyflow.evidence.stability.ledger import Ledger
from plyflow.evidence.stability.subject import SEED, RefusedError, Subject
from plyflow.provenance import package_version, source_hash
from plyflow.show.progress import Advance
from plyflow.umat import compile as compiling

ACCOUNT = {
    kind: Check("The account of every call and increment", name, "incidents", 0, claim=claim)
    for kind, name, claim in (
        ("not finite", "no NaN and no Inf in any answer", Claim(1, "0 NaN, 0 Inf")),
        (
            "wrong-sided",
            "no stress from the wrong side, no dissipation that falls",
            Claim(2, "0 wrong-sided stresses"),
        ),
        ("unsaid", "every refusal comes with a message", REFUSED),
        ("uncaught", "no failure that nothing caught", Claim(3, "0 uncaught failures")),
    )
}


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
    def failing(self) -> list[Cell]:
        """Cells that fail."""
        return [cell for cell in self.cells if cell.outcome.verdict is Verdict.FAILS]


def families() -> list[Family]:
    """Families of all modules of this folder, in their places."""
    for module in pkgutil.iter_modules([str(Path(__file__).parent)], f"{__package__}."):
        import_module(module.name)
    return sorted(FAMILIES.values(), key=lambda family: family.place)


def all_tasks(subject: Subject) -> list[Task]:
    """Every cell of the matrix but those of the account, in order."""
    return [task for family in families() for task in family.tasks(subject)]


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
