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
    Number,
    Value,
    determinant,
    evaluate,
    inverse,
    product,
    transposed,
    voigt,
)
from umataudit.states import State
from umatgen.model import elastic, stress, viscous
from umatgen.model.generators import C_INVERSE, FIBRE, FIBRE_C, ONE, VOIGT, Generator
from umatgen.model.printed_invariants import invariants
from umatgen.notation import sym

_STEP_EXPONENT = -20
Matrix = list[list[Number]]


def supported(scene: Mapping[str, Any]) -> bool:
    """Whether a whole call can be evaluated.

    Scenes with a state of their own (blend), or with constants from a table over temperature, are compared block by block only.
    """
    return bool(scene.get("lock", "instant") != "blend" and not scene.get("table"))


def expected_call(state: State, scene: Mapping[str, Any]) -> tuple[list[Number], Matrix]:
    """Cauchy stress (6) and DDSDDE (6, 6) in MPa of one call with zero state variables; no DDSDDE where the scene has none."""
    with mp.workdps(WORKING_DIGITS):
        tau = _kirchhoff(state, scene)
        J = determinant(state.f1)
        cauchy = [component / J for component in voigt(tau(state.f1))]
        step = mp.mpf(10) ** _STEP_EXPONENT
        columns = []
        for k, m in VOIGT if scene["tangent"] != "none" else ():
            above, below = (voigt(tau(_stretched(state.f1, k, m, sign * step))) for sign in (1, -1))
            columns.append([(a - b) / (2 * step * J) for a, b in zip(above, below, strict=True)])
        rows = transposed(columns) if columns else []
        if scene["tangent"] == "symmetric":
            rows = [[(rows[i][j] + rows[j][i]) / 2 for j in range(6)] for i in range(6)]
        return cauchy, rows


def _stretched(f: Value, k: int, m: int, step: Number) -> Matrix:
    """(1 + e) F with e_km = e_mk = step/2 (engineering shear), or e_kk = step."""
    e = [[mp.mpf(int(i == j)) for j in range(3)] for i in range(3)]
    e[k][m] += step / 2
    e[m][k] += step / 2
    return product(e, f)


def _kirchhoff(state: State, scene: Mapping[str, Any]) -> Callable[[Value], Matrix]:
    """The function F1 -> tau; with the paper's tangent f keeps its value at the end of the increment."""
    constants = _constants(state)
    frozen = _factor(state.f1, state, scene, constants) if scene["tangent"] == "paper" else None
    c0 = product(transposed(state.f0), state.f0)

    def tau(f: Value) -> Matrix:
        c = product(transposed(f), f)
        rate = [[(c[i][j] - c0[i][j]) / state.dt for j in range(3)] for i in range(3)]
        factor = frozen if frozen is not None else _factor(f, state, scene, constants)
        j2 = sum(entry**2 for row in rate for entry in row) / 2 + constants["j2_floor"]
        g = (constants["a_rate"] + 2) * factor * j2 ** (constants["a_rate"] / 2)
        device = str(scene.get("incompressibility", "penalty"))
        second = _hyperelastic(c, constants, stress.elastic_stress(device, bool(scene.get("elastic", True))))
        total = [[second[i][j] + g * rate[i][j] for j in range(3)] for i in range(3)]
        return product(f, total, transposed(f))

    return tau


def _constants(state: State) -> dict[str, Value]:
    """Constants of a call, with the moduli and the law's derived constants."""
    squeezing = state.flow == "squeeze"
    p: dict[str, Value] = dict(state.properties)
    p["b_log"] = p["b_squeeze"] if squeezing else p["b_bleed"]
    p["kappa_eff"] = p["kappa"] if squeezing else mp.mpf(0)
    p["p_start"] = mp.mpf(0)
    p["j2_floor"] = max(p["rate_floor"], p["strain_floor"] / state.dt) ** 2
    for symbol, expr in elastic.moduli().items():
        p[symbol.name] = evaluate(expr, p)
    return p


def _factor(f: Value, state: State, scene: Mapping[str, Any], constants: Mapping[str, Value]) -> Number:
    """The factor f of psi_v = f J2^((a+2)/2) at a deformation gradient."""
    c = product(transposed(f), f)
    values: dict[str, Value] = dict(constants)
    values |= {"det_f": determinant(f), "i1": c[0][0] + c[1][1] + c[2][2]}
    if scene.get("invariants") == "printed":
        chi_l, eps_lock = sym("chi_l", "eps_lock")
        in_full = [value.subs(chi_l, sp.exp(-2 * eps_lock)) for value in invariants(state.flow)]
        values["stretch"], values["a_norm2"] = (evaluate(value, values) for value in in_full)
    else:
        mean, difference = (c[1][1] + c[2][2]) / 2, (c[1][1] - c[2][2]) / 2
        values["stretch"] = mp.sqrt(mean - mp.sqrt(difference**2 + c[1][2] ** 2))
        values["a_norm2"] = c[1][1] ** 2 + c[2][2] ** 2 + 2 * c[1][2] ** 2
    for definition in viscous.law_definitions():
        values[definition.symbol.name] = evaluate(definition.expr, values)
    return evaluate(viscous.factor_f(state.flow), values)


def _hyperelastic(c: Matrix, constants: Mapping[str, Value], terms: Mapping[Generator, sp.Expr]) -> Matrix:
    """Elastic and volumetric part of S."""
    n_c = [[c[0][j] if i == 0 else mp.mpf(0) for j in range(3)] for i in range(3)]
    forms = {
        ONE: [[mp.mpf(int(i == j)) for j in range(3)] for i in range(3)],
        C_INVERSE: inverse(c),
        FIBRE: [[mp.mpf(int(i == j == 0)) for j in range(3)] for i in range(3)],
        FIBRE_C: [[n_c[i][j] + n_c[j][i] for j in range(3)] for i in range(3)],
    }
    values = dict(constants)
    values |= {
        "det_f": mp.sqrt(determinant(c)), "i1": c[0][0] + c[1][1] + c[2][2], "i4": c[0][0], "i5": product(c, c)[0][0],
    }  # fmt: skip
    coefficients = {g: evaluate(e, values) for g, e in terms.items()}
    return [[mp.fsum(coefficients[g] * forms[g][i][j] for g in coefficients) for j in range(3)] for i in range(3)]
