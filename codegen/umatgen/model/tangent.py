"""Tangent: 2 dS/dC in dyads and symmetrised products of generators (Eq. 16), with the Jaumann terms in space (Eq. 17).

Differentiating S = sum c_a G_a gives, rule by rule,

    2 dS/dC = sum_a G_a (x) (2 dc_a/dC) + sum_a 2 c_a dG_a/dC,

and the push-forward replaces every generator by its spatial form. Abaqus wants
DDSDDE = (1/J) [F F (2 dS/dC) F F + 2 (I (.) tau)]: the derivative of the Kirchhoff stress for stretching perturbations.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import sympy as sp

from umatgen.model import held
from umatgen.model.chain import Chain
from umatgen.model.generators import (
    C_INVERSE,
    C_RATE,
    KIRCHHOFF,
    Generator,
    derivative_rules,
    gradient_rules,
)
from umatgen.model.stress import Combination, by_modulus, collected
from umatgen.notation import sym


@dataclass
class FourthOrder:
    """A fourth-order tensor: `dyads[a][b]` of A (x) B and `products[(a, b)]` of A (.) B."""

    dyads: dict[Generator, Combination] = field(default_factory=dict)
    products: dict[tuple[Generator, Generator], sp.Expr] = field(default_factory=dict)

    def add_dyad(self, left: Generator, right: Generator, coefficient: sp.Expr) -> None:
        """Add coefficient * left (x) right."""
        row = self.dyads.setdefault(left, {})
        row[right] = row.get(right, sp.S.Zero) + coefficient

    def add_product(self, pair: tuple[Generator, Generator], coefficient: sp.Expr) -> None:
        """Add coefficient * A (.) B."""
        self.products[pair] = self.products.get(pair, sp.S.Zero) + coefficient

    def __add__(self, other: FourthOrder) -> FourthOrder:
        total = FourthOrder()
        for part in (self, other):
            for left, row in part.dyads.items():
                for right, coefficient in row.items():
                    total.add_dyad(left, right, coefficient)
            for pair, coefficient in part.products.items():
                total.add_product(pair, coefficient)
        return total


def products(stress: Combination) -> FourthOrder:
    """Sum of 2 c_a dG_a/dC: the part of 2 dS/dC in which the generators themselves change."""
    tensor = FourthOrder()
    rules = derivative_rules()
    for generator, coefficient in stress.items():
        for pair, weight in rules.get(generator, {}).items():
            tensor.add_product(pair, 2 * coefficient * weight)
    return tensor


def hyperelastic_dyads(stress: Combination) -> FourthOrder:
    """Sum of G_a (x) 2 dc_a/dC of a stress whose coefficients are functions of the invariants."""
    tensor, chain = FourthOrder(), held.chain()
    for generator, coefficient in stress.items():
        for invariant, gradient in gradient_rules().items():
            slope = chain.derivative(coefficient, invariant)
            for right, weight in gradient.items():
                if slope != 0:
                    tensor.add_dyad(generator, right, by_modulus(2 * slope * weight))
    return tensor


VARIABLES = sym("det_f", "stretch", "a_norm2", "j2")  # what ln g depends on


def slope_name(variable: sp.Symbol) -> sp.Symbol:
    """Name of the partial derivative of ln g with respect to one of its variables."""
    return sp.Symbol(f"dlng_{variable.name}", real=True)


def viscous_gradient(variables: Sequence[sp.Symbol], chain: Chain) -> Combination:
    """2 d(ln g)/dC in generators, with the slopes of ln g by name.

    `variables` are those ln g is differentiated through: all for `consistent`, only J2 for `paper` (Eq. 16: f frozen).
    """
    gradient: Combination = {}
    for invariant, direction in gradient_rules().items():
        if invariant in chain:  # its slope goes through what it is made of
            continue
        slope = sp.Add(*(slope_name(v) * chain.derivative(v, invariant) for v in variables))
        for generator, weight in direction.items():
            if slope != 0:
                gradient[generator] = gradient.get(generator, sp.S.Zero) + 2 * slope * weight
    slopes = [slope_name(v) for v in variables]
    return {generator: collected(coefficient, slopes) for generator, coefficient in gradient.items()}


def viscous_products() -> FourthOrder:
    """(2 g/dt_rate) 1 (.) 1 of 2 dS_v/dC = g Cdot (x) (2 d ln g/dC) + (2 g/dt_rate) 1 (.) 1."""
    (g,) = sym("g_visc")
    return products({C_RATE: g})


def jaumann_terms() -> FourthOrder:
    """The C' of Eq. 17 for the Kirchhoff stress: (1/2)(d_ik t_jl + d_il t_jk + d_jk t_il + d_jl t_ik) = 2 I (.) tau."""
    tensor = FourthOrder()
    tensor.add_product((C_INVERSE, KIRCHHOFF), sp.Integer(2))
    return tensor
