"""Index notation: sums over repeated indices, with a check that every index is free once or summed once."""

from __future__ import annotations

import ast
import itertools
from collections import Counter
from collections.abc import Callable
from typing import Any

import sympy as sp

from umataudit.printed import tensors
from umataudit.printed.letters import LETTERS

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
    components = _contract(tensors_)
    return tensors.fourth_order(lambda *free: scale * components.get(free, sp.S.Zero))


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


_Components = dict[tuple[int, ...], sp.Expr]


def _contract(factors: list[tuple[Any, str]]) -> _Components:
    """Components by i, j, k, l of a product: the last factor first, one sum over repeated indices at a time."""
    names = ""
    result: _Components = {(): sp.S.One}
    for position in reversed(range(len(factors))):
        array, own = factors[position]
        ahead = "".join(other for _, other in factors[:position])
        names, result = _product(names, result, array, own, ahead)
    order = [names.index(name) for name in FREE]
    return {tuple(index[n] for n in order): value for index, value in result.items()}


def _product(names: str, components: _Components, array: Any, own: str, ahead: str) -> tuple[str, _Components]:
    """Product with one more factor, summed over the indices that neither are free nor occur ahead."""
    every = "".join(dict.fromkeys(own + names))
    kept = "".join(name for name in every if name in FREE or name in ahead)
    grown: _Components = {}
    for choice in itertools.product(range(3), repeat=len(every)):
        at = dict(zip(every, choice, strict=True))
        entry = array[tuple(at[name] for name in own)]
        value = components.get(tuple(at[name] for name in names), sp.S.Zero)
        if entry != 0 and value != 0:
            index = tuple(at[name] for name in kept)
            grown[index] = grown.get(index, sp.S.Zero) + entry * value
    return kept, grown
