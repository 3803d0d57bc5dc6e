"""Stages of the material: moduli, viscous factor of each flow stage, elastic coefficients, stress and tangent."""

from __future__ import annotations

import sympy as sp

from umatgen.lower.assign import Assignment, element, from_definitions
from umatgen.lower.stage import Stage, Variable, make_stage
from umatgen.lower.tensor import (
    combination,
    component,
    grouped_products,
    material_component,
    matrix,
    right_factors,
    symmetric_part,
    with_dyad,
)
from umatgen.model import constraint, elastic, held, stress, tangent, viscous
from umatgen.model.chain import Chain, Definition
from umatgen.model.generators import C_INVERSE, C_RATE, PLANE, VOIGT, Generator
from umatgen.model.kinematics import compaction_definitions, rate_definitions
from umatgen.notation import sym
from umatgen.scene import Scene


def model_chain(compaction: str = "normal", stage: str = "squeeze") -> Chain:
    """All named definitions of the model, in order."""
    closeness = viscous.factors(stage)[0]
    return Chain([*compaction_definitions(compaction), *rate_definitions(), *viscous.law_definitions(), closeness])


def moduli_stage() -> Stage:
    """Constants of Eq. 10 from the engineering constants."""
    body = [Assignment(symbol.name, expr) for symbol, expr in elastic.moduli().items()]
    return make_stage(
        "moduli", "Constants of the elastic potential from the transversely isotropic compliance", "10, Table 4",
        "e_l e_t nu_lt nu_tt g_lt", "mu_t mu_l lambda_e alpha_e beta_e", body, formula=(
            "K = inverse of the compliance of the normal components: lambda = K_23, alpha = K_12 - lambda, "
            "beta = K_11 - lambda - 2 alpha - 4 mu_L + 2 mu_T, mu_T = E_T/(2 (1 + nu_TT)), mu_L = G_LT.",
            "Table 4 prints G23 = 1.0; a transversely isotropic ply has G23 = E2/(2 (1 + nu23)).",
        ),
    )  # fmt: skip


def flow_stage(name: str, thermal: bool = False, baked: bool = False) -> Stage:
    """Viscous factor g of Eq. 15 for `squeeze` (Eq. 13) or `bleed` (Eq. 14), with the slopes of ln g.

    `thermal` adds the slopes in k, a and eps_lock, which a temperature table needs (that in b is 1). With `baked` constants exp(b) is
    one of them and the rest is a power; else both are one exponential.
    """
    log_g, chain = viscous.log_viscous_factor(name), model_chain(stage=name)
    body = from_definitions(_needed_definitions(name))
    body = [_one_exponential(a) if a.target == "rate" and not baked else a for a in body]
    body.append(Assignment("g_visc", viscous.viscous_factor()))
    variables = [*tangent.VARIABLES, *(sym("k_gap", "a_rate", "eps_lock") if thermal else ())]
    body += [Assignment(tangent.slope_name(v).name, chain.derivative(log_g, v)) for v in variables]
    outputs = "stretch_limit gap j2_unit g_visc " + " ".join(tangent.slope_name(v).name for v in variables)
    return make_stage(
        name, f"Viscous factor g of the {name} stage and the slopes of ln g", f"{viscous.EQUATION[name]}, 15",
        " ".join(_free(body, _PROPERTY_ORDER)), outputs, body, sharing="slopes", formula=_FLOW[name],
    )  # fmt: skip


_FLOW = {
    "squeeze": (
        "g = J ply micro rate/j2_unit = (a+2) f J2**(a/2), with exp(eps) = sqrt(x) = stretch:",
        "  ply = 2 (w0/h0)**2 exp(-4 eps)  (Eq. 4a)",
        "  micro = 2 sqrt(chi_l) exp(eps) k (closeness**2 + 3)  (Eq. 5a)",
        "  closeness = k/(sqrt(chi_f) exp(eps) - k), rate = exp(b) (J2/j2_unit)**(a/2), j2_unit = 2 A:A  (Eq. 13)",
        "The paper prints x**(+3/2) and A:A = (I1 - 1)**2 + 2 I3 in Eq. 13; Eqs. 3 to 5 give x**(-3/2) and - 2 I3.",
    ),
    "bleed": (
        "g = J ply micro rate/j2_unit = (a+2) f J2**(a/2), with exp(eps) = sqrt(x) = stretch:",
        "  ply = 2 (w0/h0)**2 chi_l exp(-2 eps)  (Eq. 4b)",
        "  micro = 2 (l0/d)**2 k closeness**2  (Eq. 5b)",
        "  closeness = k/(sqrt(chi_f) exp(eps) - k), rate = exp(b) (J2/j2_unit)**(a/2), j2_unit = 2 x**2  (Eq. 14)",
        "The paper prints I1 = C11**2 + ... and J2 = C11**2 before Eq. 14; the traces are C11 + ... and Cdot11**2/2.",
    ),
}


def _one_exponential(assignment: Assignment) -> Assignment:
    """exp(b) times a power as a single exponential."""
    b, a, j2_eff, j2_unit = sym("b_log", "a_rate", "j2_eff", "j2_unit")
    return Assignment(assignment.target, sp.exp(b + a / 2 * sp.log(j2_eff / j2_unit)))


_PROPERTY_ORDER = (
    "w0", "h0", "l0_over_d", "k_gap", "a_rate", "b_log", "eps_lock", "root_chi_l", "chi_ratio", "det_f", "stretch",
    "a_norm2", "j2_eff",
)  # fmt: skip


def _needed_definitions(stage: str) -> list[Definition]:
    """Definitions of the law that a flow stage uses, directly or through another, in order; it is given sqrt(chi_l)."""
    definitions = [*viscous.law_definitions()[1:], *viscous.factors(stage)]
    wanted = viscous.viscous_factor().free_symbols | {sym("gap")[0]}
    for definition in reversed(definitions):
        if definition.symbol in wanted:
            wanted |= definition.expr.free_symbols
    return [d for d in definitions if d.symbol in wanted]


def elastic_stage(scene: Scene) -> list[Stage]:
    """Coefficients of the elastic and volumetric Kirchhoff stress, stored energy and constraint pressure.

    No stage at all where none of them is kept.
    """
    device, coefficients = scene.device, _elastic(scene)
    if not coefficients:
        return []
    body = from_definitions([held.excess()]) if scene.holds_width else []
    body += [Assignment(stress.coefficient_name(g).name, c) for g, c in coefficients.items()]
    body.append(Assignment("energy", stress.stored_energy(_energy_device(device), scene.elastic, scene.holds_width)))
    body += [Assignment("pressure", constraint.pressure(device))] if device != "none" else []
    outputs = " ".join(a.target for a in body)
    formula = _ELASTIC if scene.elastic else ()
    return [make_stage(
        "elastic", "Coefficients of the generators in the elastic and volumetric stress", "8, 10",
        " ".join(_free(body, _ELASTIC_ORDER)), outputs, body, formula=formula + (_HELD if scene.holds_width else ()),
    )]  # fmt: skip


def _elastic(scene: Scene) -> stress.Combination:
    """All of S that is no viscous stress."""
    return stress.elastic_stress(scene.device, scene.elastic, scene.holds_width)


_ELASTIC = (
    "psi = (mu_T/2)(I1 - 3) - mu_T ln J + (lambda/2)(J - 1)**2 + [mu_T - mu_L + (alpha/2) ln J + (beta/8)(I4 - 1)](I4 - 1) "
    "- (1/2)(mu_T - mu_L)(I5 - 1) + (kappa/2)(J - 1)**2, S = 2 d psi/dC",
    "The paper prints + (mu_T - mu_L)/2 (I5 - 1) and alpha/4: with the plus sign F = I is not free of stress.",
)
_HELD = (
    "Width held after the lock (sec. 4.4: no further transverse expansion), excess = max(ln A + eps_lock, 0), A the area ratio in "
    "the ply plane, w = 1e-4: + kappa (excess**2/2 - w excess + w**2 ln(1 + excess/w)).",
)


def _energy_device(device: str) -> str:
    """The stored energy of the augmented device is that of its penalty: the carried pressure is no function of state."""
    return "penalty" if device == "augmented" else device


_ELASTIC_ORDER = ("mu_t", "mu_l", "lambda_e", "alpha_e", "beta_e", "kappa_eff", "p_start", "kappa_held", "eps_lock", "det_f", "i1",
                  "i4", "i5", "area")


def _free(body: list[Assignment], order: tuple[str, ...]) -> list[str]:
    """Names that the assignments use and do not define, in the given order."""
    used = {s.name.split("(")[0] for a in body for s in a.expr.free_symbols}
    return [name for name in order if name in used - {a.target for a in body}]


def stress_stage(scene: Scene) -> Stage:
    """Cauchy stress sigma = F S F^T/J."""
    total = stress.add(stress.named(_elastic(scene)), stress.viscous_stress())
    (det_f,) = sym("det_f")
    body = [Assignment("per_volume", 1 / det_f)]
    body += [Assignment(a.target, element("per_volume") * a.expr) for a in combination("stress", total)]
    order = (
        "det_f", "c_b_left", "c_fibre", "c_fibre_c", "c_unit", "c_plane", "g_visc", "b_left", "fibre", "fibre_c", "plane", "y_rate",
    )  # fmt: skip
    return make_stage(
        "stress", "Cauchy stress", "8, 9, 15", " ".join(_free(body, order)), "stress", body, sharing="none",
        formula=("sigma = (1/J)(sum of coefficient times spatial generator + g y), y = F Cdot F^T",),
    )  # fmt: skip


def pushed_stress_stage(scene: Scene) -> Stage:
    """Cauchy stress by one push-forward, F M F^T/J + c I/J, with M all of S but the part along C^-1 (and the ply plane).

    For scenes without a tangent, which have no other use for the single spatial generators.
    """
    total = stress.add(stress.named(_elastic(scene)), stress.viscous_stress())
    spatial = {g: total.pop(g) for g in (C_INVERSE, PLANE) if g in total}
    (det_f,) = sym("det_f")
    body = [Assignment("per_volume", 1 / det_f)]
    scaled: dict[Generator, sp.Expr] = {}
    for generator, coefficient in total.items():
        body.append(Assignment(f"s_{generator.key}", element("per_volume") * coefficient))
        scaled[generator] = element(f"s_{generator.key}")
    for index in range(6):
        terms = (c * material_component(g, index, scene.axes) for g, c in scaled.items())
        body.append(Assignment(f"m_all({index + 1})", sp.Add(*terms)))
    m_all, f1 = matrix("m_all"), sp.Matrix(3, 3, lambda i, j: element(f"f1({i + 1},{j + 1})"))
    product = f1 * m_all
    body += [Assignment(f"h_{i + 1}{j + 1}", product[i, j]) for i in range(3) for j in range(3)]
    for index, (i, j) in enumerate(VOIGT):
        value = sp.Add(*(element(f"h_{i + 1}{m + 1}") * f1[j, m] for m in range(3)))
        value += sp.Add(*(c * element("per_volume") * component(g, index) for g, c in spatial.items()))
        body.append(Assignment(f"stress({index + 1})", value))
    order = (
        "f1", "det_f", "c_b_left", "c_fibre", "c_fibre_c", "c_unit", "c_plane", "g_visc", "i4", "c12", "c13", "plane", "cdot",
    )  # fmt: skip
    return make_stage(
        "stress", "Cauchy stress by one push-forward", "8, 9, 15", " ".join(_free(body, order)), "stress", body,
        (Variable("m_all", (6,)),), sharing="none",
    )  # fmt: skip


def gradient_stage(scene: Scene) -> Stage:
    """(g/J) times the spatial form of 2 d ln g/dC: right factor of the viscous dyad of the tangent."""
    variables = sym("j2") if scene.tangent == "paper" else tangent.VARIABLES
    gradient = tangent.viscous_gradient(variables, model_chain(scene.compaction))
    det_f, g_visc = sym("det_f", "g_visc")
    body = [Assignment(f"w_{g.key}", g_visc / det_f * coefficient) for g, coefficient in gradient.items()]
    body += combination("r_visc", {g: element(f"w_{g.key}") for g in gradient})
    return make_stage(
        "gradient", "Gradient of the viscous factor, right factor of y (x) r", "15, 16",
        " ".join(_free(body, _GRADIENT_ORDER)), "r_visc", body,
        formula=("r = (g/J) F (2 d ln g/dC) F^T; dx/dC = x**2 (C**-1 N)(C**-1 N), in space x n n.",),
    )  # fmt: skip


_GRADIENT_ORDER = (
    "det_f", "dt_rate", "g_visc", "stretch", "cos2", "sin2", "a22", "a33", "a23", "dlng_det_f", "dlng_stretch", "dlng_a_norm2",
    "dlng_j2", "b_left", "m22", "m33", "m23", "transverse", "normal", "y_rate",
)  # fmt: skip


def tangent_stage(scene: Scene) -> Stage:
    """DDSDDE of Eq. 17 for the chosen tangent."""
    (det_f,) = sym("det_f")
    kind, coefficients = scene.tangent, _elastic(scene)
    fourth = tangent.hyperelastic_dyads(coefficients)
    fourth += tangent.products(stress.named(coefficients)) + tangent.viscous_products() + tangent.jaumann_terms()
    dyads, body = right_factors(fourth, 1 / det_f)
    products = {}
    for shared, row in grouped_products(fourth).items():
        products[shared] = f"half_{shared.key}"
        body += combination(products[shared], _with_cauchy(row), 1 / (2 * det_f))
    body += with_dyad(symmetric_part(products, dyads), C_RATE.key, "r_visc", kind == "symmetric")
    arrays = tuple(Variable(n, (6,)) for n in (*dyads.values(), *products.values()))
    return make_stage(
        "tangent", f"{kind.capitalize()} tangent (1/J) dtau/deps", "16, 17", " ".join(_free(body, _TANGENT_ORDER)), "ddsdde",
        body, arrays, sharing="heads", formula=(
            "(1/J) dtau/deps = (1/J) F F (2 dS/dC) F F + (1/2)(d_ik s_jl + d_il s_jk + d_jk s_il + d_jl s_ik)",
            "The paper prints dS/dC in Eq. 16 without the 2, and freezes f (tangent 'paper').",
        ),
    )  # fmt: skip


_TANGENT_ORDER = (
    "det_f", "dt_rate", "alpha_e", "beta_e", "lambda_e", "kappa_eff", "p_start", "kappa_held", "excess", "c_unit",
    "c_fibre_c", "c_plane", "g_visc", "b_left", "fibre", "plane", "y_rate", "r_visc", "stress",
)  # fmt: skip


def _with_cauchy(row: stress.Combination) -> stress.Combination:
    """Tau in a product becomes J times the Cauchy stress, which the code has."""
    (det_f,) = sym("det_f")
    cauchy = Generator("stress", "", "")
    return {(cauchy if g.key == "tau" else g): (c * det_f if g.key == "tau" else c) for g, c in row.items()}
