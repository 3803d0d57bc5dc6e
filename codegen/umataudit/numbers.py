"""Numbers for the comparison with machine code: mpmath evaluation of model expressions, small tensors as nested lists."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import mpmath as mp
import sympy as sp

from umataudit.points import DIGITS
from umatgen.model.generators import VOIGT

Number = Any
Value = Any
"""A number, six components in Abaqus's order, or a matrix as nested lists."""
WORKING_DIGITS = DIGITS + 30


@cache
def _compiled(expr: sp.Expr) -> tuple[tuple[str, ...], Any]:
    symbols = sorted(expr.free_symbols, key=str)
    return tuple(s.name for s in symbols), sp.lambdify(symbols, expr, modules="mpmath")


def evaluate(expr: sp.Expr, values: Mapping[str, Value]) -> Number:
    """Number of an expression, with the values of its symbols by name.

    Raises
    ------
    KeyError
        Names a symbol without a value.
    """
    names, function = _compiled(sp.sympify(expr))
    missing = [name for name in names if name not in values]
    if missing:
        raise KeyError(f"no value for {', '.join(missing)} in {expr}")
    return mp.mpmathify(function(*(values[name] for name in names)))


def rounded(value: Value) -> Value:
    """The nearest double-precision number, exactly, in every component."""
    if isinstance(value, Sequence):
        return [rounded(part) for part in value]
    return mp.mpf(float(value))


def flat(value: Value) -> list[Number]:
    """All components."""
    return [number for part in value for number in flat(part)] if isinstance(value, Sequence) else [value]


def matrix(voigt: Sequence[Number]) -> list[list[Number]]:
    """Symmetric 3x3 matrix from six components."""
    result = [[mp.mpf(0)] * 3 for _ in range(3)]
    for number, (i, j) in zip(voigt, VOIGT, strict=True):
        result[i][j] = result[j][i] = number
    return result


def voigt(full: Sequence[Sequence[Number]]) -> list[Number]:
    """Six components of a symmetric matrix."""
    return [full[i][j] for i, j in VOIGT]


def transposed(a: Sequence[Sequence[Number]]) -> list[list[Number]]:
    """Transpose."""
    return [list(row) for row in zip(*a, strict=True)]


def product(*factors: Sequence[Sequence[Number]]) -> list[list[Number]]:
    """Matrix product."""
    result = [list(row) for row in factors[0]]
    for right in factors[1:]:
        columns = transposed(right)
        result = [[mp.fdot(row, column) for column in columns] for row in result]
    return result


def determinant(a: Sequence[Sequence[Number]]) -> Number:
    """Determinant of a 3x3 matrix."""
    return sum(
        a[0][i] * (a[1][(i + 1) % 3] * a[2][(i + 2) % 3] - a[1][(i + 2) % 3] * a[2][(i + 1) % 3]) for i in range(3)
    )


def inverse(a: Sequence[Sequence[Number]]) -> list[list[Number]]:
    """Inverse of a 3x3 matrix."""
    rows: list[list[Number]] = (mp.matrix(a) ** -1).tolist()
    return rows


def combined(terms: Sequence[tuple[Number, Sequence[Number]]]) -> list[Number]:
    """Sum of number times vector."""
    return [sum(scale * vector[n] for scale, vector in terms) for n in range(len(terms[0][1]))]
