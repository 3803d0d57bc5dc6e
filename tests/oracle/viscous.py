"""Viscous potential psi_v = f J2^((a+2)/2) (Eqs. 13-15 in the transverse form) with the floored rate."""

from typing import NamedTuple

from mpmath import mp

from oracle.algebra import Real, Tensor, contract, determinant, scale
from oracle.properties import Properties


class Transverse(NamedTuple):
    """Invariants of the transverse block A of C."""

    trace: Real
    det: Real
    smallest: Real
    largest: Real
    half_gap: Real


def transverse(c: Tensor) -> Transverse:
    """Trace, determinant and eigenvalues of the block of axes 2 and 3."""
    mean, half = (c[1][1] + c[2][2]) / 2, (c[1][1] - c[2][2]) / 2
    radius = mp.sqrt(half**2 + c[1][2] ** 2)
    det = c[1][1] * c[2][2] - c[1][2] ** 2
    return Transverse(2 * mean, det, mean - radius, mean + radius, radius)


def compaction(c: Tensor) -> Real:
    """Hencky strain of the most compressed transverse direction, ln(x)/2."""
    return mp.log(transverse(c).smallest) / 2


def compaction_rate(c: Tensor, c_rate: Tensor) -> Real:
    """Rate of `compaction` along Cdot, 1/s; the mean over the directions where the two stretches coincide."""
    block = transverse(c)
    half, half_rate = (c[1][1] - c[2][2]) / 2, (c_rate[1][1] - c_rate[2][2]) / 2
    turning = half * half_rate + c[1][2] * c_rate[1][2]
    x_rate = (c_rate[1][1] + c_rate[2][2]) / 2 - (turning / block.half_gap if block.half_gap else 0)
    return x_rate / (2 * block.smallest)


def factor(c: Tensor, p: Properties, locked: bool) -> Real:
    """Factor f of C, in MPa s^(a+2)."""
    block = transverse(c)
    x = block.smallest
    ratio_squared = (p.k / (mp.sqrt(x) - p.limit_stretch)) ** 2
    size = (p.w0 / p.h0) ** 2
    common = 4 * mp.sqrt(determinant(c)) * p.k / (p.a + 2) / p.chi_f
    if locked:
        rate_measure = 2 * x**2
        shape = p.l0_over_d**2 * p.chi_l * mp.exp(p.b_bleed) / x * ratio_squared
    else:
        rate_measure = 2 * (block.trace**2 - 2 * block.det)
        shape = mp.sqrt(p.chi_l) * mp.exp(p.b_squeeze) * x ** mp.mpf("-1.5") * (ratio_squared + 3 * p.chi_f)
    return size * common * shape * rate_measure ** (-(p.a + 2) / 2)


def floored_rate(c_rate: Tensor, dt: Real, p: Properties) -> Real:
    """J2 + j0, 1/s^2, with J2 = (1/2) Cdot:Cdot and j0 = max(rate_floor, strain_floor/dt)^2."""
    return contract(c_rate, c_rate) / 2 + max(p.rate_floor, p.strain_floor / dt) ** 2


def viscous_potential(c: Tensor, c_rate: Tensor, dt: Real, p: Properties, locked: bool) -> Real:
    """psi_v, MPa/s, of the floored rate."""
    return factor(c, p, locked) * floored_rate(c_rate, dt, p) ** ((p.a + 2) / 2)


def viscous_stress(c: Tensor, c_rate: Tensor, dt: Real, p: Properties, locked: bool) -> Tensor:
    """S_v = (a+2) f (J2 + j0)^(a/2) Cdot (Eq. 15), MPa."""
    weight = (p.a + 2) * factor(c, p, locked) * floored_rate(c_rate, dt, p) ** (p.a / 2)
    return scale(weight, c_rate)
