"""The creep-exact increment in forty digits.

The mean of the viscosity's power over the strain path by the same eight panels (to the last digit) or by quadrature (what they
stand for), and the mean stress extrapolated to the end of the increment.
"""

from itertools import pairwise
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
    determinant,
    product,
    right_cauchy_green,
    scale,
    strain_basis,
    subtract,
    tensor,
    voigt,
)
from oracle.elastic import elastic_stress, penalty_stress
from oracle.properties import Properties
from oracle.response import DIGITS, flow
from oracle.states import State
from oracle.viscous import compaction, floored_rate, strain_rate, viscous_stress


class Past(NamedTuple):
    """What the last increment leaves: its mean stress in MPa, its length in s, its strain rate in 1/s."""

    stress: float
    length: float
    rate: float


def log_viscosity(stretch: Real, p: Properties, bleeds: bool) -> Real:
    """ln(eta_ply eta_micro e^b) of Eqs. 4 and 5 at exp(eps) = stretch."""
    closeness = p.k / (mp.sqrt(p.chi_f) * stretch - p.k)
    size = 2 * (p.w0 / p.h0) ** 2
    if bleeds:
        return mp.log(size * p.chi_l / stretch**2 * 2 * p.l0_over_d**2 * p.k * closeness**2) + p.b_bleed
    return mp.log(size / stretch**4 * 2 * mp.sqrt(p.chi_l) * stretch * p.k * (closeness**2 + 3)) + p.b_squeeze


def piece(near: Real, far: Real, p: Properties, bleeds: bool, top: Real, panels: int) -> Real:
    """Integral of (eta/e^top)^m over ln s from near to far; by quadrature where no panels are given."""
    m = 1 / (p.a + 1)

    def rise(s: Real) -> Real:
        return m * (log_viscosity(s, p, bleeds) - top) - mp.log(s)

    if not panels:
        return mp.quad(lambda s: mp.exp(rise(s)), mp.linspace(near, far, 12))
    marks = [near + (mp.mpf(i) / panels) ** 2 * (far - near) for i in range(panels + 1)]
    total = mp.mpf(0)
    for left, right in pairwise(marks):
        low, high = rise(left), rise(right)
        mean = (mp.exp(high) - mp.exp(low)) / (high - low) if high != low else mp.exp(low)
        total += (right - left) * mean
    return total


def mean_factor(c0: Tensor, c1: Tensor, p: Properties, locked: bool, panels: int = 8) -> tuple[Real, Real, bool]:
    """R, the strain rate in s over sqrt(J2/j2_unit), and whether the bleed law holds."""
    start, end, lock = mp.sqrt(compaction(c0).x), mp.sqrt(compaction(c1).x), mp.exp(p.eps_lock)
    bleeds = locked or end <= lock
    top, strain = log_viscosity(end, p, bleeds), mp.log(start / end)
    if bleeds and not locked and start > lock:
        total = piece(end, lock, p, True, top, panels) + piece(lock, start, p, False, top, panels)
    else:
        total = piece(end, start, p, bleeds, top, panels)
    ratio = start / end
    u33 = (ratio**2 - 1) / (2 * strain)
    u22 = u33 / ratio**2
    across = mp.mpf(0) if bleeds else 1 / (1 + end**8)
    first, second = (1 - across) * u33 + across * u22, (1 - across) * u33**2 + across * u22**2
    factor = (total / strain) ** (p.a + 1) / second ** (p.a / 2) / first
    return factor, first / mp.sqrt(second), bleeds


def creep_factor(c0: Tensor, c1: Tensor, dt: Real, p: Properties, locked: bool, past: Past | None) -> tuple[Real, Real]:
    """What multiplies the viscous stress of the backward difference, and the mean stress."""
    counted, stage = flow(c0, c1, p, locked)
    rate = scale(1 / dt, subtract(c1, counted))
    factor, measure, bleeds = mean_factor(c0, c1, p, locked)
    ply = compaction(c1)
    unit = 2 * ply.x**2 if bleeds else 2 * ply.norm2
    speed = mp.sqrt(floored_rate(rate, dt, p, stage) / unit)
    stress = mp.exp(log_viscosity(mp.sqrt(ply.x), p, bleeds)) * speed ** (p.a + 1) * factor * measure
    if past is None or past.rate * strain_rate(c1, rate) <= 0:
        return factor, stress
    return factor * (stress / mp.mpf(past.stress)) ** (dt / (dt + mp.mpf(past.length))), stress


def kirchhoff(c0: Tensor, f1: Tensor, dt: Real, p: Properties, locked: bool, past: Past | None) -> Tensor:
    """Kirchhoff stress, MPa."""
    c1 = right_cauchy_green(f1)
    counted, bleeds = flow(c0, c1, p, locked)
    viscous = viscous_stress(c1, scale(1 / dt, subtract(c1, counted)), dt, p, bleeds)
    parts = [elastic_stress(c1, p), scale(creep_factor(c0, c1, dt, p, locked, past)[0], viscous)]
    return congruence(f1, add(*parts, *([] if bleeds else [penalty_stress(c1, p)])))


def creep_witness(
    state: State, past: Past | None, step: str = "1e-18"
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Cauchy stress (6,), perturbed Kirchhoff stress (1/J) dtau/deps (6, 6) and mean stress in MPa, at twice forty digits."""
    with mp.workdps(2 * DIGITS):
        p, dt, f1 = Properties.of(state.props), mp.mpf(state.time_increment), tensor(state.end)
        c0, h, det_f = right_cauchy_green(tensor(state.start)), mp.mpf(step), determinant(tensor(state.end))
        sigma = voigt(scale(1 / det_f, kirchhoff(c0, f1, dt, p, state.locked, past)))
        columns = []
        for component in range(6):
            stretch = scale(h, strain_basis(component))
            ends = (product(turn(IDENTITY, stretch), f1) for turn in (add, subtract))
            ahead, behind = (kirchhoff(c0, f, dt, p, state.locked, past) for f in ends)
            columns.append(voigt(scale(1 / (2 * h * det_f), subtract(ahead, behind))))
        mean = creep_factor(c0, right_cauchy_green(f1), dt, p, state.locked, past)[1]
        tangent = [[float(entry) for entry in row] for row in zip(*columns, strict=True)]
        return np.array([float(x) for x in sigma]), np.array(tangent), float(mean)
