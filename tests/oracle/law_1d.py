"""The one-dimensional law (Eqs. 1-5) in closed form."""

from collections.abc import Sequence
from typing import Any

from mpmath import mp

from oracle.algebra import Real
from oracle.properties import Properties


def law_1d(eps: Any, eps_rate: Any, props: Sequence[Any] | Properties, locked: bool) -> Real:
    """Cauchy stress of compaction, MPa.

    Parameters
    ----------
    eps
        Hencky strain ln(h/h0), negative in compaction.
    eps_rate
        Its rate in 1/s, negative.
    props
        The 17 PROPS.
    locked
        Bleeding flow if true, squeezing flow otherwise.
    """
    p = Properties.of(props)
    size = 2 * (p.w0 / p.h0) ** 2
    squared = (p.k / (mp.sqrt(p.chi_f) * mp.exp(eps) - p.k)) ** 2
    if locked:
        eta_ply = size * mp.exp(-2 * (eps + p.eps_lock))
        eta_micro = 2 * p.l0_over_d**2 * p.k * squared
        b = p.b_bleed
    else:
        eta_ply = size * mp.exp(-4 * eps)
        eta_micro = 2 * mp.sqrt(p.chi_l) * mp.exp(eps) * p.k * (squared + 3)
        b = p.b_squeeze
    return -eta_micro * eta_ply * mp.exp(b) * (-eps_rate) ** (p.a + 1)
