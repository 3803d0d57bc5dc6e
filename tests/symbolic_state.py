"""A symbolic right Cauchy-Green tensor and exact rational states, to check rules componentwise."""

from __future__ import annotations

import sympy as sp

from umatgen.model.generators import (
    C_INVERSE,
    C_RATE,
    FIBRE,
    FIBRE_C,
    M22,
    M23,
    M33,
    NORMAL,
    ONE,
    PLANE,
    TRANSVERSE,
    Generator,
)
from umatgen.notation import sym

NAMES = "c11 c22 c33 c12 c13 c23"
C11, C22, C33, C12, C13, C23 = COMPONENTS = sp.symbols(NAMES, real=True)
C = sp.Matrix([[C11, C12, C13], [C12, C22, C23], [C13, C23, C33]])
C0 = sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"s{min(i, j)}{max(i, j)}", real=True))
DT = sym("dt_rate")[0]
N, P2, P3 = (sp.eye(3)[:, i] for i in range(3))

INVERSE = C.adjugate() / C.det()
X = 1 / INVERSE[2, 2]

MATERIAL: dict[Generator, sp.Matrix] = {
    ONE: sp.eye(3),
    C_INVERSE: INVERSE,
    FIBRE: N * N.T,
    FIBRE_C: N * (C * N).T + (C * N) * N.T,
    M22: P2 * P2.T,
    M33: P3 * P3.T,
    M23: P2 * P3.T + P3 * P2.T,
    TRANSVERSE: sp.diag(0, 1, 1) * C * sp.diag(0, 1, 1),
    NORMAL: X * (INVERSE * P3) * (INVERSE * P3).T,
    PLANE: INVERSE - X * (INVERSE * P3) * (INVERSE * P3).T,
    C_RATE: (C - C0) / DT,
}
INVARIANTS: dict[str, sp.Expr] = {
    "i1": C.trace(),
    "i4": C11,
    "i5": (N.T * C * C * N)[0],
    "det_f": sp.sqrt(C.det()),
    "a22": C22,
    "a33": C33,
    "a23": C23,
    "a_norm2": C22**2 + C33**2 + 2 * C23**2,
    "x_end": X,
    "area": sp.sqrt(C11 * C22 - C12**2),
    "j2": (((C - C0) / DT) ** 2).trace() / 2,
}


def derivative(expr: sp.Expr, i: int, j: int) -> sp.Expr:
    """D expr/dC_ij of a function of a symmetric tensor: half the plain derivative off the diagonal."""
    slope = sp.diff(expr, C[i, j])
    return slope if i == j else slope / 2


def states(count: int = 3) -> list[dict[sp.Symbol, sp.Rational]]:
    """Exact admissible states: C = U^2 with a rational U, so that J is rational too."""
    result = []
    for seed in range(1, count + 1):
        u = sp.Matrix([[10 + seed, seed, 2], [seed, 9, -1], [2, -1, 11 - seed]]) / 10
        value = u * u.T
        state = {C[i, j]: value[i, j] for i in range(3) for j in range(i, 3)}
        state |= {C0[i, j]: sp.Rational(i + 2 * j + seed, 7) for i in range(3) for j in range(i, 3)}
        state[DT] = sp.Rational(3, 7)
        result.append(state)
    return result
