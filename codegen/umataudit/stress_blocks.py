"""References of the blocks up to the stress: moduli, kinematics, viscous factor, elastic coefficients, stress."""

from __future__ import annotations

from functools import cache

import mpmath as mp
import sympy as sp

from umataudit.blocks import SLOPES, UNIT, Inputs, Outputs, block, device_of
from umataudit.numbers import Number, combined, determinant, evaluate, matrix, product, transposed, voigt
from umatgen.model import constraint, elastic, stress, viscous
from umatgen.model.generators import C_RATE, FIBRE, FIBRE_C, M22, M23, M33, ONE, gradient_rules
from umatgen.model.kinematics import strain_rate_from_rates, transverse_definitions
from umatgen.notation import sym


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
        "j2": sum(entry**2 for row in rate for entry in row) / 2, "c12": c1[0][1], "c13": c1[0][2],
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
    if "cdot" in given:
        rates = dict(zip(("cdot_22", "cdot_33", "cdot_23"), (given["cdot"][n] for n in (1, 2, 5)), strict=True))
        values["eps_rate"] = evaluate(strain_rate_from_rates(), values | rates)
    return values


@cache
def _flow_expressions(stage: str) -> dict[str, sp.Expr]:
    """The factor g = 2 dpsi_v/dJ2 and the slopes of ln g, with the gap as a function of the stretch and of k."""
    j2_eff, gap, stretch, k, a, chi_f = sym("j2_eff", "gap", "stretch", "k_gap", "a_rate", "chi_f")
    g = 2 * sp.diff(viscous.potential(stage), j2_eff)
    log_g = sp.log(g.subs(gap, stretch - k / sp.sqrt(chi_f)))
    variables = dict(zip(SLOPES, sym("det_f", "stretch", "a_norm2", "j2_eff"), strict=True))
    variables |= {"k_gap": k, "a_rate": a}
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


@cache
def _elastic_expressions(device: str, elastic_part: bool) -> dict[str, sp.Expr]:
    """Stress coefficients from the whole potential; the reported energy leaves out the carried pressure of `augmented`."""
    potential = stress.stored_energy(device, elastic_part)
    energy = stress.stored_energy("penalty" if device == "augmented" else device, elastic_part)
    result: dict[str, sp.Expr] = {"energy": energy, "pressure": constraint.pressure(device)}
    for invariant, gradient in gradient_rules().items():
        for generator, weight in gradient.items():
            name = stress.coefficient_name(generator).name
            result[name] = result.get(name, sp.S.Zero) + 2 * sp.diff(potential, invariant) * weight
    return result


@block("elastic")
def _elastic(given: Inputs, kind: str) -> Outputs:
    expressions = _elastic_expressions(device_of(given), "mu_t" in given)
    known = {name: expr for name, expr in expressions.items() if {s.name for s in expr.free_symbols} <= set(given)}
    return {name: evaluate(expr, given) for name, expr in known.items()}


@block("stress")
def _stress(given: Inputs, kind: str) -> Outputs:
    if "f1" in given:
        return {"stress": _stress_by_push_forward(given)}
    terms = [(given["g_visc"], given["y_rate"])]
    for name in given:
        if name.startswith("c_"):
            terms.append((given[name], UNIT if name == "c_unit" else given[name[2:]]))
    return {"stress": [total / given["det_f"] for total in combined(terms)]}


def _stress_by_push_forward(given: Inputs) -> list[Number]:
    """F S F^T/J with S in the material frame: c12, c13, i4 are the row of C along the fibre."""
    row = [given["i4"], given["c12"], given["c13"]]
    coefficients = [given.get(name, mp.mpf(0)) for name in ("c_b_left", "c_fibre", "c_fibre_c")]
    second = [[given["g_visc"] * entry for entry in line] for line in matrix(given["cdot"])]
    for i in range(3):
        second[i][i] += coefficients[0]
        second[0][i] += coefficients[2] * row[i]
        second[i][0] += coefficients[2] * row[i]
    second[0][0] += coefficients[1]
    pushed = voigt(product(given["f1"], second, transposed(given["f1"])))
    unit = given.get("c_unit", mp.mpf(0))
    return [(value + unit * one) / given["det_f"] for value, one in zip(pushed, UNIT, strict=True)]
