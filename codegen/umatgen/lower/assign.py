"""Assignments and the passes over them: stable forms, one power, common subexpressions, operation counts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import sympy as sp

from umatgen.model.chain import Definition


@dataclass(frozen=True)
class Assignment:
    """`target = expr`; the target may be an array element such as "cdot(4)"."""

    target: str
    expr: sp.Expr

    @property
    def symbol(self) -> sp.Symbol:
        """Symbol of the target, for use in later expressions."""
        return element(self.target)


@dataclass(frozen=True)
class OperationCount:
    """Operations of a list of assignments before and after a pass."""

    stage: str
    name: str
    before: int
    after: int


def element(name: str) -> sp.Symbol:
    """Symbol that prints as an array element or plain name."""
    return sp.Symbol(name, real=True)


def from_definitions(definitions: Iterable[Definition]) -> list[Assignment]:
    """Assignments of definitions, in the form that does not cancel."""
    return [Assignment(d.symbol.name, d.expr if d.stable is None else d.stable) for d in definitions]


def operations(assignments: Iterable[Assignment]) -> int:
    """Number of arithmetic operations and function calls."""
    return int(sum(sp.count_ops(a.expr) for a in assignments))


def share(assignments: Sequence[Assignment], prefix: str = "cse_") -> list[Assignment]:
    """Common subexpressions of one block, named `prefix`1, ...; each before its first use.

    The names are local to the block's procedure. Output names are untouched and keep their order.
    """
    names = (element(f"{prefix}{i}") for i in range(1, 1000))
    shared, reduced = sp.cse([a.expr for a in assignments], symbols=names, order="canonical")
    result: list[Assignment] = []
    trivial = {name: expr for name, expr in shared if sp.count_ops(expr) <= 1 and expr.could_extract_minus_sign()}
    reduced = [expr.subs(trivial) for expr in reduced]
    pending = [Assignment(name.name, expr.subs(trivial)) for name, expr in shared if name not in trivial]
    done: set[str] = set()

    def emit_needed(expr: sp.Expr) -> None:
        for temporary in pending:
            if temporary.target not in done and element(temporary.target) in expr.free_symbols:
                done.add(temporary.target)
                emit_needed(temporary.expr)
                result.append(temporary)

    for assignment, expr in zip(assignments, reduced, strict=True):
        emit_needed(expr)
        result.append(Assignment(assignment.target, expr))
    return result
