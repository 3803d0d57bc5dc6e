"""Index notation: sums over repeated indices, with a check that every index is free once or summed once."""

from __future__ import annotations

import ast
import itertools
from collections import Counter
from collections.abc import Callable
from typing import Any

import sympy as sp

from umatgen.printed import tensors
from umatgen.printed.letters import LETTERS

FREE = "ijkl"


class IndexNotationError(ValueError):
    """A term is not well formed; says which index occurs how often."""


def index_sum(node: ast.expr, evaluate: Callable[[ast.expr], Any]) -> sp.NDimArray:
    """Fourth-order tensor with free indices i, j, k, l of a sum of indexed products.

    Raises
    ------
    IndexNotationError
        When an index occurs more than twice, or i, j, k, l are not exactly the free ones.
    """
    match node:
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return index_sum(left, evaluate) + index_sum(right, evaluate)
        case ast.BinOp(left=left, op=ast.Sub(), right=right):
            return index_sum(left, evaluate) - index_sum(right, evaluate)
        case ast.BinOp(left=left, op=ast.Mult(), right=right) if not _indexed(left) and not _is_factor(right):
            return evaluate(left) * index_sum(right, evaluate)
    return _term(node, evaluate)


def _indexed(node: ast.expr) -> bool:
    return any(isinstance(part, ast.Subscript) for part in ast.walk(node))


def _is_factor(node: ast.expr) -> bool:
    return isinstance(node, ast.Subscript)


def _factors(node: ast.expr) -> list[ast.expr]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
        return [*_factors(node.left), node.right]
    return [node]


def _term(node: ast.expr, evaluate: Callable[[ast.expr], Any]) -> sp.NDimArray:
    scale: sp.Expr = sp.S.One
    tensors_: list[tuple[Any, str]] = []
    for factor in _factors(node):
        if isinstance(factor, ast.Subscript):
            tensors_.append((_array(ast.unparse(factor.value)), _names(factor)))
        else:
            scale *= evaluate(factor)
    _check("".join(names for _, names in tensors_))
    return tensors.fourth_order(lambda *free: scale * _contract(tensors_, dict(zip(FREE, free, strict=True))))


def _array(name: str) -> Any:
    return sp.eye(3) if name == "delta" else LETTERS[name].value


def _names(factor: ast.Subscript) -> str:
    return ast.unparse(factor.slice).strip("()").replace(", ", "").replace(",", "")


def _check(used: str) -> None:
    counts = Counter(used)
    wrong = {name: n for name, n in counts.items() if (n != 1 if name in FREE else n != 2)}
    wrong |= {name: 0 for name in FREE if name not in counts}
    if wrong:
        said = ", ".join(f"{name} {n} times" for name, n in sorted(wrong.items()))
        raise IndexNotationError(f"not well formed: {said}; the free indices i, j, k, l occur once, all others twice")


def _contract(factors: list[tuple[Any, str]], free: dict[str, int]) -> sp.Expr:
    """Sum over the repeated indices, one factor at a time."""
    partial: dict[tuple[tuple[str, int], ...], sp.Expr] = {(): sp.S.One}
    remaining = Counter("".join(names for _, names in factors))
    for array, names in factors:
        remaining -= Counter(names)
        grown: dict[tuple[tuple[str, int], ...], sp.Expr] = {}
        for known, value in partial.items():
            bound = dict(known) | free
            unknown = [name for name in dict.fromkeys(names) if name not in bound]
            for choice in itertools.product(range(3), repeat=len(unknown)):
                every = bound | dict(zip(unknown, choice, strict=True))
                entry = array[tuple(every[name] for name in names)]
                if entry == 0:
                    continue
                kept = tuple(sorted((n, v) for n, v in every.items() if n not in free and remaining[n] > 0))
                grown[kept] = grown.get(kept, sp.S.Zero) + value * entry
        partial = grown
    return sp.Add(*partial.values())
