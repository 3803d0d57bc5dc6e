"""Elastic potential of Eq. 10 (Bonet and Burton 1998), corrected, and its constants from a transversely isotropic compliance.

Corrected: the last term is subtracted (with the printed plus sign F = I is not stress free), and alpha is Spencer's
constant, hence alpha/2 before ln J. The constants match the tangent at F = I to the compliance: see `moduli`.
"""

from __future__ import annotations

import sympy as sp

from umatgen.notation import sym


def potential() -> sp.Expr:
    """psi_e in MPa as a function of I1, I4, I5 and J."""
    mu_t, mu_l, lam, alpha, beta = sym("mu_t", "mu_l", "lambda_e", "alpha_e", "beta_e")
    i1, i4, i5, det_f = sym("i1", "i4", "i5", "det_f")
    log_j = sp.log(det_f)
    return (
        mu_t * (i1 - 3) / 2
        - mu_t * log_j
        + lam * (det_f - 1) ** 2 / 2
        + ((mu_t - mu_l) + alpha * log_j / 2 + beta * (i4 - 1) / 8) * (i4 - 1)
        - (mu_t - mu_l) * (i5 - 1) / 2
    )


def normal_compliance() -> sp.Matrix:
    """Compliance of the normal components 11, 22, 33 in 1/MPa, fibre along 1, nu_LT the major Poisson's ratio."""
    e_l, e_t, nu_lt, nu_tt = sym("e_l", "e_t", "nu_lt", "nu_tt")
    along, across = -nu_lt / e_l, -nu_tt / e_t
    return sp.Matrix([[1 / e_l, along, along], [along, 1 / e_t, across], [along, across, 1 / e_t]])


def moduli() -> dict[sp.Symbol, sp.Expr]:
    """The five constants of Eq. 10 in MPa, from K = inverse of the normal compliance block.

    mu_T and mu_L are the shear moduli; lambda = K_23, alpha = K_12 - lambda,
    beta = K_11 - lambda - 2 alpha - 4 mu_L + 2 mu_T.
    """
    e_t, nu_tt, g_lt = sym("e_t", "nu_tt", "g_lt")
    mu_t, mu_l, lam, alpha, beta = sym("mu_t", "mu_l", "lambda_e", "alpha_e", "beta_e")
    stiffness = normal_compliance().inv().applyfunc(sp.factor)
    return {
        mu_t: e_t / (2 * (1 + nu_tt)),
        mu_l: g_lt,
        lam: stiffness[1, 2],
        alpha: stiffness[0, 1] - lam,
        beta: sp.factor(stiffness[0, 0]) - lam - 2 * alpha - 4 * mu_l + 2 * mu_t,
    }
