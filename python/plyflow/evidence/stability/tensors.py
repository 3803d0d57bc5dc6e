"""Tensor algebra of the checks: Voigt order, pull-back, rotations, the elastic law as an independent witness."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
ROWS, COLUMNS = np.array([0, 1, 2, 0, 0, 1]), np.array([0, 1, 2, 1, 2, 2])
EPSILON = float(np.finfo(float).eps)


def tensor(voigt: ArrayLike) -> Array:
    """Symmetric tensors (..., 3, 3) from components (..., 6) in the order 11, 22, 33, 12, 13, 23."""
    components = np.asarray(voigt, dtype=float)
    full = np.empty((*components.shape[:-1], 3, 3))
    full[..., ROWS, COLUMNS] = components
    full[..., COLUMNS, ROWS] = components
    return full


def green(gradient: Array) -> Array:
    """C = F^T F, (..., 3, 3)."""
    product: Array = np.swapaxes(gradient, -1, -2) @ gradient
    return product


def second_piola(stress: ArrayLike, gradient: Array) -> Array:
    """S = J F^-1 sigma F^-T (..., 3, 3) in MPa from the Cauchy stress (..., 6) in MPa."""
    inverse = np.linalg.inv(gradient)
    volume = np.linalg.det(gradient)[..., None, None]
    pulled: Array = volume * (inverse @ tensor(stress) @ np.swapaxes(inverse, -1, -2))
    return pulled


def compaction_stretch(gradient: Array) -> Array:
    """Stretch along the ply normal (axis 3), 1/sqrt(N . C^-1 N), (...)."""
    return np.asarray(1.0 / np.sqrt(np.linalg.inv(green(gradient))[..., 2, 2]))


def limit_stretch(values: Mapping[str, float]) -> float:
    """Compaction limit as a stretch, k/sqrt(chi_f)."""
    return float(values["k"] * np.sqrt(values["chi_ratio"]) * np.exp(values["eps_lock"]))


def rotation(axis: int, degrees: float) -> Array:
    """Turn about a coordinate axis (0, 1 or 2)."""
    first, second = [i for i in range(3) if i != axis]
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    turn = np.eye(3)
    turn[first, first] = turn[second, second] = cosine
    turn[first, second], turn[second, first] = -sine, sine
    return turn


def turned_stress(stress: Array, turn: Array) -> Array:
    """R sigma R^T in Voigt order, (6,)."""
    return np.asarray((turn @ tensor(stress) @ turn.T)[ROWS, COLUMNS])


def turned_tangent(tangent: Array, turn: Array) -> Array:
    """A fourth-order tangent (6, 6) for engineering shear strains, turned."""
    pairs = np.empty((6, 6))
    for i, (a, b) in enumerate(zip(ROWS, COLUMNS, strict=True)):
        for j, (c, d) in enumerate(zip(ROWS, COLUMNS, strict=True)):
            share = 1.0 if c == d else 2.0
            pairs[i, j] = share * 0.5 * (turn[a, c] * turn[b, d] + turn[a, d] * turn[b, c])
    return np.asarray(pairs @ tangent @ pairs.T)


def elastic_moduli(values: Mapping[str, float]) -> tuple[float, float, float, float, float]:
    """mu_T, mu_L, lambda, alpha, beta [MPa] of Eq. 10 from the transversely isotropic compliance."""
    along, across, nu_along, nu_across = (values[name] for name in ("E_L", "E_T", "nu_LT", "nu_TT"))
    compliance = np.array(
        [
            [1 / along, -nu_along / along, -nu_along / along],
            [-nu_along / along, 1 / across, -nu_across / across],
            [-nu_along / along, -nu_across / across, 1 / across],
        ]
    )
    scale = np.sqrt(np.diag(compliance))
    stiffness = np.linalg.inv(compliance / np.outer(scale, scale)) / np.outer(scale, scale)
    mu_t, mu_l = across / (2 * (1 + nu_across)), values["G_LT"]
    lam = stiffness[1, 2]
    alpha = stiffness[0, 1] - lam
    return mu_t, mu_l, lam, alpha, stiffness[0, 0] - lam - 2 * alpha - 4 * mu_l + 2 * mu_t


def elastic_stress(right: Array, values: Mapping[str, float]) -> Array:
    """Elastic second Piola-Kirchhoff stress (..., 3, 3) in MPa of Eq. 10, written from the potential.

    Shares nothing with the generated code; `right` is C (..., 3, 3), the fibre is axis 1.
    """
    mu_t, mu_l, lam, alpha, beta = elastic_moduli(values)
    inverse = np.linalg.inv(right)
    volume = np.sqrt(np.linalg.det(right))[..., None, None]
    stretched = right[..., 0, 0][..., None, None] - 1.0
    fibre = np.zeros((3, 3))
    fibre[0, 0] = 1.0
    mixed = fibre @ right
    mixed = mixed + np.swapaxes(mixed, -1, -2)
    along = 2 * (mu_t - mu_l) + alpha * np.log(volume) + 0.5 * beta * stretched
    round_ = lam * (volume - 1) * volume + 0.5 * alpha * stretched
    total: Array = mu_t * (np.eye(3) - inverse) + round_ * inverse + along * fibre - (mu_t - mu_l) * mixed
    return total
