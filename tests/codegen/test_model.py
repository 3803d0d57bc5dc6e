"""The model gives back what the paper starts from, symbolically."""

from __future__ import annotations

import pytest
import sympy as sp

from umatgen.model import elastic, law_1d, stress, viscous
from umatgen.model.generators import VOIGT, odot
from umatgen.model.tangent import FourthOrder, hyperelastic_dyads, products
from umatgen.notation import sym

(DET_F,) = sym("det_f")


def viscous_factor_in_compaction(stage: str, width2: sp.Expr, rate22: sp.Expr) -> sp.Expr:
    """G for C = diag(1, width2, e^(2 eps)) with Cdot = diag(0, rate22, -2 r e^(2 eps)); the floor is zero."""
    height2 = sp.exp(2 * law_1d.EPS)
    rate33 = -2 * law_1d.RATE * height2
    g = 2 * sp.diff(viscous.potential(stage), sym("j2_eff")[0])
    state = {
        sym("stretch")[0]: sp.exp(law_1d.EPS), sym("a_norm2")[0]: width2**2 + height2**2,
        sym("gap")[0]: sp.exp(law_1d.EPS) - sym("stretch_limit")[0], DET_F: sp.sqrt(width2 * height2),
        sym("j2_eff")[0]: (rate22**2 + rate33**2) / 2,
    }  # fmt: skip
    limit = {sym("stretch_limit")[0]: sym("k_gap")[0] / sp.sqrt(sym("chi_f")[0])}
    return g.subs(state).subs(limit)


def relative_to_law(stage: str, plant: sp.Expr = sp.S.One) -> sp.Expr:
    """Ratio of the 3D stress to Eq. 1 at a numeric state, minus one, to 30 digits."""
    eps, rate = law_1d.EPS, law_1d.RATE
    height2 = sp.exp(2 * eps)
    if stage == "squeeze":
        width2, rate22 = sp.exp(-2 * eps), 2 * rate * sp.exp(-2 * eps)
    else:
        width2, rate22 = sym("root_chi_l")[0] ** 2, sp.S.Zero
    g = plant * viscous_factor_in_compaction(stage, width2, rate22)
    volume = sp.sqrt(width2 * height2)
    sigma33, sigma22 = (g * c2 * r / volume for c2, r in ((height2, -2 * rate * height2), (width2, rate22)))
    ratio = (sigma33 - sigma22) / -law_1d.compressive_stress(stage) - 1
    state = {
        eps: sp.Rational(-1, 25), rate: sp.Rational(1, 300), sym("w0")[0]: 15, sym("h0")[0]: sp.Rational(1, 2),
        sym("l0_over_d")[0]: 4294, sym("k_gap")[0]: sp.Rational(813, 1000), sym("a_rate")[0]: sp.Rational(-866, 1000),
        sym("b_log")[0]: -15, sym("root_chi_l")[0]: sp.Rational(106, 100), sym("chi_l")[0]: sp.Rational(106, 100) ** 2,
        sym("chi_f")[0]: sp.Rational(106, 100) ** 2 * sp.Rational(10, 7),
    }  # fmt: skip
    return abs(ratio.subs(state).evalf(40))


@pytest.mark.parametrize("stage", viscous.STAGES)
def test_incompressible_compaction_with_a_free_edge_gives_eq_1_back(stage: str) -> None:
    assert relative_to_law(stage) < sp.Float("1e-30")
    assert relative_to_law(stage, plant=sp.Rational(1001, 1000)) > sp.Float("1e-4")


@pytest.mark.parametrize("stage", viscous.STAGES)
def test_the_named_factors_are_the_factor_of_eq_15(stage: str) -> None:
    product = viscous.viscous_factor()
    for definition in reversed([*viscous.law_definitions()[3:4], *viscous.factors(stage)]):
        product = product.subs(definition.symbol, definition.expr)
    limit = sym("k_gap")[0] / sp.sqrt(sym("chi_f")[0])
    ratio = sp.simplify((product / (2 * sp.diff(viscous.potential(stage), sym("j2_eff")[0]))).subs(sym("stretch_limit")[0], limit))
    assert ratio == 1
    assert sp.simplify(sp.exp(viscous.log_viscous_factor(stage)) / viscous.viscous_factor()) != 0


def stiffness_at_rest(potential: sp.Expr) -> tuple[sp.Matrix, sp.Matrix]:
    """Stress (6,) and 2 dS/dC (6, 6) of a potential at F = I."""
    combination = stress.hyperelastic_stress(potential)
    tangent = hyperelastic_dyads(combination) + products(combination)
    rest = dict.fromkeys(sym("det_f", "i4", "i5"), 1) | {sym("i1")[0]: 3}
    at_rest = {"b_left": sp.eye(3), "unit": sp.eye(3), "fibre": sp.diag(1, 0, 0), "fibre_c": sp.diag(2, 0, 0)}
    value = sp.zeros(3, 3)
    for generator, coefficient in combination.items():
        value += coefficient.subs(rest) * at_rest[generator.key]
    return value, _components(tangent, at_rest, rest)


def _components(tangent: FourthOrder, at_rest: dict[str, sp.Matrix], rest: dict[sp.Symbol, int]) -> sp.Matrix:
    def entry(row: int, column: int) -> sp.Expr:
        (i, j), (k, m) = VOIGT[row], VOIGT[column]
        total = sp.S.Zero
        for left, terms in tangent.dyads.items():
            for right, c in terms.items():
                total += c.subs(rest) * at_rest[left.key][i, j] * at_rest[right.key][k, m]
        for (a, b), c in tangent.products.items():
            total += c.subs(rest) * odot(at_rest[a.key], at_rest[b.key], i, j, k, m)
        return total

    return sp.Matrix(6, 6, entry)


def in_engineering_constants(value: sp.Matrix) -> sp.Matrix:
    """Moduli written out, simplified."""
    constants = elastic.moduli()
    for symbol in reversed(list(constants)):
        value = value.subs(symbol, constants[symbol])
    return value.applyfunc(sp.simplify)


def test_the_reference_state_is_stress_free() -> None:
    value, _ = stiffness_at_rest(elastic.potential())
    assert value.applyfunc(sp.simplify) == sp.zeros(3, 3)


def test_the_printed_plus_sign_of_eq_10_is_seen_to_be_not_stress_free() -> None:
    mu_t, mu_l, i5 = sym("mu_t", "mu_l", "i5")
    value, _ = stiffness_at_rest(elastic.potential() + (mu_t - mu_l) * (i5 - 1))
    assert value.applyfunc(sp.simplify) != sp.zeros(3, 3)


def test_the_stiffness_at_rest_is_the_inverse_of_the_compliance() -> None:
    _, value = stiffness_at_rest(elastic.potential())
    value = in_engineering_constants(value)
    e_t, nu_tt, g_lt = sym("e_t", "nu_tt", "g_lt")
    wanted = sp.diag(elastic.normal_compliance().inv(), g_lt, g_lt, e_t / (2 * (1 + nu_tt)))
    assert (value - wanted).applyfunc(sp.simplify) == sp.zeros(6, 6)
    assert (value * sp.Rational(1001, 1000) - wanted).applyfunc(sp.simplify) != sp.zeros(6, 6)
