"""References of the blocks of the tangent and of the printed invariants, as in `stress_blocks`."""

from __future__ import annotations

from functools import cache
from itertools import product

import mpmath as mp
import sympy as sp

from umataudit.numbers import UNIT, Matrix, Number, combined, evaluate, matrix
from umataudit.setting import Setting
from umataudit.stress_blocks import Inputs, Outputs, Reference, device_of
from umatgen.model import stress, tangent
from umatgen.model.generators import (
    C_INVERSE,
    C_RATE,
    FIBRE,
    KIRCHHOFF,
    M22,
    M23,
    M33,
    NORMAL,
    ONE,
    PLANE,
    TRANSVERSE,
    VOIGT,
    Generator,
)
from umatgen.model.printed_invariants import invariants
from umatgen.notation import sym


@cache
def _directions(compaction: str) -> dict[str, dict[Generator, sp.Expr]]:
    """Gradients to C, in space, by the slope they go with.

    dx/dC = x^2 (C^-1 N) (x) (C^-1 N) is x n (x) n, n the unit normal of the deformed ply; and d(A:A)/dC.
    """
    stretch, a22, a33, a23, cos2, sin2 = sym("stretch", "a22", "a33", "a23", "cos2", "sin2")
    if compaction != "smallest":
        return {"dlng_stretch": {NORMAL: stretch / 2}, "dlng_a_norm2": {TRANSVERSE: sp.Integer(2)}}
    # the eigenvector of A at half the angle of Mohr's circle
    direction = {g: w / (4 * stretch) for g, w in ((M22, 1 - cos2), (M33, 1 + cos2), (M23, -sin2))}
    return {"dlng_stretch": direction, "dlng_a_norm2": {M22: 2 * a22, M33: 2 * a33, M23: 2 * a23}}


def _gradient(given: Inputs, setting: Setting) -> Outputs:
    """R = (g/J) sum of slope times the spatial form of 2 d(variable)/dC."""
    det_f, dt = given["det_f"], given["dt_rate"]
    terms = [(2 * given["dlng_j2"] / dt, given["y_rate"])]
    if "dlng_det_f" in given:
        terms.append((given["dlng_det_f"] * det_f, UNIT))
    if "dstretch_di1" in given:
        by = {v: given["dlng_stretch"] * given[f"dstretch_d{v}"] + given["dlng_a_norm2"] * given[f"dnorm2_d{v}"]
              for v in ("i1", "det_f")}  # fmt: skip
        terms += [(2 * by["i1"], given["b_left"]), (by["det_f"] * det_f, UNIT)]
    elif "dlng_stretch" in given:
        for slope, direction in ((name, d) for name, d in _directions(setting.compaction).items() if name in given):
            terms += [(2 * given[slope] * evaluate(e, given), given[g.key]) for g, e in direction.items() if g.key in given]
    return {"r_visc": [given["g_visc"] / det_f * total for total in combined(terms)]}


def _tangent(given: Inputs, setting: Setting) -> Outputs:
    """DDSDDE = (1/J)[sum of dyads and products] + y (x) r."""
    det_f = given["det_f"]
    forms = {g: list(given[g.key]) for g in (ONE, FIBRE, PLANE, C_RATE) if g.key in given}
    forms |= {C_INVERSE: UNIT, KIRCHHOFF: [det_f * s for s in given["stress"]]}
    coefficients = stress.elastic_stress(device_of(given), "alpha_e" in given, "kappa_held" in given)
    fourth = tangent.hyperelastic_dyads(coefficients)
    fourth += tangent.products(stress.named(coefficients)) + tangent.viscous_products() + tangent.jaumann_terms()
    total = mp.matrix(6)
    for left, row in fourth.dyads.items():
        for right, coefficient in row.items():
            total += _dyad(forms[left], forms[right]) * (evaluate(coefficient, given) / det_f)
    for (first, second), coefficient in fourth.products.items():
        total += _product(matrix(forms[first]), matrix(forms[second])) * (evaluate(coefficient, given) / det_f)
    if "r_visc" in given:
        total += _dyad(given["y_rate"], given["r_visc"])
    return {"ddsdde": ((total + total.T) / 2 if setting.tangent == "symmetric" else total).tolist()}


def _dyad(left: list[Number], right: list[Number]) -> Matrix:
    return mp.matrix(left) * mp.matrix(right).T


def _product(a: Matrix, b: Matrix) -> Matrix:
    """A (.) B, six by six."""
    result = mp.matrix(6)
    for (row, (i, j)), (column, (k, m)) in product(enumerate(VOIGT), enumerate(VOIGT)):
        result[row, column] = (a[i, k] * b[j, m] + a[i, m] * b[j, k] + b[i, k] * a[j, m] + b[i, m] * a[j, k]) / 4
    return result


def _printed(given: Inputs, setting: Setting) -> Outputs:
    i1, det_f, chi_l, eps_lock = sym("i1", "det_f", "chi_l", "eps_lock")
    stage = "bleed" if "eps_lock" in given else "squeeze"
    result: Outputs = {}
    for name, value in zip(("stretch", "norm2"), invariants(stage), strict=True):
        in_full = value.subs(chi_l, sp.exp(-2 * eps_lock))
        result[f"p_{name}"] = evaluate(in_full, given)
        for variable in (i1, det_f):
            result[f"d{name}_d{variable.name}"] = evaluate(sp.diff(in_full, variable), given)
    return result


REFERENCES: dict[str, Reference] = {
    "gradient": _gradient, "tangent": _tangent, "printed_squeeze": _printed, "printed_bleed": _printed,
}  # fmt: skip
