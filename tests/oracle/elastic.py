"""Elastic part (Eq. 10, corrected) and the penalty on the volume before the lock."""

from mpmath import mp

from oracle.algebra import AXES, IDENTITY, Real, Tensor, add, build, determinant, inverse, scale
from oracle.properties import Properties, elastic_constants

FIBRE = build(lambda i, j: mp.mpf(1 if i == j == 0 else 0))


def elastic_energy(c: Tensor, p: Properties) -> Real:
    """psi_e of C, MPa (energy per reference volume)."""
    m = elastic_constants(p)
    det_f = mp.sqrt(determinant(c))
    i1 = c[0][0] + c[1][1] + c[2][2]
    i4, i5 = c[0][0], mp.fsum(c[0][j] ** 2 for j in AXES)
    shear = m.mu_T - m.mu_L
    isotropic = m.mu_T / 2 * (i1 - 3) - m.mu_T * mp.log(det_f) + m.lam / 2 * (det_f - 1) ** 2
    bracket = shear + m.alpha / 2 * mp.log(det_f) + m.beta / 8 * (i4 - 1)
    return isotropic + bracket * (i4 - 1) - shear / 2 * (i5 - 1)


def elastic_stress(c: Tensor, p: Properties) -> Tensor:
    """S_e = 2 d psi_e / dC by hand, MPa; a test differentiates `elastic_energy` to confirm it."""
    m = elastic_constants(p)
    det_f = mp.sqrt(determinant(c))
    i4 = c[0][0]
    shear = m.mu_T - m.mu_L
    on_inverse = -m.mu_T + m.lam * (det_f - 1) * det_f + m.alpha / 2 * (i4 - 1)
    on_fibre = 2 * shear + m.alpha * mp.log(det_f) + m.beta / 2 * (i4 - 1)
    i5_gradient = build(lambda i, j: ((i == 0) + (j == 0)) * c[i][j] if 0 in (i, j) else mp.mpf(0))
    return add(
        scale(m.mu_T, IDENTITY), scale(on_inverse, inverse(c)), scale(on_fibre, FIBRE), scale(-shear, i5_gradient)
    )


def penalty_energy(c: Tensor, p: Properties) -> Real:
    """(kappa/2)(J-1)^2, MPa."""
    return p.kappa / 2 * (mp.sqrt(determinant(c)) - 1) ** 2


def penalty_stress(c: Tensor, p: Properties) -> Tensor:
    """S_vol = kappa (J-1) J C^-1, MPa."""
    det_f = mp.sqrt(determinant(c))
    return scale(p.kappa * (det_f - 1) * det_f, inverse(c))
