"""Eight-node hexahedra with the volume ratio averaged over each (mean dilatation), and their exact tangent."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plyflow.diagnose.mistakes import VOIGT

Array = NDArray[np.float64]
IDENTITY = np.eye(3)
TRACE = IDENTITY.ravel()
# (6, 9): strains with engineering shears from the nine components of a velocity gradient; its transpose spreads stresses.
STRAINS = np.array([[float((i, j) in ((a, b), (b, a))) for i in range(3) for j in range(3)] for a, b in VOIGT])


def _spin() -> Array:
    """(9, 9, 9): what W tau - tau W adds, W the spin of a velocity gradient; axes: result, gradient, tau."""
    d = IDENTITY
    left = np.einsum("ik,lm,jn->ijklmn", d, d, d) - np.einsum("il,km,jn->ijklmn", d, d, d)  # (L_kl) tau_mn
    right = np.einsum("im,kn,lj->ijklmn", d, d, d) - np.einsum("im,ln,kj->ijklmn", d, d, d)
    return np.asarray(0.5 * (left - right)).reshape(9, 9, 9)


SPIN = _spin()


@dataclass(frozen=True)
class Kinematics:
    """Deformation of c elements with q points each, in the frames of their plies.

    Parameters
    ----------
    gradient : (c, q, 3, 3) deformation gradient with the averaged volume ratio.
    slopes : (c, q, 8, 3) derivatives of the shape functions by the deformed place.
    volumes : (c, q) volumes of the points before deformation, mm3.
    ratio : (c, q) volume ratio at the point itself; share : (c, q) of the deformed volume of the element.
    """

    gradient: Array
    slopes: Array
    volumes: Array
    ratio: Array
    share: Array

    @property
    def mean_slopes(self) -> Array:
        """(c, 8, 3) average of the slopes over the deformed element."""
        return np.asarray(np.einsum("cq,cqai->cai", self.share, self.slopes))


def deform(slopes: Array, volumes: Array, displacement: Array) -> Kinematics | None:
    """Deformation of elements; None where one is turned inside out.

    Parameters
    ----------
    slopes : (c, q, 8, 3) derivatives of the shape functions by the place before deformation, in the ply frames.
    volumes : (c, q) volumes of the points before deformation, mm3.
    displacement : (c, 8, 3) of the nodes in the ply frames, mm.
    """
    gradient = np.einsum("cai,cqaj->cqij", displacement, slopes, optimize=True) + IDENTITY
    ratio = np.linalg.det(gradient)
    if not ratio.min() > 0.0:
        return None
    share = volumes * ratio
    mean = share.sum(axis=1) / volumes.sum(axis=1)
    share /= share.sum(axis=1, keepdims=True)
    averaged = gradient * np.cbrt(mean[:, None] / ratio)[:, :, None, None]
    return Kinematics(averaged, slopes @ np.linalg.inv(gradient), volumes, ratio, share)


@dataclass(frozen=True)
class Forces:
    """Nodal forces of elements, in the ply frames.

    Parameters
    ----------
    tau : (c, q, 9) stress times deformed volume at the points, N mm.
    force : (c, 24) N.
    mean : (c,) mean stress times volume, N mm.
    spread : (c, 24) nodal forces of a mean stress times volume of 1, 1/mm.
    expected : (c,) mean stress times volume that the stiffness reckons with.
    """

    tau: Array
    force: Array
    mean: Array
    spread: Array
    expected: Array


def forces(at: Kinematics, stress: Array, expected: Array | None = None) -> Forces:
    """Nodal forces of elements.

    The forces do on any motion of the nodes the work that the stresses do on the averaged gradient, so that the energies
    balance.

    Parameters
    ----------
    stress : (c, q, 6) Cauchy stress, MPa.
    expected : (c,) mean stress times volume [N mm] for the turning of the slopes, default the one that is there. Newton's
        method for the mean stress as an unknown of its own takes what it was predicted to be: of a trial that misses the
        volume by a little the penalty makes a pressure without sense.
    """
    c, q = at.ratio.shape
    mean = at.mean_slopes
    tau = (at.volumes * np.linalg.det(at.gradient))[:, :, None] * (stress @ STRAINS)
    whole = tau @ TRACE / 3.0
    inner = tau.reshape(c, q, 3, 3) - whole[..., None, None] * IDENTITY
    pressed = whole.sum(axis=1)
    force = (at.slopes @ inner).sum(axis=1) + pressed[:, None, None] * mean
    return Forces(tau, force.reshape(c, 24), pressed, mean.reshape(c, 24), pressed if expected is None else expected)


def stiffness(at: Kinematics, inner: Forces, tangent: Array) -> tuple[Array, Array]:
    """Derivatives of the nodal forces (c, 24, 24) [N/mm] and of mean stress times volume (c, 24) [N] by the displacements.

    Parameters
    ----------
    tangent : (c, q, 6, 6) DDSDDE, MPa.
    """
    c, q = at.ratio.shape
    mean, own = at.mean_slopes, at.slopes
    by_node = np.zeros((c, q, 3, 3, 8, 3))
    for i in range(3):
        by_node[:, :, i, :, :, i] = own.transpose(0, 1, 3, 2)
        by_node[:, :, i, i] += (mean[:, None] - own) / 3.0
    motion = by_node.reshape(c, q * 9, 24)
    weight = (at.volumes * np.linalg.det(at.gradient))[:, :, None, None]
    moduli = STRAINS.T @ (weight * tangent) @ STRAINS + np.tensordot(inner.tau, SPIN, (2, 2))
    change = moduli @ motion.reshape(c, q, 9, 24)
    whole = inner.tau @ TRACE / 3.0
    stiff = motion.transpose(0, 2, 1) @ change.reshape(c, q * 9, 24)
    stiff += _geometric(at, inner.tau.reshape(c, q, 3, 3), whole, inner.expected)
    return stiff, np.einsum("i,cqin->cn", TRACE, change) / 3.0


def _geometric(at: Kinematics, tau: Array, pressure: Array, expected: Array) -> Array:
    """Derivative of the slopes at given stresses (times volume), the averaging of the volume included."""
    c, q = at.ratio.shape
    own, mean = at.slopes, at.mean_slopes.reshape(c, 24)
    shared = expected[:, None] * at.share
    turned = own @ tau - (pressure - shared)[..., None, None] * own  # rows: node, the symmetric stress on its slope
    flat = own.reshape(c, q, 24)
    crossed = flat.transpose(0, 2, 1) @ turned.reshape(c, q, 24)
    crossed = crossed.reshape(c, 8, 3, 8, 3).transpose(0, 1, 4, 3, 2).reshape(c, 24, 24)
    straight = (shared[..., None] * flat).transpose(0, 2, 1) @ flat
    return np.asarray(straight - crossed - expected[:, None, None] * mean[:, :, None] * mean[:, None, :])
