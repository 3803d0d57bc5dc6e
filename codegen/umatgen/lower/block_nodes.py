"""The nodes of the point routine made ready for blocks of points: faults as losses of the margin, calls merged, cheaper terms."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import sympy as sp

from umatgen.lower.block_scope import MARGIN, Shape, indices
from umatgen.lower.faults import FAULT
from umatgen.nodes import Assign, Call, If, Return, Statement

# Set under a condition for the one increment that passes the lock; that goes through the scalar routine: the mean over its path
# is divided by small differences.
SCALAR_ONLY = ("widening",)
_LOST = Assign(MARGIN, "0.0d0")


def without_faults(body: Sequence[Statement], shapes: Mapping[str, Shape]) -> list[Statement]:
    """Statements with faults, and what is left to the scalar routine, as losses of the margin."""
    result: list[Statement] = []
    for statement in body:
        if isinstance(statement, Assign) and statement.target in FAULT:
            continue
        if isinstance(statement, Call) and set(FAULT) & set(statement.arguments):
            result.append(If(((".NOT. (dt >= 0.0d0 .AND. dt <= huge(dt))", [_LOST]),)))
        elif isinstance(statement, If):
            result += _branches(statement, shapes)
        else:
            result.append(statement)
    return result


def _branches(statement: If, shapes: Mapping[str, Shape]) -> list[Statement]:
    branches: list[tuple[str, Sequence[Statement]]] = []
    for condition, body in statement.branches:
        if "ifault" in condition or re.fullmatch(rf"({'|'.join(SCALAR_ONLY)}) > 1\.0d0", condition):
            continue
        lost = any(isinstance(s, Return) or (isinstance(s, Assign) and s.target in SCALAR_ONLY) for s in body)
        branches.append((_finite(condition, shapes), [_LOST] if lost else without_faults(body, shapes)))
    if branches and not branches[0][0]:
        return list(branches[0][1])
    return [If(tuple(branches))] if branches else []


def _finite(condition: str, shapes: Mapping[str, Shape]) -> str:
    """`@finite(x)` as a comparison, sums of arrays written out."""
    condition = re.sub(r"sum\((\w+)\)", lambda m: " + ".join(f"{m[1]}({i})" for i in indices(shapes[m[1]])), condition)
    return re.sub(r"\.NOT\. @finite\((.*)\)$", r".NOT. abs(\1) <= huge(1.0d0)", condition)


def one_call(body: Sequence[Statement]) -> list[Statement]:
    """Branches that all end with a call of the same procedure, the same but for constants, as one call behind them."""
    result: list[Statement] = []
    for statement in body:
        merged = _merged(statement) if isinstance(statement, If) else None
        result += merged if merged is not None else [statement]
    return result


def _merged(statement: If) -> list[Statement] | None:
    ends = [body[-1] for _, body in statement.branches if body]
    calls = [end for end in ends if isinstance(end, Call)]
    if len(calls) < max(2, len(statement.branches)) or len({(c.name, len(c.arguments)) for c in calls}) > 1:
        return None
    first = calls[0]
    varying = [n for n, given in enumerate(zip(*(c.arguments for c in calls), strict=True)) if len(set(given)) > 1]
    if not all(re.match(r"\d", c.arguments[n]) for c in calls for n in varying):
        return None
    names = {n: f"{first.name}_{n + 1}" for n in varying}
    branches = [
        (condition, [*body[:-1], *(Assign(name, call.arguments[n]) for n, name in names.items())])
        for (condition, body), call in zip(statement.branches, calls, strict=True)
    ]
    arguments = tuple(names.get(n, given) for n, given in enumerate(first.arguments))
    return [If(tuple(branches)), Call(first.name, arguments, first.outputs)]


def cheaper(value: sp.Expr | str, *, hot: bool = False) -> sp.Expr | str:
    """Powers with a symbol as exponent by exp and log; in a loop also quotients on one denominator."""
    if isinstance(value, str):
        return value
    value = value.replace(lambda e: isinstance(e, sp.log) and e.args[0].is_Mul, lambda e: _log_of(e.args[0]))
    value = value.replace(lambda e: e.is_Pow and bool(e.exp.free_symbols), lambda e: sp.exp(e.exp * sp.log(e.base)))
    return value.replace(lambda e: e.is_Add and sum(map(_is_quotient, e.args)) > 1, sp.together) if hot else value


def _is_quotient(term: sp.Expr) -> bool:
    return bool(sp.denom(term).free_symbols)


def _log_of(product: sp.Expr) -> sp.Expr:
    """Its logarithm, with the powers that have a symbol as exponent as terms of their own."""
    powers = [f for f in product.args if f.is_Pow and f.exp.free_symbols]
    rest = sp.Mul(*(f for f in product.args if f not in powers))
    return sp.Add(*(f.exp * sp.log(f.base) for f in powers), sp.log(rest))
