"""Numbers for the comparison with machine code: model expressions, tensors and invariants in mpmath's precision."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import mpmath as mp
import sympy as sp

from umataudit.points import DIGITS
from umatgen.model.generators import C_INVERSE, FIBRE, FIBRE_C, ONE, VOIGT, Generator

Number = Any
Matrix = Any
"""An `mpmath.matrix` of shape (3, 3)."""
Value = Any
"""A number, six components in Abaqus's order, or a matrix as nested lists."""
WORKING_DIGITS = DIGITS + 30
UNIT = [mp.mpf(int(i == j)) for i, j in VOIGT]


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
    return [rounded(part) for part in value] if isinstance(value, Sequence) else mp.mpf(float(value))


def matrix(components: Sequence[Number]) -> Matrix:
    """Symmetric matrix from six components in Abaqus's order."""
    result = mp.matrix(3)
    for number, (i, j) in zip(components, VOIGT, strict=True):
        result[i, j] = result[j, i] = number
    return result


def voigt(full: Matrix) -> list[Number]:
    """Six components of a symmetric matrix."""
    return [full[i, j] for i, j in VOIGT]


def combined(terms: Sequence[tuple[Number, Sequence[Number]]]) -> list[Number]:
    """Sum of number times vector."""
    return [sum(scale * vector[n] for scale, vector in terms) for n in range(len(terms[0][1]))]


def unit_dyad(i: int, j: int) -> Matrix:
    """Symmetric matrix with 1 at (i, j) and (j, i)."""
    return matrix([mp.mpf(int({i, j} == set(pair))) for pair in VOIGT])


def material_forms(c: Matrix) -> dict[Generator, Matrix]:
    """The generators of the elastic stress in the material frame, fibre along axis 1, at a right Cauchy-Green tensor."""
    n = unit_dyad(0, 0)
    return {ONE: mp.eye(3), FIBRE: n, FIBRE_C: n * c + c * n, C_INVERSE: c**-1}


def invariants(f: Matrix) -> dict[str, Number]:
    """Scalars of a deformation gradient by the model's names: fibre along axis 1, ply normal along axis 3."""
    c = f.T * f
    inverse = c**-1
    x, det_f = 1 / inverse[2, 2], mp.det(f)
    return {
        "det_f": det_f, "a22": c[1, 1], "a33": c[2, 2], "a23": c[1, 2], "c12": c[0, 1], "c13": c[0, 2],
        "a_norm2": c[1, 1] ** 2 + c[2, 2] ** 2 + 2 * c[1, 2] ** 2, "i1": c[0, 0] + c[1, 1] + c[2, 2], "i4": c[0, 0],
        "i5": (c * c)[0, 0], "x_end": x, "stretch": mp.sqrt(x), "width": det_f / mp.sqrt(x * c[0, 0]),
        "tilt_1": x * inverse[0, 2], "tilt_2": x * inverse[1, 2],
    }  # fmt: skip
