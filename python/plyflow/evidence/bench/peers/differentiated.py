"""The NumPy potentials behind Abaqus's interface, so that the Fortran driver can run them like any UMAT."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import tensortrax as trax
from numpy.typing import NDArray

from plyflow.evidence.bench.peers.potentials import (
    Constants,
    elastic_potential,
    smallest_square,
    transverse_area,
    transverse_norm,
    viscous_potential,
)

Array = NDArray[np.float64]
ROWS, COLUMNS = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
LANDING = 1e-5  # of logarithmic strain, as in the default scene
NO_OPINION = 1e36
_PLACES = {"stress": 0, "statev": 1, "ddsdde": 2, "scd": 5, "dtime": 13, "props": 23, "pnewdt": 27, "f0": 29, "f1": 30}


class DifferentiatedUmat:
    """The potentials of `plyflow.evidence.bench.peers.potentials` as a UMAT: `address` is a C function.

    Parameters
    ----------
    manifest : that of the default scene, whose PROPS and STATEV it has.
    """

    standin_address = 0
    path = ""

    def __init__(self, manifest: Mapping[str, Any]) -> None:
        self._props, self._statev = ([row["name"] for row in manifest[kind]] for kind in ("props", "statev"))
        prototype = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 37, ctypes.c_size_t)
        self._entry = prototype(self._called)  # kept: the address is good as long as this object lives

    @property
    def address(self) -> int:
        """Address of the C function."""
        return int(ctypes.cast(self._entry, ctypes.c_void_p).value or 0)

    def _called(self, *arguments: Any) -> None:
        shapes = {"stress": (6,), "ddsdde": (6, 6), "f0": (3, 3), "f1": (3, 3), "props": (len(self._props),),
                  "statev": (len(self._statev),)}  # fmt: skip
        given = {name: _view(arguments[place], shapes.get(name, (1,))) for name, place in _PLACES.items()}
        try:
            done = self.increment(given["f0"], given["f1"], float(given["dtime"][0]), given["props"], given["statev"])
        except (ArithmeticError, ValueError):
            given["pnewdt"][0] = min(given["pnewdt"][0], 0.25)
            return
        for name in ("stress", "ddsdde", "statev"):
            given[name][...] = done[name]
        given["scd"] += done["scd"]
        given["pnewdt"][0] = min(given["pnewdt"][0], done["pnewdt"])

    def increment(self, f0: Array, f1: Array, dt: float, props: Array, statev: Array) -> dict[str, Any]:
        """One increment.

        Returns
        -------
        dict
            stress (6,), ddsdde (6, 6) in MPa, statev, scd (dissipation density of the increment in MPa) and pnewdt.

        Raises
        ------
        ArithmeticError
            J <= 0, or compacted to or beyond the limit.
        """
        p, old = dict(zip(self._props, props, strict=True)), dict(zip(self._statev, statev, strict=True))
        C, C_rate = f1.T @ f1, (f1 - f0).T @ (f1 + f0) / dt
        C_rate = (C_rate + C_rate.T) / 2
        j, x_start, x = float(np.linalg.det(f1)), float(smallest_square(f0.T @ f0)), float(smallest_square(C))
        lock, stretch = math.exp(p["eps_lock"]), math.sqrt(x)
        limit = p["k"] * lock * math.sqrt(p["chi_ratio"])
        if not (j > 0 and stretch > limit):
            raise ArithmeticError("outside the material's range")
        locked = bool(old["locked"] >= 0.5 or x_start <= (lock * (1 + LANDING)) ** 2)
        floor = max(p["rate_floor"], p["strain_floor"] / dt) ** 2
        j2, last = float(np.sum(C_rate**2)) / 2, 2 * (x**2 if locked else transverse_norm(C)) * old["eps_rate"] ** 2
        # At vanishing rate the viscous tangent is that of the last converged one, as the default scene has it.
        idle = float((last / (j2 + floor)) ** (p["a"] / 2)) if j2 <= floor and last > j2 + floor else 1.0
        kappa = 0.0 if locked else p["kappa"]
        S, material, power = _derivatives(C, C_rate, dt, p, locked, kappa, floor, idle)
        rate = float(np.sum(trax.gradient(smallest_square)(C) * C_rate)) / (2 * x)
        state = {
            "eps": math.log(stretch), "width": math.sqrt(transverse_area(C)) / stretch, "J": j, "fibre_fraction": 0.5 / j,
            "locked": float(locked or stretch <= lock * (1 + LANDING)), "pressure": -kappa * (j - 1), "eps_rate": rate,
            "dissipation": old["dissipation"] + dt * power,
        }  # fmt: skip
        inside = locked or stretch >= lock * (1 - LANDING)
        pnewdt = NO_OPINION if inside else _landing(x_start, stretch, lock, limit, rate * dt, p["a"])
        tau = f1 @ S @ f1.T
        return {
            "stress": tau[ROWS, COLUMNS] / j, "ddsdde": _spatial(f1, material, tau) / j, "scd": dt * power, "pnewdt": pnewdt,
            "statev": np.array([state[name] for name in self._statev]),
        }  # fmt: skip


def _view(pointer: int, shape: tuple[int, ...]) -> Array:
    """Fortran's array behind a pointer."""
    flat = np.ctypeslib.as_array(ctypes.cast(pointer, ctypes.POINTER(ctypes.c_double)), (math.prod(shape),))
    return flat.reshape(shape, order="F")


def _derivatives(
    C: Array, C_rate: Array, dt: float, props: Constants, locked: bool, kappa: float, floor: float, idle: float
) -> tuple[Array, Array, float]:
    """Second Piola-Kirchhoff stress S (3, 3), 2 dS/dC (3, 3, 3, 3) in MPa and the dissipation S_v : Cdot/2 in MPa/s.

    S = 2 d psi_e/dC + 2 d psi_v/dCdot; C1 enters 2 dS/dC through both arguments of psi_v, as Cdot = (C1 - C0)/dt.
    `idle` multiplies the viscous part of the tangent (see the default scene's tangent at vanishing rate).
    """
    elastic, viscous = (
        trax.hessian(potential, full_output=True)(point)
        for potential, point in (
            (lambda c: elastic_potential(c, props, kappa), C),
            (lambda pair: viscous_potential(pair[0], pair[1], props, locked, floor), np.stack([C, C_rate])),
        )
    )
    stress = 2 * (elastic[1] + viscous[1][1])
    tangent = elastic[0] + idle * (viscous[0][1][:, :, 0] + viscous[0][1][:, :, 1] / dt)
    # Symmetric in each pair of indices: derivatives to C, whose entries are not independent.
    tangent = tangent + tangent.swapaxes(0, 1)
    return (stress + stress.T) / 2, tangent + tangent.swapaxes(2, 3), float(np.sum(viscous[1][1] * C_rate))


def _spatial(F: Array, material: Array, tau: Array) -> Array:
    """J DDSDDE: push-forward of 2 dS/dC (Eq. 17) and the Jaumann terms."""
    spatial = np.einsum("ip,jq,kr,ls,pqrs->ijkl", F, F, F, F, material, optimize="greedy")
    for pattern in ("ik,jl->ijkl", "il,jk->ijkl", "jk,il->ijkl", "jl,ik->ijkl"):
        spatial = spatial + np.einsum(pattern, np.eye(3), tau) / 2
    return np.asarray(spatial[ROWS, COLUMNS][:, ROWS, COLUMNS])


def _landing(x_start: float, stretch: float, lock: float, limit: float, strain: float, a: float) -> float:
    """PNEWDT of an increment that oversteps the lock, as the default scene has it."""
    to_lock = math.log(x_start / lock**2)
    chord = to_lock / math.log(x_start / stretch**2)
    viscosity = [(limit**2 / (s - limit) ** 2 + 3) / s**3 for s in (stretch, lock)]
    creep = 0.5 * to_lock / (abs(strain) * (viscosity[0] / viscosity[1]) ** (1 / (a + 1)))
    return math.sqrt(chord * min(chord, max(1e-3, creep)))
