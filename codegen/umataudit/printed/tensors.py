"""Tensors of formulas: operations, and index notation with a check that every index is free once or summed once.

Fourth-order tensors are SymPy arrays of shape (3, 3, 3, 3).
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
import sympy as sp

from umataudit.printed.letters import LETTERS

FREE = "ijkl"


class IndexNotationError(ValueError):
    """A term is not well formed; says which index occurs how often."""


def fourth_order(component: Callable[[int, int, int, int], sp.Expr]) -> sp.NDimArray:
    """Array of shape (3, 3, 3, 3) from a function of the four indices (0-based)."""
    flat = [component(n // 27, n // 9 % 3, n // 3 % 3, n % 3) for n in range(81)]
    return sp.ImmutableDenseNDimArray(flat, (3, 3, 3, 3))


def symmetric_identity() -> sp.NDimArray:
    """Fourth-order symmetric identity, (1/2)(d_ik d_jl + d_il d_jk)."""
    return fourth_order(lambda i, j, k, m: sp.Rational(int(i == k and j == m) + int(i == m and j == k), 2))


def dyad(first: sp.MatrixBase, second: sp.MatrixBase) -> sp.NDimArray:
    """A (x) B, components A_ij B_kl."""
    return fourth_order(lambda i, j, k, m: first[i, j] * second[k, m])


def double_contraction(first: sp.MatrixBase | sp.NDimArray, second: sp.MatrixBase) -> sp.Expr | sp.MatrixBase:
    """A : B of two matrices, or of a fourth-order tensor and a matrix."""
    pairs = [(k, m) for k in range(3) for m in range(3)]
    if isinstance(first, sp.NDimArray):
        return sp.Matrix(3, 3, lambda i, j: sp.Add(*(first[i, j, k, m] * second[k, m] for k, m in pairs)))
    return sp.Add(*(first[k, m] * second[k, m] for k, m in pairs))


def has_indices(node: ast.expr) -> bool:
    """Whether a formula is in index notation."""
    return any(isinstance(part, ast.Subscript) for part in ast.walk(node))


def factors(node: ast.expr) -> list[ast.expr]:
    """The factors of a top-level product, in printed order."""
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult):
        return [*factors(node.left), node.right]
    return [node]


def index_sum(node: ast.expr, evaluate: Callable[[ast.expr], Any]) -> sp.NDimArray:
    """Fourth-order tensor with free indices i, j, k, l of a sum of indexed products.

    Raises
    ------
    IndexNotationError
        When an index occurs more than twice, or i, j, k, l are not exactly the free ones.
    """
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        sign = 1 if isinstance(node.op, ast.Add) else -1
        return index_sum(node.left, evaluate) + sign * index_sum(node.right, evaluate)
    scale, indexed = sp.S.One, []
    for factor in factors(node):
        if has_indices(factor):
            indexed.append(factor)
        else:
            scale *= evaluate(factor)
    if len(indexed) == 1 and not isinstance(indexed[0], ast.Subscript):
        return scale * index_sum(indexed[0], evaluate)
    names = ["".join(c for c in ast.unparse(factor.slice) if c.isalpha()) for factor in indexed]  # type: ignore[attr-defined]
    _check("".join(names))
    arrays = [np.array(_array(factor), dtype=object) for factor in indexed]
    total = np.einsum(f"{','.join(names)}->{FREE}", *arrays, optimize=True)
    return sp.ImmutableDenseNDimArray((scale * total).tolist())


def _array(factor: Any) -> Any:
    name = ast.unparse(factor.value)
    return (sp.eye(3) if name == "delta" else LETTERS[name].value).tolist()


def _check(used: str) -> None:
    counts = Counter(used)
    wrong = {name: n for name, n in counts.items() if (n != 1 if name in FREE else n != 2)}
    wrong |= {name: 0 for name in FREE if name not in counts}
    if wrong:
        said = ", ".join(f"{name} {n} times" for name, n in sorted(wrong.items()))
        raise IndexNotationError(f"not well formed: {said}; the free indices i, j, k, l occur once, all others twice")
