"""Variables that live in one loop over the points become scalars there; the others stay arrays over the points."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterator, Sequence

from umatgen.lower.block_scope import POINT, SIMD
from umatgen.nodes import Assign, Call, Do, If, Statement, base


def private(statements: Sequence[Statement], candidates: set[str]) -> tuple[list[Statement], set[str]]:
    """Statements with the candidates that live in one loop as scalars; the names of those that stay arrays.

    The loops over the points are those with a line for the compiler.
    """
    loops, outside = list(_loops(statements)), set(_outside(statements))
    single = {n for n in candidates - outside if sum(_uses(loop, n) for loop in loops) == 1}
    pattern = re.compile(rf"\b({'|'.join(sorted(single)) or '-'})\({POINT}((?:,\d)*)\)")

    def scalar(text: str) -> str:
        return pattern.sub(lambda m: m[1] + (f"_{m[2].replace(',', '')}" if m[2] else ""), text)

    return _replaced(statements, scalar), candidates - single


def _loops(statements: Sequence[Statement]) -> Iterator[Do]:
    for statement in statements:
        if isinstance(statement, Do) and statement.directive:
            yield statement
        elif isinstance(statement, Do):
            yield from _loops(statement.body)
        elif isinstance(statement, If):
            for _, body in statement.branches:
                yield from _loops(body)


def _outside(statements: Sequence[Statement]) -> Iterator[str]:
    """Names in calls and conditions."""
    for statement in statements:
        if isinstance(statement, Call):
            yield from (base(a) for a in statement.arguments)
        elif isinstance(statement, If):
            for condition, body in statement.branches:
                yield from re.findall(r"[a-z]\w*", condition)
                yield from _outside(body)
        elif isinstance(statement, Do) and not statement.directive:
            yield from _outside(statement.body)


def _uses(loop: Do, name: str) -> bool:
    wanted = re.compile(rf"\b{name}\({POINT}\b")
    return any(isinstance(s, Assign) and wanted.search(f"{s.target} {s.value}") for s in loop.body)


def _replaced(statements: Sequence[Statement], scalar: Callable[[str], str]) -> list[Statement]:
    result: list[Statement] = []
    for s in statements:
        if isinstance(s, Assign):
            result.append(Assign(scalar(s.target), scalar(str(s.value))))
        elif isinstance(s, Do):
            body = _replaced(s.body, scalar)
            result.append(Do(s.counter, s.first, s.last, body, _with_private(s.directive, body)))
        elif isinstance(s, If):
            result.append(If(tuple((c, _replaced(b, scalar)) for c, b in s.branches)))
        else:
            result.append(s)
    return result


def _with_private(directive: str, body: Sequence[Statement]) -> str:
    """The line above a vector loop with the scalars that every point has for itself, continued where it is long."""
    names = dict.fromkeys(s.target for s in body if isinstance(s, Assign) and "(" not in s.target)
    if directive != SIMD or not names:
        return directive
    return " &\n!$omp& ".join(textwrap.wrap(f"{directive} private({', '.join(names)})", 90))
