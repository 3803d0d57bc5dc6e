"""A lowered stage: ordered assignments with what goes in, what comes out, and which equation they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from umatgen.lower.assign import Assignment, OperationCount
from umatgen.notation import describe


@dataclass(frozen=True)
class Variable:
    """An input or output of a stage."""

    name: str
    shape: tuple[int, ...] = ()
    note: str = ""


@dataclass(frozen=True)
class Stage:
    """One concept of the emitted code.

    Parameters
    ----------
    name : id of the stage; procedure name without prefix; what manifest and audit call it.
    title, equation : one line, and the number or place in the paper.
    inputs, outputs : in order of the argument list.
    assignments : in order of evaluation.
    local_arrays : arrays used inside only.
    counts : operations before and after each pass.
    formula : paragraphs: the formula, and what the paper prints where that is something else.
    sharing : where common subexpressions are shared: "all", "heads" (not in the components of DDSDDE), "slopes" (in the slopes
        of ln g only) or "none".
    """

    name: str
    title: str
    equation: str
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    assignments: Sequence[Assignment]
    local_arrays: tuple[Variable, ...] = ()
    counts: tuple[OperationCount, ...] = field(default=())
    sharing: str = "all"
    formula: tuple[str, ...] = ()


def make_stage(
    name: str,
    title: str,
    equation: str,
    inputs: str,
    outputs: str,
    assignments: Sequence[Assignment],
    local_arrays: tuple[Variable, ...] = (),
    sharing: str = "all",
    formula: Sequence[str] = (),
) -> Stage:
    """A stage with its variables looked up."""
    return Stage(
        name, title, equation, variables(inputs), variables(outputs), list(assignments), local_arrays, (), sharing,
        tuple(formula),
    )  # fmt: skip


def variables(names: str) -> tuple[Variable, ...]:
    """Variables by name, separated by blanks, with shape and note from the symbol table."""
    return tuple(Variable(name, *describe(name)) for name in names.split())
