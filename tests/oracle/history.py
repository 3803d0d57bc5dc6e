"""Two-step rates: Cdot from this increment and the one before, and the stress and tangent that follow."""

from typing import NamedTuple

import numpy as np
from mpmath import mp
from numpy.typing import NDArray

from oracle.algebra import (
    IDENTITY,
    Real,
    Tensor,
    add,
    congruence,
    contract,
    determinant,
    product,
    right_cauchy_green,
    scale,
    strain_basis,
    subtract,
    tensor,
    voigt,
)
from oracle.properties import Properties
from oracle.response import DIGITS, piola_of
from oracle.states import State


class Past(NamedTuple):
    """What the last increment leaves: its mean rate of C (3, 3) in 1/s and its length in s; which formula uses it."""

    rate: NDArray[np.float64]
    length: float
    formula: str


def rate_at_the_end(mean: Tensor, past: Past, dt: Real, p: Properties) -> Tensor:
    """Cdot at the end: linear extrapolation of the mean rates, or of ln |r| and of the direction r/|r|; none from rest."""
    theta = dt / (dt + mp.mpf(past.length))
    before = tensor(past.rate)
    floor = 2 * max(p.rate_floor, p.strain_floor / dt) ** 2
    if contract(before, before) <= floor:
        return mean
    if past.formula == "bdf2":
        return add(scale(1 + theta, mean), scale(-theta, before))
    now, then = (mp.sqrt(contract(r, r) + floor) for r in (mean, before))
    length = now * (now / then) ** theta
    direction = add(scale((1 + theta) / now, mean), scale(-theta / then, before))
    return scale(length, direction)


def kirchhoff_after(f1: Tensor, c0: Tensor, past: Past, dt: Real, p: Properties, locked: bool) -> Tensor:
    """Kirchhoff stress with Cdot of the formula: the one-step stress from where that rate would have come from."""
    c1 = right_cauchy_green(f1)
    rate = rate_at_the_end(scale(1 / dt, subtract(c1, c0)), past, dt, p)
    return congruence(f1, piola_of(subtract(c1, scale(dt, rate)), c1, dt, p, locked))


def witness_after(state: State, past: Past, step: str = "1e-16") -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cauchy stress (6,) and perturbed Kirchhoff stress (1/J) dtau/deps (6, 6) in MPa, at twice forty digits."""
    with mp.workdps(2 * DIGITS):
        p, dt, f1 = Properties.of(state.props), mp.mpf(state.time_increment), tensor(state.end)
        c0, h = right_cauchy_green(tensor(state.start)), mp.mpf(step)
        det_f = determinant(f1)
        sigma = voigt(scale(1 / det_f, kirchhoff_after(f1, c0, past, dt, p, state.locked)))
        columns = []
        for component in range(6):
            stretch = scale(h, strain_basis(component))
            ends = (product(turn(IDENTITY, stretch), f1) for turn in (add, subtract))
            ahead, behind = (kirchhoff_after(f, c0, past, dt, p, state.locked) for f in ends)
            columns.append(voigt(scale(1 / (2 * h * det_f), subtract(ahead, behind))))
        tangent = [[float(entry) for entry in row] for row in zip(*columns, strict=True)]
        return np.array([float(x) for x in sigma]), np.array(tangent)
