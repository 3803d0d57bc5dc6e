"""Incompressibility before locking (sec. 4.4): the devices that a scene can choose.

penalty: U = (kappa/2)(J - 1)^2, so S_vol = kappa (J - 1) J C^-1.
augmented: U = (kappa/2)(J - 1)^2 - p_start (J - 1) with the pressure of the last increment carried over in a state
variable (one Uzawa update an increment), so that J tends to 1 at moderate kappa.
none: U = 0, for a host that enforces J = 1 itself (the paper's Lagrange multiplier; the driver has it).
"""

from __future__ import annotations

import sympy as sp

from umatgen.notation import sym


def potential(device: str = "penalty") -> sp.Expr:
    """U(J) in MPa; `kappa_eff` is kappa before locking and 0 after it, and so is p_start."""
    if device == "none":
        return sp.S.Zero
    kappa_eff, det_f, p_start = sym("kappa_eff", "det_f", "p_start")
    penalty = kappa_eff * (det_f - 1) ** 2 / 2
    return penalty if device == "penalty" else penalty - p_start * (det_f - 1)


def pressure(device: str = "penalty") -> sp.Expr:
    """Pressure of the constraint in MPa, compression positive: -dU/dJ."""
    det_f, kappa_eff = sym("det_f", "kappa_eff")
    slope = sp.diff(potential(device), det_f)
    return -sp.collect(sp.expand(slope), kappa_eff, sp.factor)
