"""Numbers for the comparison with machine code: model expressions, tensors and invariants in mpmath's precision."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import mpmath as mp
import sympy as sp

from umataudit.points import DIGITS
from umatgen.model.generators import C_INVERSE, FIBRE, FIBRE_C, ONE, PLANE, VOIGT, Generator

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


def through_thickness(rate: Matrix) -> Matrix:
    """The components of a rate, in the axes n, t, N, that have to do with N: what J2 counts where the lock is passed."""
    return mp.matrix([[rate[i, j] if 2 in (i, j) else 0 for j in range(3)] for i in range(3)])


def material_forms(c: Matrix) -> dict[Generator, Matrix]:
    """The generators of the elastic stress in the material frame, fibre along axis 1, at a right Cauchy-Green tensor."""
    n, inverse = unit_dyad(0, 0), c**-1
    plane = inverse - inverse[:, 2] * inverse[2, :] / inverse[2, 2]
    return {ONE: mp.eye(3), FIBRE: n, FIBRE_C: n * c + c * n, C_INVERSE: inverse, PLANE: plane}


def invariants(f: Matrix, compaction: str = "normal") -> dict[str, Number]:
    """Scalars of a deformation gradient by the model's names: fibre in column 1, ply normal in column 3.

    `compaction` "smallest": x is the smallest eigenvalue of the transverse block A. J is positive: the columns of F may be an
    odd permutation.
    """
    c = f.T * f
    inverse, det_f = c**-1, abs(mp.det(f))
    a22, a33, a23 = c[1, 1], c[2, 2], c[1, 2]
    mean, radius = (a22 + a33) / 2, mp.hypot((a22 - a33) / 2, a23)
    smallest = compaction == "smallest"
    x = mean - radius if smallest else 1 / inverse[2, 2]
    values = {
        "det_f": det_f, "a22": a22, "a33": a33, "a23": a23, "c12": c[0, 1], "c13": c[0, 2],
        "a_norm2": a22**2 + a33**2 + 2 * a23**2, "i1": c[0, 0] + a22 + a33, "i4": c[0, 0],
        "i5": (c * c)[0, 0], "x_end": x, "stretch": mp.sqrt(x),
    }  # fmt: skip
    if smallest:
        return values | {"width": mp.sqrt(mean + radius), "cos2": (a22 - a33) / (2 * radius), "sin2": a23 / radius}
    width, area = det_f / mp.sqrt(x * c[0, 0]), det_f / mp.sqrt(x)
    return values | {"area": area, "width": width, "tilt_1": x * inverse[0, 2], "tilt_2": x * inverse[1, 2]}
