"""References of the blocks up to the stress: moduli, kinematics, viscous factor, elastic coefficients, stress.

A reference says, with 30 digits, what a compiled block must return, as a function of the block's inputs by name and of the
scene's setting. It is written from `umatgen.model` alone; how the compiler orders, factors or shares
subexpressions does not enter.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import cache, partial

import mpmath as mp
import sympy as sp

from umataudit.numbers import (
    UNIT,
    Number,
    Value,
    combined,
    evaluate,
    invariants,
    material_forms,
    matrix,
    through_thickness,
    unit_dyad,
    voigt,
)
from umataudit.setting import Setting, frame
from umatgen.model import constraint, elastic, stress, viscous
from umatgen.model.chain import Definition
from umatgen.model.generators import C_INVERSE, C_RATE, M22, M23, M33, TRANSVERSE, gradient_rules
from umatgen.model.kinematics import strain_rate
from umatgen.notation import sym

Inputs = Mapping[str, Value]
Outputs = dict[str, Value]
Reference = Callable[[Inputs, Setting], Outputs]
SLOPES = ("det_f", "stretch", "a_norm2", "j2")


def device_of(names: Inputs) -> str:
    """Device of incompressibility, from what a block is given."""
    return "augmented" if "p_start" in names else "penalty" if "kappa_eff" in names else "none"


def _with(given: Inputs, definitions: Iterable[Definition]) -> Outputs:
    """The inputs and what is defined from them, in order; what is given stays."""
    values: Outputs = dict(given)
    for definition in definitions:
        if definition.symbol.name not in values:
            values[definition.symbol.name] = evaluate(definition.expr, values)
    return values


def _moduli(given: Inputs, setting: Setting) -> Outputs:
    return _with(given, (Definition(symbol, expr, "10") for symbol, expr in elastic.moduli().items()))


def _start(given: Inputs, setting: Setting) -> Outputs:
    values = invariants(mp.matrix(given["f0"]) * setting.turn, setting.compaction)
    return {"det_f_start": values["det_f"], "x_start": values["x_end"]}


def _compaction(given: Inputs, setting: Setting) -> Outputs:
    f1 = mp.matrix(given["f1"]) * setting.turn
    values = invariants(f1, setting.compaction)
    normal = f1.T ** -1 * unit_dyad(2, 2) * f1**-1  # F^-T N (x) F^-T N, of squared length 1/x
    projector = mp.eye(3) - values["x_end"] * normal
    return values | {"normal": voigt(values["x_end"] * normal), "plane": voigt(projector)}


def _kinematics(given: Inputs, setting: Setting) -> Outputs:
    f0, f1 = (mp.matrix(given[name]) * setting.turn for name in ("f0", "f1"))
    widened = mp.diag([1, given.get("widening", 1), 1])
    rate = (f1.T * f1 - widened * f0.T * f0 * widened) * given["per_time"]
    forms = material_forms(f1.T * f1)
    forms |= {C_RATE: rate, M22: unit_dyad(1, 1), M33: unit_dyad(2, 2), M23: unit_dyad(1, 2)}
    forms[TRANSVERSE] = (unit_dyad(1, 1) + unit_dyad(2, 2)) * f1.T * f1 * (unit_dyad(1, 1) + unit_dyad(2, 2))
    spatial = {g.key: voigt(f1 * form * f1.T) for g, form in forms.items() if g != C_INVERSE}
    components = {f"cdot_{i + 1}{j + 1}": rate[i, j] for i in range(3) for j in range(i, 3)}
    eps_rate = evaluate(strain_rate(setting.compaction), invariants(f1, setting.compaction) | components)
    in_host = setting.turn * rate * setting.turn.T
    counted = through_thickness(rate) if given.get("in_plane", 1) == 0 else rate
    return {**spatial, "j2": sum(entry**2 for entry in counted) / 2, "cdot": voigt(in_host), "eps_rate": eps_rate}


def _counted(given: Inputs, setting: Setting) -> Outputs:
    f1, in_host = mp.matrix(given["f1"]) * setting.turn, matrix(given["cdot"])
    return {"y_counted": voigt(f1 * through_thickness(setting.turn.T * in_host * setting.turn) * f1.T)}


@cache
def _flow_expressions(stage: str) -> dict[str, sp.Expr]:
    """The factor g = 2 dpsi_v/dJ2 and the slopes of ln g, with the gap as a function of the stretch and of k."""
    j2_eff, gap, stretch, k, a, chi_f = sym("j2_eff", "gap", "stretch", "k_gap", "a_rate", "chi_f")
    g = 2 * sp.diff(viscous.potential(stage), j2_eff)
    log_g = sp.log(g.subs(gap, stretch - k / sp.sqrt(chi_f)))
    variables = dict(zip(SLOPES, sym("det_f", "stretch", "a_norm2", "j2_eff"), strict=True))
    variables |= {"k_gap": k, "a_rate": a}
    slopes = {f"dlng_{name}": sp.diff(log_g, variable) for name, variable in variables.items()}
    chi_l, root, chi_ratio = sym("chi_l", "root_chi_l", "chi_ratio")  # root = exp(-eps_lock)
    slopes["dlng_eps_lock"] = -root * sp.diff(log_g.subs(chi_f, chi_l / chi_ratio).subs(chi_l, root**2), root)
    return {"g_visc": g} | slopes


def _flow(given: Inputs, setting: Setting, stage: str) -> Outputs:
    values = _with({"a_norm2": mp.mpf(1), **given}, viscous.law_definitions())
    values |= {name: evaluate(expr, values) for name, expr in _flow_expressions(stage).items()}
    flow = {f"dflow_{name}": values[f"dlng_{name}"] for name in SLOPES}
    return values | flow | {"g_flow": values["g_visc"], "j2_unit": evaluate(viscous.normaliser(stage), values)}


@cache
def _elastic_expressions(device: str, elastic_part: bool, holds_width: bool) -> dict[str, sp.Expr]:
    """Stress coefficients from the whole potential; the reported energy leaves out the carried pressure of `augmented`."""
    potential = stress.stored_energy(device, elastic_part, holds_width)
    energy = stress.stored_energy("penalty" if device == "augmented" else device, elastic_part, holds_width)
    result: dict[str, sp.Expr] = {"energy": energy, "pressure": constraint.pressure(device)}
    for invariant, gradient in gradient_rules().items():
        for generator, weight in gradient.items():
            name = stress.coefficient_name(generator).name
            result[name] = result.get(name, sp.S.Zero) + 2 * sp.diff(potential, invariant) * weight
    result["c_plane"] = sp.diff(potential, sym("excess")[0])  # 2 dU/dexcess (1/A) (A/2)
    return result


def _elastic(given: Inputs, setting: Setting) -> Outputs:
    expressions = _elastic_expressions(device_of(given), "mu_t" in given, "kappa_held" in given)
    values = dict(given)
    if "area" in given:
        values["excess"] = max(mp.log(given["area"]) + given["eps_lock"], mp.mpf(0))
    known = {name: expr for name, expr in expressions.items() if {s.name for s in expr.free_symbols} <= set(values)}
    return values | {name: evaluate(expr, values) for name, expr in known.items()}


def _stress(given: Inputs, setting: Setting) -> Outputs:
    if "f1" in given:
        return {"stress": _stress_by_push_forward(given, setting)}
    terms = [(given["g_visc"], given["y_rate"])]
    terms += [(given[n], UNIT if n == "c_unit" else given[n[2:]]) for n in given if n.startswith("c_")]
    return {"stress": [total / given["det_f"] for total in combined(terms)]}


def _stress_by_push_forward(given: Inputs, setting: Setting) -> list[Number]:
    """F S F^T/J with S in the material frame: c12, c13, i4 are the row of C along the fibre."""
    one, fibre, fibre_c, unit = (given.get(f"c_{name}", mp.mpf(0)) for name in ("b_left", "fibre", "fibre_c", "unit"))
    row, f1 = [given["i4"], given["c12"], given["c13"]], mp.matrix(given["f1"]) * setting.turn
    along = mp.matrix([[row[j] * (i == 0) + row[i] * (j == 0) for j in range(3)] for i in range(3)])
    rate = setting.turn.T * matrix(given["cdot"]) * setting.turn
    second = given["g_visc"] * rate + one * mp.eye(3) + fibre * unit_dyad(0, 0) + fibre_c * along
    plane = matrix(given["plane"]) * given["c_plane"] if "plane" in given else mp.zeros(3)
    return voigt((f1 * second * f1.T + unit * mp.eye(3) + plane) / given["det_f"])


REFERENCES: dict[str, Reference] = {
    "frame": frame, "moduli": _moduli, "start": _start, "compaction": _compaction, "kinematics": _kinematics, "counted": _counted,
    "squeeze": partial(_flow, stage="squeeze"), "bleed": partial(_flow, stage="bleed"),
    "elastic": _elastic, "stress": _stress,
}  # fmt: skip
