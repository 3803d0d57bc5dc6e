"""References of the blocks of the tangent, of the blend at the lock, and of the printed invariants."""

from __future__ import annotations

from functools import cache

import mpmath as mp
import sympy as sp

from umataudit.blocks import SLOPES, UNIT, Inputs, Outputs, block, device_of
from umataudit.numbers import Number, combined, evaluate, matrix
from umatgen.model import lock, stress, tangent
from umatgen.model.generators import C_INVERSE, C_RATE, FIBRE, KIRCHHOFF, M22, M23, M33, ONE, VOIGT, Generator
from umatgen.model.printed_invariants import invariants
from umatgen.notation import sym


def _spatial(given: Inputs, generator: Generator) -> list[Number]:
    return UNIT if generator == C_INVERSE else list(given[generator.key])


@cache
def _stretch_gradient() -> dict[Generator, sp.Expr]:
    """Gradient d stretch/dC = dx/dC/(2 stretch), x the smaller eigenvalue, with the direction by cos2, sin2."""
    cos2, sin2, stretch = sym("cos2", "sin2", "stretch")
    return {M22: (1 - cos2) / (4 * stretch), M33: (1 + cos2) / (4 * stretch), M23: -sin2 / (4 * stretch)}


@cache
def _norm_gradient() -> dict[Generator, sp.Expr]:
    """Gradient d(A:A)/dC."""
    a22, a33, a23 = sym("a22", "a33", "a23")
    return {M22: 2 * a22, M33: 2 * a33, M23: 2 * a23}


@block("gradient")
def _gradient(given: Inputs, kind: str) -> Outputs:
    """R = (g/J) sum of slope times the spatial form of 2 d(variable)/dC."""
    det_f, dt = given["det_f"], given["dt"]
    terms = [(2 * given["dlng_j2"] / dt, given["y_rate"])]
    if "dlng_det_f" in given:
        terms.append((given["dlng_det_f"] * det_f, UNIT))
    if "dstretch_di1" in given:
        by = {v: given["dlng_stretch"] * given[f"dstretch_d{v}"] + given["dlng_a_norm2"] * given[f"dnorm2_d{v}"]
              for v in ("i1", "det_f")}  # fmt: skip
        terms += [(2 * by["i1"], given["b_left"]), (by["det_f"] * det_f, UNIT)]
    elif "dlng_stretch" in given:
        directions = {"dlng_stretch": _stretch_gradient(), "dlng_a_norm2": _norm_gradient()}
        for slope, direction in ((name, d) for name, d in directions.items() if name in given):
            terms += [(2 * given[slope] * evaluate(e, given), given[g.key]) for g, e in direction.items()]
    return {"r_visc": [given["g_visc"] / det_f * total for total in combined(terms)]}


@block("tangent")
def _tangent(given: Inputs, kind: str) -> Outputs:
    """DDSDDE = (1/J)[sum of dyads and products] + y (x) r + I (x) r_lock."""
    det_f = given["det_f"]
    device, elastic_part = device_of(given), "alpha_e" in given
    forms = {g: _spatial(given, g) for g in (ONE, FIBRE, C_INVERSE, C_RATE) if g == C_INVERSE or g.key in given}
    forms[KIRCHHOFF] = [det_f * s for s in given["stress"]]
    coefficients = stress.elastic_stress(device, elastic_part)
    fourth = tangent.hyperelastic_dyads(coefficients)
    fourth += tangent.products(stress.named(coefficients)) + tangent.viscous_products() + tangent.jaumann_terms()
    total = [[mp.mpf(0)] * 6 for _ in range(6)]
    for left, row in fourth.dyads.items():
        for right, coefficient in row.items():
            _add_dyad(total, forms[left], forms[right], evaluate(coefficient, given) / det_f)
    for (first, second), coefficient in fourth.products.items():
        _add_product(total, matrix(forms[first]), matrix(forms[second]), evaluate(coefficient, given) / det_f)
    for vector, name in ((given["y_rate"], "r_visc"), (UNIT, "r_lock")):
        if name in given:
            _add_dyad(total, vector, given[name], mp.mpf(1))
    if kind == "symmetric":
        total = [[(total[i][j] + total[j][i]) / 2 for j in range(6)] for i in range(6)]
    return {"ddsdde": total}


def _add_dyad(total: list[list[Number]], left: list[Number], right: list[Number], scale: Number) -> None:
    for i in range(6):
        for j in range(6):
            total[i][j] += scale * left[i] * right[j]


def _add_product(total: list[list[Number]], a: list[list[Number]], b: list[list[Number]], scale: Number) -> None:
    """Add scale * A (.) B."""
    for row, (i, j) in enumerate(VOIGT):
        for column, (k, m) in enumerate(VOIGT):
            value = a[i][k] * b[j][m] + a[i][m] * b[j][k] + b[i][k] * a[j][m] + b[i][m] * a[j][k]
            total[row][column] += scale * value / 4


@block("blend")
def _blend(given: Inputs, kind: str) -> Outputs:
    values: Outputs = dict(given)
    values["g_visc"] = evaluate(lock.blended_factor().expr, values)
    for name in SLOPES:
        parts = [mp.mpf(given[f"dlng{letter}_{name}"]) for letter in "sb"]
        shares = [(1 - given["s_lock"]) * given["g_squeeze"], given["s_lock"] * given["g_bleed"]]
        values[f"dlng_{name}"] = mp.fdot(shares, parts) / values["g_visc"]
    through = (given["g_bleed"] - given["g_squeeze"]) * given["ds_dstretch"] / values["g_visc"]
    values["dlng_stretch"] += through
    values["kappa_eff"] = (1 - given["s_lock"]) * given["kappa"]
    return values


@block("lock_gradient")
def _lock_gradient(given: Inputs, kind: str) -> Outputs:
    """(1/J) 2 d[kappa_eff (J - 1) J]/d stretch, with kappa_eff = (1 - s) kappa, times d stretch/dC in space."""
    slope = -given["kappa"] * given["ds_dstretch"] * (given["det_f"] - 1) * given["det_f"]
    terms = [(evaluate(e, given), given[g.key]) for g, e in _stretch_gradient().items()]
    return {"r_lock": [2 * slope / given["det_f"] * total for total in combined(terms)]}


@block("printed_squeeze", "printed_bleed")
def _printed(given: Inputs, kind: str) -> Outputs:
    i1, det_f, chi_l, eps_lock = sym("i1", "det_f", "chi_l", "eps_lock")
    stage = "bleed" if "eps_lock" in given else "squeeze"
    result: Outputs = {}
    for name, value in zip(("stretch", "norm2"), invariants(stage), strict=True):
        in_full = value.subs(chi_l, sp.exp(-2 * eps_lock))
        result[f"p_{name}"] = evaluate(in_full, given)
        for variable in (i1, det_f):
            result[f"d{name}_d{variable.name}"] = evaluate(sp.diff(in_full, variable), given)
    return result
