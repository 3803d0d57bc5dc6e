"""A whole call of the UMAT from the registered potentials: stress, and the tangent by differentiating the stress.

No tangent formula enters: DDSDDE = (1/J) dtau/deps is a central difference of the Kirchhoff stress tau for stretching
perturbations (1 + e) F, with 60 digits and steps of 1e-20, good to 30 digits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import mpmath as mp
import sympy as sp

from umataudit.creep_blocks import factor, path_mean
from umataudit.numbers import (
    WORKING_DIGITS,
    Matrix,
    Number,
    Value,
    evaluate,
    invariants,
    material_forms,
    rounded,
    through_thickness,
    unit_dyad,
    voigt,
)
from umataudit.setting import Scene, Setting
from umataudit.states import State
from umatgen.model import elastic, printed_invariants, stress, viscous
from umatgen.model.generators import VOIGT
from umatgen.model.kinematics import strain_rate
from umatgen.notation import sym

_STEP_EXPONENT = -20
Constants = Mapping[str, Value]
Flow = Callable[[Number], Number]


def expected_call(state: State, scene: Scene) -> tuple[list[Number], list[list[Number]]]:
    """Cauchy stress (ntens) and DDSDDE (ntens, ntens) in MPa of one call; no DDSDDE where the scene has none."""
    with mp.workdps(WORKING_DIGITS):
        whole = Whole(state, scene)
        f1 = mp.matrix(state.f1)
        J, step = mp.det(f1), mp.mpf(10) ** _STEP_EXPONENT
        tau, columns = whole.kirchhoff, []
        for k, m in VOIGT[: whole.setting.ntens] if whole.setting.tangent != "none" else ():
            stretching = unit_dyad(k, m) * (step if k == m else step / 2)  # engineering shear
            columns.append(voigt(tau(f1 + stretching * f1) - tau(f1 - stretching * f1))[: whole.setting.ntens])
        rows = mp.matrix(columns).T / (2 * step * J) if columns else mp.matrix(0, 0)
        if whole.setting.tangent == "symmetric":
            rows = (rows + rows.T) / 2
        return voigt(tau(f1) / J)[: whole.setting.ntens], rows.tolist()


class Whole:
    """One state in one scene: the Kirchhoff stress as a function of F at the end of the increment."""

    def __init__(self, state: State, scene: Scene) -> None:
        self.state, self.scene, self.setting = state, scene, Setting.of(scene)
        self.law = "squeeze" if state.flow == "squeeze" else "bleed"
        self.constants = state.given | {"p_start": mp.mpf(0)}
        for symbol, expr in elastic.moduli().items():
            self.constants[symbol.name] = evaluate(expr, self.constants)
        self.turn = self.setting.basis(state.properties)
        f0 = mp.matrix(state.f0) * self.turn
        stretch = invariants(f0, self.setting.compaction)["stretch"]
        lock = mp.exp(state.properties["eps_lock"])
        widened = mp.diag([1, stretch / lock if state.flow == "cross" else 1, 1])
        self.c0 = widened * f0.T * f0 * widened
        self.constants |= {"stretch_start": stretch, "lock_stretch": lock, "exponent": 1 / (self.constants["a_rate"] + 1)}
        device, held = str(scene.get("incompressibility", "penalty")), scene.get("after_lock") == "held"
        self.terms = stress.elastic_stress(device, bool(scene.get("elastic", True)), held)
        f1 = mp.matrix(state.f1) * self.turn
        self.frozen = self.viscosity(f1) if self.setting.tangent == "paper" else None
        values = invariants(f1, self.setting.compaction)
        components = {f"cdot_{i + 1}{j + 1}": self.rate(f1)[i, j] for i in range(3) for j in range(i, 3)}
        self.eps_rate = evaluate(strain_rate(self.setting.compaction), values | components)
        self.stress_last: Number = None
        if scene.get("integrator") == "creep" and state.past is not None:
            self.stress_last = rounded(self.viscosity(f1)[1](self.j2(f1)) * state.past[0])

    def rate(self, f: Matrix) -> Matrix:
        """Rate of C in the material axes."""
        return (f.T * f - self.c0) / self.state.dt

    def j2(self, f: Matrix) -> Number:
        """J2 with its floor."""
        rate = through_thickness(self.rate(f)) if self.state.flow == "cross" else self.rate(f)
        return sum(entry**2 for entry in rate) / 2 + self.constants["j2_floor"]

    def kirchhoff(self, host: Matrix) -> Matrix:
        """Tau at an F in the host's axes; with the paper's tangent the viscosity keeps its value at the end of the increment."""
        f = host * self.turn
        values = self.constants | invariants(f, self.setting.compaction)
        values["excess"] = max(mp.log(values["det_f"] / values["stretch"]) + values["eps_lock"], mp.mpf(0))
        viscosity, j2 = self.frozen or self.viscosity(f), self.j2(f)
        g = viscosity[0](j2)
        if self.stress_last is not None:
            g *= (viscosity[1](j2) / self.stress_last) ** self.constants["history"]
        second = g * self.rate(f)
        forms = material_forms(f.T * f)
        for generator, coefficient in self.terms.items():
            second += evaluate(coefficient, values) * forms[generator]
        return f * second * f.T

    def viscosity(self, f: Matrix) -> tuple[Flow, Flow]:
        """G of S_v = g Cdot, and the mean effective stress, as functions of J2 at an F in the material axes."""
        values = dict(self.constants) | invariants(f, self.setting.compaction)
        if self.setting.compaction == "printed":
            chi_l, eps_lock = sym("chi_l", "eps_lock")
            in_full = [value.subs(chi_l, sp.exp(-2 * eps_lock)) for value in printed_invariants.invariants(self.law)]
            values["stretch"], values["a_norm2"] = (evaluate(value, values) for value in in_full)
        for definition in viscous.law_definitions():
            values[definition.symbol.name] = evaluate(definition.expr, values)
        a, scale, measure = values["a_rate"], (values["a_rate"] + 2) * evaluate(viscous.factor_f(self.law), values), mp.mpf(1)
        if self.scene.get("integrator") == "creep":
            delta = values["stretch_start"] / values["stretch"] - 1
            across = 1 / (1 + values["x_end"] ** 4) if self.law == "squeeze" else mp.mpf(0)
            path = path_mean(values, values["stretch"], self.state.flow)
            by_mean, measure = factor(path, delta, delta / mp.log(1 + delta), across, a)
            scale *= by_mean
        unit = 2 * values["a_norm2"] if self.law == "squeeze" else 2 * values["x_end"] ** 2
        of_stress = scale / values["det_f"] * mp.sqrt(unit) * measure
        return lambda j2: scale * j2 ** (a / 2), lambda j2: of_stress * j2 ** ((a + 1) / 2)
