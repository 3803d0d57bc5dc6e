"""Stress, consistent tangent, energies and state variables of one increment."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from mpmath import mp
from numpy.typing import NDArray

from oracle.algebra import (
    IDENTITY,
    Real,
    Tensor,
    add,
    build,
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
from oracle.elastic import elastic_energy, elastic_stress, penalty_energy, penalty_stress
from oracle.properties import Properties
from oracle.viscous import CROSSING, compaction, counted, floored_rate, strain, strain_rate, viscous_stress

DIGITS = 40
Props = Sequence[Any] | NDArray[np.float64] | Properties


class Energies(NamedTuple):
    """Per reference volume, MPa: stored in the elastic part, in the penalty, dissipated in the increment."""

    elastic: Real
    penalty: Real
    dissipation: Real


class StateVariables(NamedTuple):
    """What the increment leaves in STATEV 1-4, 6 and 7, in this order (the lock is a matter of history)."""

    eps: Real
    width: Real
    det_f: Real
    fibre_fraction: Real
    pressure: Real
    eps_rate: Real


def piola_of(c0: Tensor, c1: Tensor, dt: Real, p: Properties, locked: int) -> Tensor:
    """S of the right Cauchy-Green tensors at both ends of the increment, at the caller's precision."""
    c_rate = scale(1 / dt, subtract(c1, c0))
    parts = [elastic_stress(c1, p), viscous_stress(c1, c_rate, dt, p, locked)]
    if not locked:
        parts.append(penalty_stress(c1, p))
    return add(*parts)


def flow(c0: Tensor, c1: Tensor, p: Properties, locked: bool) -> tuple[Tensor, int]:
    """C0 as the rate is counted from it, and whether the bleed law holds, given whether the start was locked.

    The end decides. Where it passes the lock (CROSSING), C0 becomes D C0 D with D = diag(1, exp(eps0 - eps_lock), 1): the width at
    the lock.
    """
    if locked or strain(c1) > p.eps_lock:
        return c0, locked
    widening = (mp.mpf(1), mp.exp(max(mp.mpf(0), strain(c0) - p.eps_lock)), mp.mpf(1))
    return build(lambda i, j: widening[i] * c0[i][j] * widening[j]), CROSSING if widening[1] > 1 else True


def kirchhoff_of(c0: Tensor, f1: Tensor, dt: Real, p: Properties, locked: int) -> Tensor:
    """Kirchhoff stress tau = F S F^T at the caller's precision."""
    return congruence(f1, piola_of(c0, right_cauchy_green(f1), dt, p, locked))


def second_piola(F0: Any, F1: Any, dt: Any, props: Props, locked: bool, *, digits: int = DIGITS) -> Tensor:
    """Second Piola-Kirchhoff stress at the end of the increment, MPa."""
    with mp.workdps(digits):
        p = Properties.of(props)
        c1 = right_cauchy_green(tensor(F1))
        c0, bleeds = flow(right_cauchy_green(tensor(F0)), c1, p, locked)
        return piola_of(c0, c1, mp.mpf(dt), p, bleeds)


def kirchhoff(F0: Any, F1: Any, dt: Any, props: Props, locked: bool, *, digits: int = DIGITS) -> Tensor:
    """Kirchhoff stress J sigma at the end of the increment, MPa."""
    with mp.workdps(digits):
        p, f1 = Properties.of(props), tensor(F1)
        c0, bleeds = flow(right_cauchy_green(tensor(F0)), right_cauchy_green(f1), p, locked)
        return kirchhoff_of(c0, f1, mp.mpf(dt), p, bleeds)


def stress(F0: Any, F1: Any, dt: Any, props: Props, locked: bool, *, digits: int = DIGITS) -> Tensor:
    """Cauchy stress at the end of the increment, MPa."""
    with mp.workdps(digits):
        return scale(1 / determinant(tensor(F1)), kirchhoff(F0, F1, dt, props, locked, digits=digits))


def _perturbation_step(c0: Tensor, c1: Tensor, dt: Real, p: Properties) -> Real:
    """1e-12 of the least strain over which tau bends: increment, gap to the limit, distance from the lock."""
    rate, x = scale(1 / dt, subtract(c1, c0)), compaction(c1).x
    widths = [mp.mpf(1), dt * mp.sqrt(floored_rate(rate, dt, p)), mp.sqrt(x) - p.limit_stretch]
    return min([*widths, abs(strain(c1) - p.eps_lock)]) * mp.mpf("1e-12")


def ddsdde(
    F0: Any, F1: Any, dt: Any, props: Props, locked: bool, *, digits: int = DIGITS
) -> tuple[tuple[Real, ...], ...]:
    """Perturbed Kirchhoff stress (1/J) d tau / d eps, MPa, (6, 6), for stretchings F1 -> (I + h e) F1.

    Central differences at twice the digits, the step a fixed part of the smallest strain over which the
    stress bends: the truncation error is of the order of 1e-24, the rounding error far below it.
    """
    with mp.workdps(2 * digits):
        p, time, f1 = Properties.of(props), mp.mpf(dt), tensor(F1)
        c1 = right_cauchy_green(f1)
        c0, bleeds = flow(right_cauchy_green(tensor(F0)), c1, p, locked)
        step = _perturbation_step(c0, c1, time, p)
        weight = 1 / (2 * step * determinant(f1))
        columns = []
        for component in range(6):
            stretch = scale(step, strain_basis(component))
            ahead = kirchhoff_of(c0, product(add(IDENTITY, stretch), f1), time, p, bleeds)
            behind = kirchhoff_of(c0, product(subtract(IDENTITY, stretch), f1), time, p, bleeds)
            columns.append(voigt(scale(weight, subtract(ahead, behind))))
        return tuple(zip(*columns, strict=True))


def energies(F0: Any, F1: Any, dt: Any, props: Props, locked: bool, *, digits: int = DIGITS) -> Energies:
    """Elastic, penalty (none after the lock) and dissipated energy dt S_v:Cdot/2, per reference volume."""
    with mp.workdps(digits):
        p, time = Properties.of(props), mp.mpf(dt)
        c1 = right_cauchy_green(tensor(F1))
        c0, bleeds = flow(right_cauchy_green(tensor(F0)), c1, p, locked)
        rate = scale(1 / time, subtract(c1, c0))
        dissipation = time * contract(viscous_stress(c1, rate, time, p, bleeds), counted(rate, bleeds)) / 2
        penalty = mp.mpf(0) if bleeds else penalty_energy(c1, p)
        return Energies(elastic_energy(c1, p), penalty, dissipation)


def state_variables(F0: Any, F1: Any, dt: Any, props: Props, locked: bool, *, digits: int = DIGITS) -> StateVariables:
    """Kinematics at the end, the penalty's pressure (positive in compression, MPa), the strain rate."""
    with mp.workdps(digits):
        p, c1, f1 = Properties.of(props), right_cauchy_green(tensor(F1)), tensor(F1)
        c0, bleeds = flow(right_cauchy_green(tensor(F0)), c1, p, locked)
        det_f, x = determinant(f1), compaction(c1).x
        pressure = mp.mpf(0) if bleeds else -p.kappa * (det_f - 1)
        rate = strain_rate(c1, scale(1 / mp.mpf(dt), subtract(c1, c0)))
        width = det_f / mp.sqrt(x * c1[0][0])
        return StateVariables(strain(c1), width, det_f, 1 / (2 * det_f), pressure, rate)
