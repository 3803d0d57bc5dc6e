"""Stress from the potentials: S = sum of coefficient times generator (Eqs. 8, 15), tau = F S F^T, sigma = tau/J (Eq. 9)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy as sp

from umatgen.model import constraint, elastic, held
from umatgen.model.generators import C_RATE, Generator, gradient_rules
from umatgen.notation import sym

Combination = dict[Generator, sp.Expr]


def hyperelastic_stress(potential: sp.Expr) -> Combination:
    """S = 2 d psi/dC of a potential of the invariants, in generators."""
    stress: Combination = {}
    chain = held.chain()
    for invariant, gradient in gradient_rules().items():
        slope = chain.derivative(potential, invariant)
        for generator, weight in gradient.items():
            if slope != 0:
                stress[generator] = stress.get(generator, sp.S.Zero) + 2 * slope * weight
    return {generator: by_modulus(coefficient) for generator, coefficient in stress.items()}


def by_modulus(coefficient: sp.Expr) -> sp.Expr:
    """The coefficient as a sum of modulus times factored kinematic term, so that J - 1 and I4 - 1 stay differences.

    Expanding kappa (J - 1) J into kappa J**2 - kappa J would lose kappa*1e-16 of stress to rounding.
    """
    return collected(coefficient, sym("mu_t", "mu_l", "lambda_e", "alpha_e", "beta_e", "kappa_eff", "p_start", "kappa_held"))


def collected(expr: sp.Expr, names: Sequence[sp.Symbol]) -> sp.Expr:
    """`expr`, linear in `names`, as a sum of name times factored coefficient."""
    terms = sp.collect(sp.expand(expr), names, evaluate=False)
    return sp.Add(*(name * sp.factor(terms[name]) for name in sorted(terms, key=str)))


def stored_energy(device: str = "penalty", elastic_part: bool = True, holds_width: bool = False) -> sp.Expr:
    """psi_e + U in MPa: what SSE reports, per reference volume; each may be left out."""
    parts = [constraint.potential(device)]
    parts += [elastic.potential()] if elastic_part else []
    parts += [held.potential()] if holds_width else []
    return sp.Add(*parts)


def elastic_stress(device: str = "penalty", elastic_part: bool = True, holds_width: bool = False) -> Combination:
    """Elastic and volumetric part of S, and that of the width held after the lock."""
    return hyperelastic_stress(stored_energy(device, elastic_part, holds_width))


def named(stress: Mapping[Generator, sp.Expr]) -> Combination:
    """The same combination with a name in place of each coefficient: what the emitted code computes once and reuses."""
    return {generator: coefficient_name(generator) for generator in stress}


def coefficient_name(generator: Generator) -> sp.Symbol:
    """Name of the coefficient of a generator in the elastic stress, in MPa."""
    return sp.Symbol(f"c_{generator.key}", real=True)


def viscous_stress() -> Combination:
    """S_v = g Cdot (Eq. 15)."""
    (g,) = sym("g_visc")
    return {C_RATE: g}


def add(*parts: Mapping[Generator, sp.Expr]) -> Combination:
    """Sum of combinations."""
    total: Combination = {}
    for part in parts:
        for generator, coefficient in part.items():
            total[generator] = total.get(generator, sp.S.Zero) + coefficient
    return total
