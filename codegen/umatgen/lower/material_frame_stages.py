"""Stages of the material frame: S and dS/dE = 2 dS/dC straight from the generators' material forms.

They take the places (names) of the spatial stages in the point routine: `stress` then holds the second
Piola-Kirchhoff stress and `ddsdde` the symmetric part of 2 dS/dC, both in the material basis with the fibre
along axis 1, where all generators but C^-1, Cdot and n (x) Cn + Cn (x) n are constants. Nothing is pushed
forward.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import sympy as sp

from umatgen.lower.assign import Assignment, element
from umatgen.lower.blocks import derive
from umatgen.lower.kinematic_stages import column, cross, dot
from umatgen.lower.kinematic_stages import kinematics_stage as spatial_kinematics
from umatgen.lower.material_stages import model_chain
from umatgen.lower.stage import Stage, Variable, make_stage
from umatgen.model import stress, tangent
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
    VOIGT,
    Generator,
    odot,
)
from umatgen.model.tangent import FourthOrder
from umatgen.notation import sym
from umatgen.scene import Scene

_CONSTANT = {
    ONE: (1, 1, 1, 0, 0, 0),
    FIBRE: (1, 0, 0, 0, 0, 0),
    M22: (0, 1, 0, 0, 0, 0),
    M33: (0, 0, 1, 0, 0, 0),
    M23: (0, 0, 0, 0, 0, 1),
}
_RATES = ("cdot", "j2", "eps_rate")
_ARRAYS = {"c_inverse": "C^-1 [-]"}
_NOTES = {
    "stress": "second Piola-Kirchhoff stress S [MPa]",
    "ddsdde": "symmetric part of dS/dE [MPa]",
    "r_visc": "2 dg/dC [MPa s]",
    "c12": "C12 [-]",
    "c13": "C13 [-]",
}


def derive_material_frame(scene: Scene) -> list[Stage]:
    """Stages of a scene with stress and tangent in the material frame, before any pass."""
    own: dict[str, Callable[[], Stage]] = {
        "kinematics": lambda: kinematics_stage(scene),
        "counted": counted_stage,
        "stress": lambda: stress_stage(scene),
        "gradient": lambda: gradient_stage(scene),
        "tangent": lambda: tangent_stage(scene),
    }
    return [own[s.name]() if s.name in own else _with_notes(s) for s in derive(scene)]


def component(generator: Generator, index: int) -> sp.Expr:
    """Voigt component (0-based) of the material form of a generator."""
    if generator in _CONSTANT:
        return sp.Integer(_CONSTANT[generator][index])
    if generator == FIBRE_C:
        i4, c12, c13 = sym("i4", "c12", "c13")
        return (2 * i4, sp.S.Zero, sp.S.Zero, c12, c13, sp.S.Zero)[index]
    if generator == TRANSVERSE:
        a22, a33, a23 = sym("a22", "a33", "a23")
        return (sp.S.Zero, a22, a33, sp.S.Zero, sp.S.Zero, a23)[index]
    if generator == NORMAL:
        u, v, x_end = sym("tilt_1", "tilt_2", "x_end")
        return (u**2, v**2, sp.S.One, u * v, u, v)[index] / x_end
    if generator == PLANE:
        return component(C_INVERSE, index) - component(NORMAL, index)
    names = {C_INVERSE: "c_inverse", C_RATE: "cdot"}
    return element(f"{names[generator]}({index + 1})")


def _matrix(generator: Generator) -> sp.Matrix:
    result = sp.zeros(3, 3)
    for index, (i, j) in enumerate(VOIGT):
        result[i, j] = result[j, i] = component(generator, index)
    return result


def _combination(target: str, terms: Mapping[Generator, sp.Expr], scale: sp.Expr = sp.S.One) -> list[Assignment]:
    return [
        Assignment(f"{target}({n + 1})", sp.Add(*(scale * c * component(g, n) for g, c in terms.items())))
        for n in range(6)
    ]


def kinematics_stage(scene: Scene) -> Stage:
    """Rate of C as in the spatial stage, with C^-1 in place of the spatial generators."""
    spatial = spatial_kinematics(scene)
    body = [*_needed(spatial.assignments, _RATES), *_inverse()]
    made = _made("kinematics", "Rate of C, and C^-1", spatial.equation, (*_RATES, "c_inverse"), body)
    return replace(made, local_arrays=spatial.local_arrays, sharing="none")


def _needed(assignments: Sequence[Assignment], wanted: Sequence[str]) -> list[Assignment]:
    """The assignments that `wanted` depend on, in order."""
    names, kept = set(wanted), []
    for assignment in reversed(assignments):
        if assignment.target.split("(")[0] in names or assignment.target in names:
            names |= {symbol.name for symbol in assignment.expr.free_symbols}
            kept.append(assignment)
    return kept[::-1]


def _inverse() -> list[Assignment]:
    """C^-1 = F^-1 F^-T from the rows of F^-1, which are area vectors of F over J: no small differences."""
    (det_f,) = sym("det_f")
    columns = [column("f1", j) for j in (1, 2, 3)]
    names = [[f"row{i}_{j}" for j in (1, 2, 3)] for i in (1, 2, 3)]
    body = [Assignment("inverse_j", 1 / det_f)]
    for i in range(3):
        area = cross(columns[(i + 1) % 3], columns[(i + 2) % 3])
        body += [Assignment(names[i][j], area[j] * element("inverse_j")) for j in range(3)]
    rows = [(element(a), element(b), element(c)) for a, b, c in names]
    body += [Assignment(f"c_inverse({n + 1})", dot(rows[i], rows[j])) for n, (i, j) in enumerate(VOIGT)]
    return body


def counted_stage() -> Stage:
    """The rates that J2 counts in the increment that passes the lock: those through the thickness."""
    body = [Assignment(f"y_counted({n})", element(f"cdot({n})") if n in (3, 5, 6) else sp.S.Zero) for n in range(1, 7)]
    return _made("counted", "Rate through the thickness", "15, 16", ("y_counted",), body)


def stress_stage(scene: Scene) -> Stage:
    """Second Piola-Kirchhoff stress S = 2 dpsi_e/dC + 2 dpsi_v/dCdot + S_vol (Eqs. 8, 15)."""
    total = stress.add(stress.named(stress.elastic_stress(scene.device, scene.elastic, scene.holds_width)), stress.viscous_stress())
    return _made("stress", "Second Piola-Kirchhoff stress", "8, 15", ("stress",), _combination("stress", total))


def gradient_stage(scene: Scene) -> Stage:
    """2 dg/dC: factor of the viscous dyad of the tangent."""
    variables = sym("j2") if scene.tangent == "paper" else tangent.VARIABLES
    gradient = tangent.viscous_gradient(variables, model_chain(scene.compaction))
    body = _combination("r_visc", gradient, sym("g_visc")[0])
    return _made("gradient", "Gradient of the viscous factor", "15, 16", ("r_visc",), body)


def tangent_stage(scene: Scene) -> Stage:
    """Symmetric part of 2 dS/dC (Eq. 16): upper triangle by components, then mirrored."""
    coefficients = stress.elastic_stress(scene.device, scene.elastic, scene.holds_width)
    fourth = tangent.hyperelastic_dyads(coefficients)
    fourth += tangent.products(stress.named(coefficients)) + tangent.viscous_products()
    body = _upper_triangle(fourth)
    body += [
        Assignment(f"ddsdde({column},{row})", element(f"ddsdde({row},{column})"))
        for row in range(1, 7)
        for column in range(row + 1, 7)
    ]
    return _made("tangent", "Symmetric part of the material tangent dS/dE = 2 dS/dC", "16", ("ddsdde",), body)


def _upper_triangle(fourth: FourthOrder) -> list[Assignment]:
    body = []
    matrices = {g: _matrix(g) for pair in fourth.products for g in pair}
    rights = [(C_RATE, "r_visc")]
    for row, (i, j) in enumerate(VOIGT):
        for col in range(row, 6):
            k, m = VOIGT[col]
            terms = [c * odot(matrices[a], matrices[b], i, j, k, m) for (a, b), c in fourth.products.items()]
            for left, line in fourth.dyads.items():
                terms += [c * component(left, row) * component(right, col) for right, c in line.items()]
            for left, right in rights:
                terms.append(component(left, row) * element(f"{right}({col + 1})") / 2)
                terms.append(element(f"{right}({row + 1})") * component(left, col) / 2)
            body.append(Assignment(f"ddsdde({row + 1},{col + 1})", sp.factor_terms(sp.Add(*terms))))
    return body


def _made(name: str, title: str, equation: str, outputs: Sequence[str], body: Sequence[Assignment]) -> Stage:
    """Make a stage whose inputs, in alphabetical order, are what its body uses and does not define."""
    used = {symbol.name.split("(")[0] for a in body for symbol in a.expr.free_symbols}
    inputs = sorted(used - {a.target.split("(")[0] for a in body})
    made = make_stage(name, title, equation, " ".join(inputs), " ".join(outputs), body)
    return _with_notes(made)


def _with_notes(stage: Stage) -> Stage:
    """A stage whose variables are described as what they are in the material frame."""
    return replace(stage, inputs=tuple(map(_noted, stage.inputs)), outputs=tuple(map(_noted, stage.outputs)))


def _noted(variable: Variable) -> Variable:
    if variable.name in _ARRAYS:
        return Variable(variable.name, (6,), _ARRAYS[variable.name])
    note = _NOTES.get(variable.name, variable.note.replace(" in tau ", " in S "))
    return replace(variable, note=note)
