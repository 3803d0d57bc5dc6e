"""Nodes to Fortran text, one unbroken line a statement; the layout breaks and indents them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from umatgen.expressions import expression
from umatgen.nodes import Assign, Call, Comment, Declare, Do, Exit, If, Procedure, Return, Statement, While, targets


def statement_lines(statement: Statement, prefix: str) -> list[str]:
    """Lines of one statement."""
    match statement:
        case Comment(text):
            return [f"! {line}" for line in text.splitlines()]
        case Call(name, arguments):
            return [f"CALL {prefix}{name}({', '.join(arguments)})"]
        case Assign(target, value):
            return [f"{target} = {expression(value)}"]
        case Return() | Exit():
            return [type(statement).__name__.upper()]
        case While() | Do():
            directive = statement.directive.splitlines() if isinstance(statement, Do) else []
            return [*directive, _loop_head(statement), *body_lines(statement.body, prefix), "END DO"]
        case If(branches):
            return _if_lines(branches, prefix)


def _loop_head(loop: While | Do) -> str:
    return f"DO WHILE ({loop.condition})" if isinstance(loop, While) else f"DO {loop.counter} = {loop.first}, {loop.last}"


def _if_lines(branches: Sequence[tuple[str, Sequence[Statement]]], prefix: str) -> list[str]:
    """A block IF; a single simple statement stands on the line of its condition."""
    ((condition, body), *others) = branches
    if not others and len(body) == 1 and isinstance(body[0], Assign | Call | Return | Exit):
        return [f"IF ({condition}) {statement_lines(body[0], prefix)[0]}"]
    lines = [f"IF ({condition}) THEN", *body_lines(body, prefix)]
    for condition, body in others:
        lines += [f"ELSE IF ({condition}) THEN" if condition else "ELSE", *body_lines(body, prefix)]
    return [*lines, "END IF"]


def body_lines(body: Sequence[Statement], prefix: str) -> list[str]:
    """Lines of statements in order."""
    return [line for statement in body for line in statement_lines(statement, prefix)]


def procedure_lines(procedure: Procedure, prefix: str) -> list[str]:
    """Unbroken lines of a whole procedure."""
    name = prefix + procedure.name
    kind = f"{procedure.result} FUNCTION" if procedure.result else "SUBROUTINE"
    lines = [
        "!" + "-" * 70,
        *(f"! {line}" for text in procedure.heading for line in text.splitlines()),
        f"{kind} {name}({', '.join(d.name for d in procedure.arguments)})",
        "IMPLICIT NONE",
        *declaration_lines([*procedure.arguments, *procedure.declared, *local_variables(procedure)]),
        *body_lines(procedure.body, prefix),
    ]
    if procedure.inside:
        lines += ["", "CONTAINS"]
        lines += [line for inner in procedure.inside for line in ("", *procedure_lines(inner, prefix))]
    return [line.replace("@", prefix) for line in [*lines, f"END {kind.rsplit(maxsplit=1)[-1]} {name}"]]


def local_variables(procedure: Procedure) -> list[Declare]:
    """Local scalars: what the body sets and nothing declares."""
    known = {d.name for d in (*procedure.arguments, *procedure.declared)} | {f"@{procedure.name}"}
    return [Declare(name) for name in dict.fromkeys(targets(procedure.body)) if name not in known]


def declaration_lines(declarations: Sequence[Declare]) -> list[str]:
    """One declaration for all neighbours of a kind: dummies of an intent, constants one by one, local arrays, local scalars."""
    lines: list[str] = []
    for (head, _, value), group in groupby(declarations, _declared_as):
        names = [_shaped(d) + (f" = {value}" if value else "") for d in group]
        lines.append(f"{head} :: {', '.join(names)}")
    return lines


def _declared_as(item: Declare) -> tuple[str, bool, str]:
    attribute = ", PARAMETER" if item.value else f", INTENT({item.intent.upper()})" if item.intent else ""
    return item.kind + attribute, bool(item.shape) and not item.intent, item.value


def _shaped(item: Declare) -> str:
    return f"{item.name}({','.join(str(n) for n in item.shape)})" if item.shape else item.name
