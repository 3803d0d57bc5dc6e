"""The registered equations of each emitted block, evaluated with 30 digits: what a compiled block must return.

A reference is a function of the block's inputs by name. It is written from `umatgen.model` alone; how the compiler orders,
factors or shares subexpressions does not enter.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache

import mpmath as mp
import sympy as sp

from umatgen.audit.numbers import (
    Number,
    Value,
    combined,
    determinant,
    evaluate,
    matrix,
    product,
    transposed,
    voigt,
)
from umatgen.model import constraint, elastic, lock, stress, tangent, viscous
from umatgen.model.generators import (
    C_INVERSE, C_RATE, FIBRE, FIBRE_C, KIRCHHOFF, M22, M23, M33, ONE, VOIGT, Generator, gradient_rules,
)  # fmt: skip
from umatgen.model.kinematics import strain_rate_from_rates, transverse_definitions
from umatgen.model.printed_invariants import invariants
from umatgen.notation import sym

Inputs = Mapping[str, Value]
Outputs = dict[str, Value]
Reference = Callable[[Inputs, str], Outputs]
REFERENCES: dict[str, Reference] = {}
_UNIT = [mp.mpf(int(i == j)) for i, j in VOIGT]
_SLOPES = ("det_f", "stretch", "a_norm2", "j2")


class UnknownBlockError(KeyError):
    """An emitted block has no registered equations."""


def reference(name: str) -> Reference:
    """Reference of a block; called with its inputs and the scene's kind of tangent.

    Raises
    ------
    UnknownBlockError
        Names the block.
    """
    if name not in REFERENCES:
        raise UnknownBlockError(f"block '{name}' has no registered equations; add a reference in umatgen/audit/blocks.py")
    return REFERENCES[name]


def block(*names: str) -> Callable[[Reference], Reference]:
    """Decorator: the function is the reference of these blocks."""

    def add(function: Reference) -> Reference:
        for name in names:
            REFERENCES[name] = function
        return function

    return add


@block("moduli")
def _moduli(given: Inputs, kind: str) -> Outputs:
    values: Outputs = dict(given)
    for symbol, expr in elastic.moduli().items():
        values[symbol.name] = evaluate(expr, values)
    return values


@block("start")
def _start(given: Inputs, kind: str) -> Outputs:
    f0 = given["f0"]
    c = product(transposed(f0), f0)
    mean, difference = (c[1][1] + c[2][2]) / 2, (c[1][1] - c[2][2]) / 2
    return {"det_f_start": determinant(f0), "x_start": mean - mp.sqrt(difference**2 + c[1][2] ** 2)}


@block("kinematics")
def _kinematics(given: Inputs, kind: str) -> Outputs:
    f0, f1, dt = given["f0"], given["f1"], given["dt"]
    c0, c1 = product(transposed(f0), f0), product(transposed(f1), f1)
    rate = [[(c1[i][j] - c0[i][j]) / dt for j in range(3)] for i in range(3)]
    n = [[mp.mpf(int(i == j == 0)) for j in range(3)] for i in range(3)]
    n_c = product(n, c1)
    material = {
        ONE: [[mp.mpf(int(i == j)) for j in range(3)] for i in range(3)],
        FIBRE: n,
        FIBRE_C: [[n_c[i][j] + n_c[j][i] for j in range(3)] for i in range(3)],
        C_RATE: rate,
        M22: _unit_dyad(1, 1),
        M33: _unit_dyad(2, 2),
        M23: _unit_dyad(1, 2),
    }
    spatial = {g.key: voigt(product(f1, form, transposed(f1))) for g, form in material.items()}
    scalars = {
        "det_f": determinant(f1), "a22": c1[1][1], "a33": c1[2][2], "a23": c1[1][2],
        "area2": c1[1][1] * c1[2][2] - c1[1][2] ** 2, "a_diff": (c1[1][1] - c1[2][2]) / 2,
        "i1": sum(c1[i][i] for i in range(3)), "i4": c1[0][0], "i5": product(c1, c1)[0][0],
        "j2": sum(entry**2 for row in rate for entry in row) / 2,
    }  # fmt: skip
    return {**spatial, **scalars, "cdot": voigt(rate)}


def _unit_dyad(i: int, j: int) -> list[list[Number]]:
    result = [[mp.mpf(0)] * 3 for _ in range(3)]
    result[i][j] += 1
    if i != j:
        result[j][i] += 1
    return result


@block("transverse")
def _transverse(given: Inputs, kind: str) -> Outputs:
    values: Outputs = dict(given)
    for definition in transverse_definitions():
        values.setdefault(definition.symbol.name, evaluate(definition.expr, values))
    values["cos2"], values["sin2"] = (values[n] / values["radius"] for n in ("a_diff", "a23"))
    values["width"] = mp.sqrt(values["area2"] / values["x_min"])
    rates = dict(zip(("cdot_22", "cdot_33", "cdot_23"), (given["cdot"][n] for n in (1, 2, 5)), strict=True))
    values["eps_rate"] = evaluate(strain_rate_from_rates(), values | rates)
    return values


@cache
def _flow_expressions(stage: str) -> dict[str, sp.Expr]:
    """The factor g = 2 dpsi_v/dJ2 and the slopes of ln g, with the gap as a function of the stretch."""
    j2_eff, gap, stretch, limit = sym("j2_eff", "gap", "stretch", "stretch_limit")
    g = 2 * sp.diff(viscous.potential(stage), j2_eff)
    log_g = sp.log(g.subs(gap, stretch - limit))
    variables = dict(zip(_SLOPES, sym("det_f", "stretch", "a_norm2", "j2_eff"), strict=True))
    return {"g_visc": g} | {f"dlng_{name}": sp.diff(log_g, variable) for name, variable in variables.items()}


@block("squeeze")
def _squeeze(given: Inputs, kind: str) -> Outputs:
    return _flow(given, "squeeze")


@block("bleed")
def _bleed(given: Inputs, kind: str) -> Outputs:
    return _flow(given, "bleed")


def _flow(given: Inputs, stage: str) -> Outputs:
    values: Outputs = dict(given)
    values.setdefault("a_norm2", mp.mpf(1))
    for definition in viscous.law_definitions():
        values[definition.symbol.name] = evaluate(definition.expr, values)
    return values | {name: evaluate(expr, values) for name, expr in _flow_expressions(stage).items()}


def device_of(names: Mapping[str, Value]) -> str:
    """Device of incompressibility, from what a block is given."""
    return "augmented" if "p_start" in names else "penalty" if "kappa_eff" in names else "none"


@cache
def _elastic_expressions(device: str, elastic_part: bool) -> dict[str, sp.Expr]:
    energy = stress.stored_energy(device, elastic_part)
    result: dict[str, sp.Expr] = {"energy": energy, "pressure": constraint.pressure(device)}
    for invariant, gradient in gradient_rules().items():
        for generator, weight in gradient.items():
            name = stress.coefficient_name(generator).name
            result[name] = result.get(name, sp.S.Zero) + 2 * sp.diff(energy, invariant) * weight
    return result


@block("elastic")
def _elastic(given: Inputs, kind: str) -> Outputs:
    expressions = _elastic_expressions(device_of(given), "mu_t" in given)
    return {name: evaluate(expr, given) for name, expr in expressions.items()}


@block("stress")
def _stress(given: Inputs, kind: str) -> Outputs:
    terms = [(given["g_visc"], given["y_rate"])]
    for name in given:
        if name.startswith("c_"):
            terms.append((given[name], _UNIT if name == "c_unit" else given[name[2:]]))
    return {"stress": [total / given["det_f"] for total in combined(terms)]}


def _spatial(given: Inputs, generator: Generator) -> list[Number]:
    return _UNIT if generator == C_INVERSE else list(given[generator.key])


@cache
def _stretch_gradient() -> dict[Generator, sp.Expr]:
    """d stretch/dC = dx/dC/(2 stretch), x the smaller eigenvalue, with the direction by cos2, sin2."""
    cos2, sin2, stretch = sym("cos2", "sin2", "stretch")
    return {M22: (1 - cos2) / (4 * stretch), M33: (1 + cos2) / (4 * stretch), M23: -sin2 / (4 * stretch)}


@cache
def _norm_gradient() -> dict[Generator, sp.Expr]:
    """d(A:A)/dC."""
    a22, a33, a23 = sym("a22", "a33", "a23")
    return {M22: 2 * a22, M33: 2 * a33, M23: 2 * a23}


@block("gradient")
def _gradient(given: Inputs, kind: str) -> Outputs:
    """R = (g/J) sum of slope times the spatial form of 2 d(variable)/dC."""
    det_f, dt = given["det_f"], given["dt"]
    terms = [(2 * given["dlng_j2"] / dt, given["y_rate"])]
    if "dlng_det_f" in given:
        terms.append((given["dlng_det_f"] * det_f, _UNIT))
    if "dstretch_di1" in given:
        by = {v: given["dlng_stretch"] * given[f"dstretch_d{v}"] + given["dlng_a_norm2"] * given[f"dnorm2_d{v}"]
              for v in ("i1", "det_f")}  # fmt: skip
        terms += [(2 * by["i1"], given["b_left"]), (by["det_f"] * det_f, _UNIT)]
    elif "dlng_stretch" in given:
        for slope, direction in (("dlng_stretch", _stretch_gradient()), ("dlng_a_norm2", _norm_gradient())):
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
    for left, right in ((given["y_rate"], "r_visc"), (_UNIT, "r_lock")):
        if right in given:
            _add_dyad(total, left, given[right], mp.mpf(1))
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
    for name in _SLOPES:
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
