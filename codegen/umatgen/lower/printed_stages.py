"""Stages of the scene with the invariants as printed, in I1 and I3."""

from __future__ import annotations

import sympy as sp

from umatgen.lower.assign import Assignment, element
from umatgen.lower.stage import Stage, make_stage
from umatgen.lower.tensor import combination
from umatgen.model import tangent
from umatgen.model.generators import C_INVERSE, C_RATE, ONE, Generator
from umatgen.model.printed_invariants import invariants
from umatgen.notation import sym

_SLOPES = ("det_f", "stretch", "a_norm2", "j2")


def printed_stage(stage: str) -> Stage:
    """Stretch and (I1-1)^2 - 2 I3 from I1 and I3, with their derivatives."""
    i1, det_f, eps_lock = sym("i1", "det_f", "eps_lock")
    body = [Assignment("chi_l", sp.exp(-2 * eps_lock))] if stage == "bleed" else []
    for name, value in zip(("stretch", "norm2"), invariants(stage), strict=True):
        body.append(Assignment(f"p_{name}", value))
        body += [Assignment(f"d{name}_d{v.name}", sp.diff(value, v)) for v in (i1, det_f)]
    inputs = "i1 det_f eps_lock" if stage == "bleed" else "i1 det_f"
    return make_stage(
        f"printed_{stage}", f"Invariants of the {stage} stage as printed, in I1 and I3", "13" if stage == "squeeze" else "14",
        inputs, "p_stretch p_norm2 dstretch_di1 dstretch_ddet_f dnorm2_di1 dnorm2_ddet_f", body,
    )  # fmt: skip


def printed_gradient_stage(kind: str) -> Stage:
    """(g/J) times the spatial form of 2 d ln g/dC with the printed invariants: only I1, J and J2 are left."""
    i1, det_f, g_visc, dt_rate = sym("i1", "det_f", "g_visc", "dt_rate")
    slopes = {n: tangent.slope_name(sym(n)[0]) for n in _SLOPES}
    through = {
        v: slopes["stretch"] * element(f"dstretch_d{v.name}") + slopes["a_norm2"] * element(f"dnorm2_d{v.name}")
        for v in (i1, det_f)
    }
    through[det_f] += slopes["det_f"]
    gradient: dict[Generator, sp.Expr] = {C_RATE: 2 * slopes["j2"] / dt_rate}
    if kind != "paper":
        gradient |= {ONE: 2 * through[i1], C_INVERSE: det_f * through[det_f]}
    scale = element("g_per_volume")
    body = [Assignment("g_per_volume", g_visc / det_f)]
    names = {}
    for generator, coefficient in gradient.items():
        body.append(Assignment(f"w_{generator.key}", scale * coefficient))
        names[generator] = element(f"w_{generator.key}")
    body += combination("r_visc", names)
    rest = "" if kind == "paper" else (
        " dlng_det_f dlng_stretch dlng_a_norm2 dstretch_di1 dstretch_ddet_f dnorm2_di1 dnorm2_ddet_f b_left"
    )  # fmt: skip
    return make_stage(
        "gradient", "Gradient of the viscous factor, right factor of y (x) r, printed invariants", "13, 14, 16",
        f"det_f dt_rate g_visc dlng_j2{rest} y_rate", "r_visc", body,
    )  # fmt: skip
