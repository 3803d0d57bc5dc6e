"""The potentials written straight down in NumPy (tensortrax): nothing differentiated by hand.

psi_e(C) of Eq. 10 with the penalty, psi_v(C, Cdot) = f(C) (J2 + j0)^((a+2)/2) of Eqs. 13 to 15, fibre along axis 1.
PROPS are those of the default scene, by name; units MPa, s.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import tensortrax as trax
import tensortrax.math as tm
from numpy.typing import NDArray

Array = NDArray[np.float64]
Constants = Mapping[str, float]


def elastic_potential(C: Any, props: Constants, kappa: float) -> Any:
    """psi_e + (kappa/2)(J - 1)^2 in MPa of a (3, 3) C."""
    stiffness = _normal_stiffness(props)
    mu_t, mu_l = props["E_T"] / (2 * (1 + props["nu_TT"])), props["G_LT"]
    lam = stiffness[1, 2]
    alpha = stiffness[0, 1] - lam
    beta = stiffness[0, 0] - lam - 2 * alpha - 4 * mu_l + 2 * mu_t
    i1, i4 = tm.trace(C), C[0, 0]
    i5 = C[0, 0] ** 2 + C[0, 1] ** 2 + C[0, 2] ** 2
    j = tm.sqrt(_determinant(C))
    return (
        mu_t / 2 * (i1 - 3) - mu_t * tm.log(j) + (lam + kappa) / 2 * (j - 1) ** 2
        + ((mu_t - mu_l) + alpha / 2 * tm.log(j) + beta / 8 * (i4 - 1)) * (i4 - 1) - (mu_t - mu_l) / 2 * (i5 - 1)
    )  # fmt: skip


def viscous_potential(C: Any, C_rate: Any, props: Constants, locked: bool, floor: float) -> Any:
    """psi_v in MPa/s; `floor` (1/s^2) is added to J2."""
    k, a = props["k"], props["a"]
    chi_l = np.exp(-2 * props["eps_lock"])
    chi_f = chi_l / props["chi_ratio"]
    norm, x = _transverse(C)
    stretch, j = tm.sqrt(x), tm.sqrt(_determinant(C))
    gap = k / (stretch - k / np.sqrt(chi_f))
    rates = [C_rate[i, m] for i in range(3) for m in range(3)]
    j2 = sum((rate**2 for rate in rates[1:]), rates[0] ** 2) / 2 + floor
    if locked:
        scale = (props["l0_over_d"] * props["w0"] / props["h0"]) ** 2 * chi_l / chi_f * np.exp(props["b_bleed"])
        return scale * 4 * k / (a + 2) * j * gap**2 / x * (j2 / (2 * x**2)) ** ((a + 2) / 2)
    scale = (props["w0"] / props["h0"]) ** 2 * np.sqrt(chi_l) / chi_f * np.exp(props["b_squeeze"])
    return scale * 4 * k / (a + 2) * j * (gap**2 + 3 * chi_f) / (x * stretch) * (j2 / (2 * norm)) ** ((a + 2) / 2)


def differentiate(
    C: Array, C_rate: Array, dt: float, props: Constants, locked: bool, kappa: float, floor: float, idle: float
) -> tuple[Array, Array]:
    """Second Piola-Kirchhoff stress S (3, 3) and 2 dS/dC (3, 3, 3, 3) in MPa.

    S = 2 d psi_e/dC + 2 d psi_v/dCdot; C1 enters 2 dS/dC through both arguments of psi_v, as Cdot = (C1 - C0)/dt.
    `idle` multiplies the viscous part of the tangent (see the default scene's tangent at vanishing rate).
    """
    at_c = trax.hessian(lambda c: elastic_potential(c, props, kappa), full_output=True)
    elastic_2, elastic_1, _ = at_c(C)
    pair = np.stack([C, C_rate])
    at_pair = trax.hessian(lambda p: viscous_potential(p[0], p[1], props, locked, floor), full_output=True)
    viscous_2, viscous_1, _ = at_pair(pair)
    stress = 2 * (elastic_1 + viscous_1[1])
    mixed, rates = viscous_2[1][:, :, 0], viscous_2[1][:, :, 1]
    tangent = 4 * (_minor(elastic_2) + idle * (_minor(mixed) + _minor(rates) / dt))
    return (stress + stress.T) / 2, tangent


def _transverse(C: Any) -> tuple[Any, Any]:
    """A:A and smallest eigenvalue of the transverse block."""
    area = C[1, 1] * C[2, 2] - C[1, 2] * C[2, 1]
    trace = C[1, 1] + C[2, 2]
    norm = C[1, 1] ** 2 + C[2, 2] ** 2 + 2 * C[1, 2] * C[2, 1]
    # The tiny number keeps the derivative where both stretches are the same, as the mean of all directions.
    radius = tm.sqrt(((C[1, 1] - C[2, 2]) / 2) ** 2 + C[1, 2] * C[2, 1] + 1e-30)
    return norm, area / (trace / 2 + radius)


def _determinant(C: Any) -> Any:
    return (
        C[0, 0] * (C[1, 1] * C[2, 2] - C[1, 2] * C[2, 1])
        - C[0, 1] * (C[1, 0] * C[2, 2] - C[1, 2] * C[2, 0])
        + C[0, 2] * (C[1, 0] * C[2, 1] - C[1, 1] * C[2, 0])
    )


def _normal_stiffness(props: Constants) -> Array:
    e_l, e_t, nu_lt, nu_tt = (props[name] for name in ("E_L", "E_T", "nu_LT", "nu_TT"))
    cross, inner = -nu_lt / e_l, -nu_tt / e_t
    compliance = [[1 / e_l, cross, cross], [cross, 1 / e_t, inner], [cross, inner, 1 / e_t]]
    return np.asarray(np.linalg.inv(compliance), dtype=float)


def _minor(tensor: Array) -> Array:
    """Symmetric in each pair of indices: derivatives to C, whose entries are not independent."""
    half = (tensor + tensor.swapaxes(0, 1)) / 2
    return (half + half.swapaxes(2, 3)) / 2
