"""Tensor operations that formulas use; fourth-order tensors are SymPy arrays of shape (3, 3, 3, 3)."""

from __future__ import annotations

from collections.abc import Callable

import sympy as sp


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
