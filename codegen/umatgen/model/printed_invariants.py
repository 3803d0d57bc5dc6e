"""The invariants of Eqs. 13 and 14 as the paper prints them, in I1 and I3 of an inextensible fibre: a scene option.

In general states (I1-1)^2 - 4 I3 is negative and the square root is not a number: for C = (1+d) I it is -3 d^2 to leading
order. The option exists so that reports can show where that happens; the default is the always-real transverse form.
"""

from __future__ import annotations

import sympy as sp

from umatgen.notation import sym


def invariants(stage: str) -> tuple[sp.Expr, sp.Expr]:
    """Stretch sqrt(x) and (I1-1)^2 - 2 I3 as printed: x = I1^s (`squeeze`) or x = I1 - (1 + chi_l) (`bleed`)."""
    i1, det_f, chi_l = sym("i1", "det_f", "chi_l")
    trace, area2 = i1 - 1, det_f**2
    squeezing = (trace - sp.sqrt(trace**2 - 4 * area2)) / 2
    x = squeezing if stage == "squeeze" else i1 - (1 + chi_l)
    return sp.sqrt(x), trace**2 - 2 * area2


def reality(stage: str) -> sp.Expr:
    """What must be positive for the printed stretch to be real and to have a derivative."""
    i1, det_f, eps_lock = sym("i1", "det_f", "eps_lock")
    return (i1 - 1) ** 2 - 4 * det_f**2 if stage == "squeeze" else i1 - 1 - sp.exp(-2 * eps_lock)
