"""The constants of the point routine, taken out of PROPS where they are first needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from umatgen.nodes import Assign, If, Statement, handed_on, names


def named_where_needed(body: Sequence[Statement], constants: Mapping[str, str]) -> list[Statement]:
    """Each constant is taken out of PROPS right before the first statement that reads it; in a branch, if only that reads it."""
    result: list[Statement] = []
    left = dict(constants)
    for place, statement in enumerate(body):
        needed = {name: text for name, text in left.items() if name in _read([statement])}
        left = {name: text for name, text in left.items() if name not in needed}
        if isinstance(statement, If):
            inside = {name: text for name, text in needed.items() if name not in _read(body[place + 1 :])}
            statement, needed = _named_in_branches(statement, needed, inside)  # noqa: PLW2901
        result += [Assign(name, text) for name, text in needed.items()]
        result.append(statement)
    return result


def _named_in_branches(statement: If, needed: Mapping[str, str], inside: Mapping[str, str]) -> tuple[If, dict[str, str]]:
    """The statement with those of `inside` named in the one branch that reads them, and what is still needed before it."""
    conditions = names([If(tuple((condition, ()) for condition, _ in statement.branches))])
    branches, rest = [], dict(needed)
    for condition, body in statement.branches:
        others = [other for _, other in statement.branches if other is not body]
        read_outside = conditions.union(*(_read(other) for other in others))
        own = {name: text for name, text in inside.items() if name in _read(body) and name not in read_outside}
        rest = {name: text for name, text in rest.items() if name not in own}
        branches.append((condition, named_where_needed(body, own)))
    return If(tuple(branches)), rest


def _read(statements: Sequence[Statement]) -> set[str]:
    """Names that statements read, or hand to what they call."""
    return names(statements) | handed_on(statements)
