"""3x3 tensors as tuples of rows of mpmath numbers; everything runs at the caller's precision."""

from collections.abc import Sequence
from typing import Any

from mpmath import mp

Real = Any  # an mpmath number; mpmath carries no type information
Row = tuple[Real, Real, Real]
Tensor = tuple[Row, Row, Row]

AXES = (0, 1, 2)
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
"""Abaqus's order of components: 11, 22, 33, 12, 13, 23."""


def tensor(rows: Sequence[Sequence[Any]] | Any) -> Tensor:
    """Convert a 3x3 array to a tensor without rounding (doubles are exact in mpmath)."""
    first, second, third = (_row([rows[i][j] for j in AXES]) for i in AXES)
    return first, second, third


def _row(entries: Sequence[Any]) -> Row:
    first, second, third = (_number(entry) for entry in entries)
    return first, second, third


def _number(value: Any) -> Real:
    return value if isinstance(value, mp.mpf) else mp.mpf(float(value))


IDENTITY = tensor([[1, 0, 0], [0, 1, 0], [0, 0, 1]])


def build(entry: Any) -> Tensor:
    """Tensor whose components are ``entry(i, j)``."""
    first, second, third = ((entry(i, 0), entry(i, 1), entry(i, 2)) for i in AXES)
    return first, second, third


def add(*terms: Tensor) -> Tensor:
    """Sum of tensors."""
    return build(lambda i, j: mp.fsum(term[i][j] for term in terms))


def scale(factor: Real, a: Tensor) -> Tensor:
    """Multiple of a tensor."""
    return build(lambda i, j: factor * a[i][j])


def subtract(a: Tensor, b: Tensor) -> Tensor:
    """Difference a - b."""
    return build(lambda i, j: a[i][j] - b[i][j])


def transpose(a: Tensor) -> Tensor:
    """Transpose."""
    return build(lambda i, j: a[j][i])


def product(a: Tensor, b: Tensor) -> Tensor:
    """Single contraction a . b."""
    columns = transpose(b)
    return build(lambda i, j: mp.fdot(a[i], columns[j]))


def contract(a: Tensor, b: Tensor) -> Real:
    """Double contraction a : b."""
    return mp.fsum(mp.fdot(a[i], b[i]) for i in AXES)


def congruence(f: Tensor, s: Tensor) -> Tensor:
    """Push-forward f . s . f^T."""
    return product(product(f, s), transpose(f))


def cofactor(a: Tensor) -> Tensor:
    """Cofactor tensor, so that a . cof(a)^T = det(a) I."""

    def minor(i: int, j: int) -> Real:
        m, n = (i + 1) % 3, (i + 2) % 3
        p, q = (j + 1) % 3, (j + 2) % 3
        return a[m][p] * a[n][q] - a[m][q] * a[n][p]

    return build(minor)


def determinant(a: Tensor) -> Real:
    """Return the determinant."""
    return mp.fdot(a[0], cofactor(a)[0])


def inverse(a: Tensor) -> Tensor:
    """Inverse by cofactors."""
    return scale(1 / determinant(a), transpose(cofactor(a)))


def right_cauchy_green(f: Tensor) -> Tensor:
    """C = F^T F."""
    return product(transpose(f), f)


def voigt(a: Tensor) -> tuple[Real, ...]:
    """Components of a symmetric stress in the order 11, 22, 33, 12, 13, 23."""
    return tuple(a[i][j] for i, j in VOIGT)


def strain_basis(component: int) -> Tensor:
    """Symmetric tensor of unit engineering strain: one on the diagonal, a half twice off it."""
    i, j = VOIGT[component]
    weight = mp.mpf(1) if i == j else mp.mpf(1) / 2
    return build(lambda m, n: weight if (m, n) in ((i, j), (j, i)) else mp.mpf(0))
