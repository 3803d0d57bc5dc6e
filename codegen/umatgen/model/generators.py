"""Tensor generators: the symmetric second-order tensors that stress and tangent are combinations of.

Each has a material form G (as it stands in the second Piola-Kirchhoff stress) and a spatial form F G F^T (as it stands in
the Kirchhoff stress), so that a push-forward is a change of column in this table. Derivatives are rules in the table too:
dG/dC is a sum of symmetrised products A (.) B,

    (A (.) B)_ijkl = (1/4)(A_ik B_jl + A_il B_jk + B_ik A_jl + B_il A_jk),

and pushes forward term by term. The rules are tested against componentwise differentiation (tests/codegen).
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from umatgen.notation import sym

Voigt = tuple[tuple[int, int], ...]
VOIGT: Voigt = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@dataclass(frozen=True, order=True)
class Generator:
    """A tensor generator.

    Parameters
    ----------
    key : name; of the array in Fortran for its spatial form.
    material, spatial : formulas for people.
    """

    key: str
    material: str
    spatial: str


ONE = Generator("b_left", "1", "b = F F^T")
C_INVERSE = Generator("unit", "C^-1", "I")
FIBRE = Generator("fibre", "n (x) n", "z (x) z, z = F n")
FIBRE_C = Generator("fibre_c", "n (x) Cn + Cn (x) n", "z (x) bz + bz (x) z")
M22 = Generator("m22", "t (x) t", "(F t) (x) (F t)")
M33 = Generator("m33", "N (x) N", "(F N) (x) (F N)")
M23 = Generator("m23", "t (x) N + N (x) t", "(F t) (x) (F N) + (F N) (x) (F t)")
TRANSVERSE = Generator("transverse", "A, the transverse block of C", "F A F^T")
NORMAL = Generator("normal", "x (C^-1 N) (x) (C^-1 N)", "n (x) n, n the unit normal of the deformed ply")
PLANE = Generator("plane", "C^-1 - x (C^-1 N) (x) (C^-1 N)", "I - n (x) n, the projector on the ply plane")
C_RATE = Generator("y_rate", "Cdot", "y = F Cdot F^T")
KIRCHHOFF = Generator("tau", "S", "tau = F S F^T")
GENERATORS = (ONE, C_INVERSE, FIBRE, FIBRE_C, M22, M33, M23, TRANSVERSE, NORMAL, PLANE, C_RATE)


def gradient_rules() -> dict[sp.Symbol, dict[Generator, sp.Expr]]:
    """d(invariant)/dC as combinations of generators (fibre n, t and ply normal N orthonormal).

    x stands for the stretch along the normal, whose gradient is x^2 (C^-1 N) (x) (C^-1 N); the smallest eigenvalue of A, and A:A
    with it, go through a22, a33, a23 instead. The area ratio in the ply plane is J/sqrt(x).
    """
    dt_rate, det_f, i1, i4, i5, a22 = sym("dt_rate", "det_f", "i1", "i4", "i5", "a22")
    a33, a23, a_norm2, x_end, stretch, area, j2 = sym("a33", "a23", "a_norm2", "x_end", "stretch", "area", "j2")
    one, half = sp.S.One, sp.Rational(1, 2)
    return {
        i1: {ONE: one},
        i4: {FIBRE: one},
        i5: {FIBRE_C: one},
        det_f: {C_INVERSE: det_f / 2},
        a22: {M22: one},
        a33: {M33: one},
        a23: {M23: half},
        a_norm2: {TRANSVERSE: 2 * one},
        x_end: {NORMAL: stretch**2},
        area: {PLANE: area / 2},
        j2: {C_RATE: 1 / dt_rate},
    }


def derivative_rules() -> dict[Generator, dict[tuple[Generator, Generator], sp.Expr]]:
    """dG/dC of the generators that depend on C, as sums of A (.) B; a generator not listed is constant."""
    (dt_rate,) = sym("dt_rate")
    return {
        C_INVERSE: {(C_INVERSE, C_INVERSE): -sp.S.One},
        FIBRE_C: {(FIBRE, ONE): sp.Integer(2)},
        PLANE: {(PLANE, PLANE): -sp.S.One},
        C_RATE: {(ONE, ONE): 1 / dt_rate},
    }


def odot(first: sp.Matrix, second: sp.Matrix, i: int, j: int, k: int, m: int) -> sp.Expr:
    """Component ijkm of the symmetrised product A (.) B."""
    a, b = first, second
    return (a[i, k] * b[j, m] + a[i, m] * b[j, k] + b[i, k] * a[j, m] + b[i, m] * a[j, k]) / 4
