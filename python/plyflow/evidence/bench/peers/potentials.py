"""The potentials written straight down in NumPy (tensortrax): nothing differentiated by hand.

psi_e(C) of Eq. 10 with the penalty, psi_v(C, Cdot) = f(C) (J2 + j0)^((a+2)/2) of Eqs. 13 to 15; fibre along axis 1, ply
normal along axis 3. PROPS are those of the scenes, by name; units MPa, s.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import tensortrax.math as tm

Constants = Mapping[str, float]


def elastic_potential(C: Any, props: Constants, kappa: float) -> Any:
    """psi_e + (kappa/2)(J - 1)^2 in MPa of a (3, 3) C."""
    e_l, e_t, nu_lt, nu_tt, mu_l = (props[name] for name in ("E_L", "E_T", "nu_LT", "nu_TT", "G_LT"))
    cross, inner = -nu_lt / e_l, -nu_tt / e_t
    stiffness = np.linalg.inv([[1 / e_l, cross, cross], [cross, 1 / e_t, inner], [cross, inner, 1 / e_t]])
    mu_t, lam = e_t / (2 * (1 + nu_tt)), stiffness[1, 2]
    alpha = stiffness[0, 1] - lam
    beta = stiffness[0, 0] - lam - 2 * alpha - 4 * mu_l + 2 * mu_t
    i4, i5, j = C[0, 0], tm.sum(C[0] ** 2), tm.sqrt(tm.linalg.det(C))
    return (
        mu_t / 2 * (tm.trace(C) - 3) - mu_t * tm.log(j) + (lam + kappa) / 2 * (j - 1) ** 2
        + ((mu_t - mu_l) + alpha / 2 * tm.log(j) + beta / 8 * (i4 - 1)) * (i4 - 1) - (mu_t - mu_l) / 2 * (i5 - 1)
    )  # fmt: skip


def viscous_potential(C: Any, C_rate: Any, props: Constants, locked: bool, floor: float, counted: Any = 1.0) -> Any:
    """psi_v in MPa/s; `floor` (1/s^2) is added to J2, which counts the rates with the weights `counted`."""
    k, a = props["k"], props["a"]
    chi_l = np.exp(-2 * props["eps_lock"])
    chi_f = chi_l / props["chi_ratio"]
    norm, x, j = transverse_norm(C), squared_stretch(C), tm.sqrt(tm.linalg.det(C))
    stretch = tm.sqrt(x)
    gap = k / (stretch - k / np.sqrt(chi_f))
    j2 = tm.special.ddot(counted * C_rate, C_rate) / 2 + floor
    if locked:
        scale = (props["l0_over_d"] * props["w0"] / props["h0"]) ** 2 * chi_l / chi_f * np.exp(props["b_bleed"])
        return scale * 4 * k / (a + 2) * j * gap**2 / x * (j2 / (2 * x**2)) ** ((a + 2) / 2)
    scale = (props["w0"] / props["h0"]) ** 2 * np.sqrt(chi_l) / chi_f * np.exp(props["b_squeeze"])
    return scale * 4 * k / (a + 2) * j * (gap**2 + 3 * chi_f) / (x * stretch) * (j2 / (2 * norm)) ** ((a + 2) / 2)


def transverse_norm(C: Any) -> Any:
    """A:A of the transverse block [-]."""
    return C[1, 1] ** 2 + C[2, 2] ** 2 + 2 * C[1, 2] * C[2, 1]


def squared_stretch(C: Any) -> Any:
    """Squared stretch of the ply thickness along the normal, 1/(N . C^-1 N) [-]."""
    return tm.linalg.det(C) / (C[0, 0] * C[1, 1] - C[0, 1] * C[1, 0])
