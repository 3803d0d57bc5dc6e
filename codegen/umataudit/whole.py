"""A whole call of the UMAT from the registered potentials: stress, and the tangent by differentiating the stress.

No tangent formula enters: DDSDDE = (1/J) dtau/deps is a central difference of the Kirchhoff stress tau for stretching
perturbations (1 + e) F, with 60 digits and steps of 1e-20, good to 30 digits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import mpmath as mp
import sympy as sp

from umataudit.numbers import (
    WORKING_DIGITS,
    Matrix,
    Number,
    Value,
    evaluate,
    invariants,
    material_forms,
    unit_dyad,
    voigt,
)
from umataudit.states import State
from umatgen.model import elastic, printed_invariants, stress, viscous
from umatgen.model.generators import VOIGT
from umatgen.notation import sym

_STEP_EXPONENT = -20
Scene = Mapping[str, Any]
Constants = Mapping[str, Value]


def supported(scene: Scene) -> bool:
    """Whether a whole call can be evaluated; scenes with constants from a table over temperature cannot."""
    return not scene.get("table")


def expected_call(state: State, scene: Scene) -> tuple[list[Number], list[list[Number]]]:
    """Cauchy stress (6) and DDSDDE (6, 6) in MPa of one call with zero state variables; no DDSDDE where the scene has none."""
    with mp.workdps(WORKING_DIGITS):
        tau, f1 = _kirchhoff(state, scene), mp.matrix(state.f1)
        J, step = mp.det(f1), mp.mpf(10) ** _STEP_EXPONENT
        columns = []
        for k, m in VOIGT if scene["tangent"] != "none" else ():
            stretching = unit_dyad(k, m) * (step if k == m else step / 2)  # engineering shear
            columns.append(voigt(tau(f1 + stretching * f1) - tau(f1 - stretching * f1)))
        rows = mp.matrix(columns).T / (2 * step * J) if columns else mp.matrix(0, 0)
        if scene["tangent"] == "symmetric":
            rows = (rows + rows.T) / 2
        return voigt(tau(f1) / J), rows.tolist()


def _kirchhoff(state: State, scene: Scene) -> Callable[[Matrix], Matrix]:
    """The function F1 -> tau; with the paper's tangent f keeps its value at the end of the increment."""
    constants = state.given | {"p_start": mp.mpf(0)}
    for symbol, expr in elastic.moduli().items():
        constants[symbol.name] = evaluate(expr, constants)
    f0, f1 = mp.matrix(state.f0), mp.matrix(state.f1)
    frozen = _factor(f1, state.flow, scene, constants) if scene["tangent"] == "paper" else None
    device = str(scene.get("incompressibility", "penalty"))
    terms = stress.elastic_stress(device, bool(scene.get("elastic", True)))

    def tau(f: Matrix) -> Matrix:
        rate = (f.T * f - f0.T * f0) / state.dt
        values = constants | invariants(f)
        factor = frozen if frozen is not None else _factor(f, state.flow, scene, constants)
        j2 = sum(entry**2 for entry in rate) / 2 + constants["j2_floor"]
        second = (constants["a_rate"] + 2) * factor * j2 ** (constants["a_rate"] / 2) * rate
        forms = material_forms(f.T * f)
        for generator, coefficient in terms.items():
            second += evaluate(coefficient, values) * forms[generator]
        return f * second * f.T

    return tau


def _factor(f: Matrix, flow: str, scene: Scene, constants: Constants) -> Number:
    """The factor f of psi_v = f J2^((a+2)/2) at a deformation gradient."""
    values = dict(constants) | invariants(f)
    if scene.get("compaction") == "printed":
        chi_l, eps_lock = sym("chi_l", "eps_lock")
        in_full = [value.subs(chi_l, sp.exp(-2 * eps_lock)) for value in printed_invariants.invariants(flow)]
        values["stretch"], values["a_norm2"] = (evaluate(value, values) for value in in_full)
    for definition in viscous.law_definitions():
        values[definition.symbol.name] = evaluate(definition.expr, values)
    return evaluate(viscous.factor_f(flow), values)
