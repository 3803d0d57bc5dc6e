"""Viscous potential psi_v = f J2^((a+2)/2) (Eqs. 13-15 with x along the ply normal) with the floored rate."""

from typing import NamedTuple

from mpmath import mp

from oracle.algebra import AXES, Real, Tensor, build, contract, determinant, inverse, scale
from oracle.properties import Properties

CROSSING = 2
"""In place of `locked`: bleeding flow in the increment that passes the lock."""


class Compaction(NamedTuple):
    """Squared stretch x along the ply normal (axis 3), C^-1 N, and A:A of the block of axes 2 and 3."""

    x: Real
    along: tuple[Real, Real, Real]
    norm2: Real


def compaction(c: Tensor) -> Compaction:
    """X = 1/(N . C^-1 N)."""
    column = tuple(row[2] for row in inverse(c))
    norm2 = c[1][1] ** 2 + c[2][2] ** 2 + 2 * c[1][2] ** 2
    return Compaction(1 / column[2], column, norm2)


def strain(c: Tensor) -> Real:
    """Hencky strain of the thickness along the ply normal, ln(x)/2."""
    return mp.log(compaction(c).x) / 2


def strain_rate(c: Tensor, c_rate: Tensor) -> Real:
    """Rate of `strain` along Cdot, 1/s: (x/2) (C^-1 N) . Cdot (C^-1 N)."""
    ply = compaction(c)
    return ply.x / 2 * mp.fsum(ply.along[i] * c_rate[i][j] * ply.along[j] for i in AXES for j in AXES)


def factor(c: Tensor, p: Properties, locked: int) -> Real:
    """Factor f of C, in MPa s^(a+2)."""
    ply = compaction(c)
    x = ply.x
    ratio_squared = (p.k / (mp.sqrt(x) - p.limit_stretch)) ** 2
    size = (p.w0 / p.h0) ** 2
    common = 4 * mp.sqrt(determinant(c)) * p.k / (p.a + 2) / p.chi_f
    if locked:
        rate_measure = 2 * x**2
        shape = p.l0_over_d**2 * p.chi_l * mp.exp(p.b_bleed) / x * ratio_squared
    else:
        rate_measure = 2 * ply.norm2
        shape = mp.sqrt(p.chi_l) * mp.exp(p.b_squeeze) * x ** mp.mpf("-1.5") * (ratio_squared + 3 * p.chi_f)
    return size * common * shape * rate_measure ** (-(p.a + 2) / 2)


def counted(c_rate: Tensor, locked: int) -> Tensor:
    """The rates that J2 counts: in the increment that passes the lock those through the thickness."""
    return build(lambda i, j: c_rate[i][j] if locked != CROSSING or 2 in (i, j) else mp.mpf(0))


def floored_rate(c_rate: Tensor, dt: Real, p: Properties, locked: int = 0) -> Real:
    """J2 + j0, 1/s^2, with J2 = (1/2) Cdot:Cdot and j0 = max(rate_floor, strain_floor/dt)^2."""
    rate = counted(c_rate, locked)
    return contract(rate, rate) / 2 + max(p.rate_floor, p.strain_floor / dt) ** 2


def viscous_potential(c: Tensor, c_rate: Tensor, dt: Real, p: Properties, locked: int) -> Real:
    """psi_v, MPa/s, of the floored rate."""
    return factor(c, p, locked) * floored_rate(c_rate, dt, p, locked) ** ((p.a + 2) / 2)


def viscous_stress(c: Tensor, c_rate: Tensor, dt: Real, p: Properties, locked: int) -> Tensor:
    """S_v = (a+2) f (J2 + j0)^(a/2) Cdot (Eq. 15), MPa."""
    weight = (p.a + 2) * factor(c, p, locked) * floored_rate(c_rate, dt, p, locked) ** (p.a / 2)
    return scale(weight, c_rate)
