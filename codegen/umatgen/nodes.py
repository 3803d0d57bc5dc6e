"""The small language the emitter speaks: a few frozen dataclasses, with SymPy expressions or Fortran text as leaves.

In text `@` stands for the prefix of the scene's procedures.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class Comment:
    """A paragraph of comment."""

    text: str


@dataclass(frozen=True)
class Declare:
    """A variable: a dummy argument with its intent ("in", "out", "inout"), a local one (""), or a constant with its value."""

    name: str
    shape: tuple[int | str, ...] = ()
    intent: str = ""
    note: str = ""
    kind: str = "DOUBLE PRECISION"
    value: str = ""


@dataclass(frozen=True)
class Assign:
    """`target = value`; the value is a SymPy expression, or Fortran text for array syntax and conditions."""

    target: str
    value: sp.Expr | str


@dataclass(frozen=True)
class Call:
    """`CALL name(arguments)`; those from number `outputs` on are set by it."""

    name: str
    arguments: tuple[str, ...]
    outputs: int = 0


@dataclass(frozen=True)
class Return:
    """The end of the procedure."""


@dataclass(frozen=True)
class If:
    """Branches in order, each a condition as Fortran text and what is done; an empty condition is the ELSE."""

    branches: tuple[tuple[str, Sequence[Statement]], ...]


@dataclass(frozen=True)
class While:
    """`DO WHILE (condition)`."""

    condition: str
    body: Sequence[Statement]


@dataclass(frozen=True)
class Do:
    """`DO counter = first, last`, with a line for the compiler above it if there is one."""

    counter: str
    first: str
    last: str
    body: Sequence[Statement]
    directive: str = ""


@dataclass(frozen=True)
class Exit:
    """Leave the loop."""


Statement = Comment | Assign | Call | Return | If | While | Do | Exit


@dataclass(frozen=True)
class Procedure:
    """A procedure: what it does, what goes in and out, its statements, and procedures inside it.

    Parameters
    ----------
    name : name without the scene's prefix; of a stage also the id in the manifest and the audit.
    heading : comment lines above it.
    arguments : dummies in order, with intent.
    body : statements.
    declared : local arrays and constants; local scalars are found from the body.
    inside : procedures behind CONTAINS.
    result : kind of the result of a function; empty for a subroutine.
    """

    name: str
    heading: Sequence[str]
    arguments: tuple[Declare, ...]
    body: Sequence[Statement]
    declared: tuple[Declare, ...] = ()
    inside: Sequence[Procedure] = ()
    result: str = ""


def when(condition: str, *body: Statement) -> If:
    """One branch."""
    return If(((condition, body),))


def fault(number: int, value: str = "", bound: str = "", *, unless: tuple[str, int] | None = None) -> list[Statement]:
    """What ends the increment: its number (another one under the condition `unless`), the value and the bound it violates."""
    body: list[Statement] = [Assign("ifault", f"{number}")]
    body += [when(unless[0], Assign("ifault", f"{unless[1]}"))] if unless else []
    body += [Assign(f"fault_{name}", text) for name, text in (("value", value), ("bound", bound)) if text]
    return [*body, Return()]


def targets(statements: Sequence[Statement]) -> Iterator[str]:
    """Names of the variables that statements set, in order of appearance."""
    for statement in statements:
        if isinstance(statement, Assign):
            yield base(statement.target)
        elif isinstance(statement, Call):
            yield from (base(name) for name in statement.arguments[statement.outputs :])
        elif isinstance(statement, If):
            for _, body in statement.branches:
                yield from targets(body)
        elif isinstance(statement, While | Do):
            yield from targets(statement.body)


def texts(statements: Sequence[Statement]) -> Iterator[str]:
    """What statements read themselves, as text; what a call reads is the affair of the procedure called."""
    for statement in statements:
        if isinstance(statement, Assign):
            yield f"{statement.target.partition('(')[2]} {statement.value}"
        elif isinstance(statement, If):
            for condition, body in statement.branches:
                yield condition
                yield from texts(body)
        elif isinstance(statement, While | Do):
            yield statement.condition if isinstance(statement, While) else ""
            yield from texts(statement.body)


def names(statements: Sequence[Statement]) -> set[str]:
    """Names that statements read themselves."""
    return {word for text in texts(statements) for word in re.findall(r"[a-z]\w*", text)}


def handed_on(statements: Sequence[Statement]) -> set[str]:
    """Names that statements hand to the procedures they call."""
    found: set[str] = set()
    for statement in statements:
        if isinstance(statement, Call):
            found |= {base(name) for name in statement.arguments[: statement.outputs]}
        elif isinstance(statement, If):
            for _, body in statement.branches:
                found |= handed_on(body)
        elif isinstance(statement, While | Do):
            found |= handed_on(statement.body)
    return found


def base(target: str) -> str:
    """Name of the array or scalar of a target."""
    return target.split("(", maxsplit=1)[0]
