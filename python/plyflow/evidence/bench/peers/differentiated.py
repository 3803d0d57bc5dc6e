"""The NumPy potentials behind Abaqus's interface, so that the Fortran driver can run them like any UMAT."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import tensortrax as trax
from numpy.typing import NDArray

from plyflow.evidence.bench.peers.fortran import peer_library
from plyflow.evidence.bench.peers.potentials import (
    Constants,
    elastic_potential,
    squared_stretch,
    transverse_norm,
    viscous_potential,
)
from plyflow.umat.library import UmatLibrary

Array = NDArray[np.float64]
ROWS, COLUMNS = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
CUT = 0.25  # PNEWDT of the Fortran peers for a state outside the material's range
_PROTOTYPE = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 37, ctypes.c_size_t)


class DifferentiatedUmat(UmatLibrary):
    """A UMAT whose stress and DDSDDE are derivatives of the potentials by tensortrax.

    State variables and dissipation are bookkeeping that no derivative gives: the peer in Fortran does it.

    Parameters
    ----------
    manifest : that of the scene whose PROPS and STATEV it has.
    """

    def __init__(self, manifest: Mapping[str, Any]) -> None:
        super().__init__(peer_library("four_index").path)
        self._props, self._statev = ([row["name"] for row in manifest[kind]] for kind in ("props", "statev"))
        self._fortran, self._umat = self._umat, _PROTOTYPE(self._called)  # type: ignore[assignment]

    def _called(self, *arguments: Any) -> None:
        stress, state, ddsdde = (_view(arguments[n], *s) for n, s in enumerate([(6,), (len(self._statev),), (6, 6)]))
        dt, props = float(_view(arguments[13], 1)[0]), _view(arguments[23], len(self._props))
        pnewdt, f0, f1 = (_view(arguments[n], *s) for n, s in ((27, (1,)), (29, (3, 3)), (30, (3, 3))))
        constants, start = (dict(zip(*pair, strict=True)) for pair in ((self._props, props), (self._statev, state.tolist())))
        self._fortran(*map(ctypes.c_void_p, arguments[:-1]), ctypes.c_size_t(arguments[-1]))
        if pnewdt[0] != CUT:
            stress[:], ddsdde[:] = increment(f0, f1, dt, constants, start["locked"] >= 0.5, start["eps_rate"])


def increment(f0: Array, f1: Array, dt: float, props: Constants, locked: bool, last_rate: float) -> tuple[Array, Array]:
    """Stress (6,) and DDSDDE (6, 6) in MPa at the end of an increment of dt [s].

    `locked` is the state variable at the start, `last_rate` [1/s] is the last converged strain rate.
    """
    C, X, lock = f1.T @ f1, squared_stretch(f0.T @ f0), math.exp(2 * props["eps_lock"])
    passed = squared_stretch(C) <= lock
    crosses = passed and not locked and lock < X
    counted = np.ones((3, 3))
    if crosses:  # the rate in the ply plane counts from the width at the lock, and J2 leaves it out
        f0, counted[:2, :2] = f0 * [1, math.sqrt(X / lock), 1], 0.0
    locked = bool(locked or passed)
    C_rate = (f1 - f0).T @ (f1 + f0) / dt
    C_rate = (C_rate + C_rate.T) / 2
    floor = max(props["rate_floor"], props["strain_floor"] / dt) ** 2
    j2, last = np.sum(counted * C_rate**2) / 2, 2 * (squared_stretch(C) ** 2 if locked else transverse_norm(C)) * last_rate**2
    # At vanishing rate the viscous tangent is that of the last converged one, as the scenes have it.
    idle = (last / (j2 + floor)) ** (props["a"] / 2) if j2 <= floor and last > j2 + floor else 1.0
    elastic, viscous = (
        trax.hessian(potential, full_output=True)(point)
        for potential, point in (
            (lambda c: elastic_potential(c, props, 0.0 if locked else props["kappa"]), C),
            (lambda pair: viscous_potential(pair[0], pair[1], props, locked, floor, counted), np.stack([C, C_rate])),
        )
    )
    # S = 2 d psi_e/dC + 2 d psi_v/dCdot; C1 enters 2 dS/dC through both arguments of psi_v, as Cdot = (C1 - C0)/dt.
    flow, slope = viscous[1][1], viscous[0][1][:, :, 0] + viscous[0][1][:, :, 1] / dt
    if crosses:  # S_v = g Cdot with all rates; g from the component through the thickness
        unit = np.einsum("ik,jl->ijkl", np.eye(3), np.eye(3)) / dt
        g = flow[2, 2] / C_rate[2, 2]
        flow, slope = g * C_rate, np.multiply.outer(C_rate, (slope[2, 2] - g * unit[2, 2]) / C_rate[2, 2]) + g * unit
    S = elastic[1] + flow
    material = elastic[0] + idle * slope
    # Symmetric in each pair of indices: derivatives to C, whose entries are not independent.
    material = material + material.swapaxes(0, 1)
    tau, j = f1 @ (S + S.T) @ f1.T, np.linalg.det(f1)
    return tau[ROWS, COLUMNS] / j, _spatial(f1, material + material.swapaxes(2, 3), tau) / j


def _view(pointer: int, *shape: int) -> Array:
    """Fortran's array behind a pointer."""
    flat = np.ctypeslib.as_array(ctypes.cast(pointer, ctypes.POINTER(ctypes.c_double)), (math.prod(shape),))
    return flat.reshape(shape, order="F")


def _spatial(F: Array, material: Array, tau: Array) -> Array:
    """J DDSDDE: push-forward of 2 dS/dC (Eq. 17) and the Jaumann terms."""
    spatial = np.einsum("ip,jq,kr,ls,pqrs->ijkl", F, F, F, F, material, optimize="greedy")
    for pattern in ("ik,jl->ijkl", "il,jk->ijkl", "jk,il->ijkl", "jl,ik->ijkl"):
        spatial = spatial + np.einsum(pattern, np.eye(3), tau) / 2
    return np.asarray(spatial[ROWS, COLUMNS][:, ROWS, COLUMNS])
