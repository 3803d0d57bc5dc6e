"""The width held after the lock: a one-sided penalty on the area ratio in the ply plane, in arbitrary precision."""

import numpy as np
from mpmath import mp

from oracle.algebra import (
    IDENTITY,
    Real,
    Tensor,
    add,
    build,
    congruence,
    determinant,
    inverse,
    product,
    right_cauchy_green,
    scale,
    strain_basis,
    subtract,
    tensor,
    voigt,
)
from oracle.properties import Properties
from oracle.states import Array, State
from oracle.viscous import compaction

SMOOTHING = mp.mpf(10) ** -4


def excess(c: Tensor, p: Properties) -> Real:
    """Strain by which sqrt(C11 C22 - C12^2) exceeds exp(-eps_lock), or 0."""
    return max(mp.log(c[0][0] * c[1][1] - c[0][1] ** 2) / 2 + p.eps_lock, mp.mpf(0))


def held_energy(c: Tensor, p: Properties) -> Real:
    """Integral of kappa q^2/(q + w) over the excess q, MPa."""
    q, w = excess(c, p), SMOOTHING
    return p.kappa * (q * (q / 2 - w) + w**2 * mp.log1p(q / w))


def held_stress(c: Tensor, p: Properties) -> Tensor:
    """Second Piola-Kirchhoff stress, MPa: the force times C^-1 less its part along the ply normal."""
    q, ply, whole = excess(c, p), compaction(c), inverse(c)
    force = p.kappa * q**2 / (q + SMOOTHING)
    return build(lambda i, j: force * (whole[i][j] - ply.x * ply.along[i] * ply.along[j]))


def held_witness(state: State) -> tuple[Array, Array, float]:
    """What holding the width adds: Cauchy stress (6,) and perturbed Kirchhoff stress (6, 6) in MPa, energy in MPa."""
    with mp.workdps(80):
        p, f = Properties.of(state.props), tensor(state.end)
        step, det_f = mp.mpf("1e-25"), determinant(f)

        def tau(moved: Tensor) -> Tensor:
            return congruence(moved, held_stress(right_cauchy_green(moved), p))

        columns = []
        for component in range(6):
            e = scale(step, strain_basis(component))
            ahead, behind = (tau(product(turn(IDENTITY, e), f)) for turn in (add, subtract))
            columns.append([float(x) for x in voigt(scale(1 / (2 * step * det_f), subtract(ahead, behind)))])
        sigma = np.array([float(x) for x in voigt(scale(1 / det_f, tau(f)))])
        return sigma, np.array(columns).T, float(held_energy(right_cauchy_green(f), p))
