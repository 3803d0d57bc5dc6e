"""The NumPy potentials behind Abaqus's interface, so that the Fortran driver can run them like any UMAT."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import tensortrax
from numpy.typing import NDArray

from plyflow.evidence.bench.peers.potentials import differentiate, elastic_potential

Array = NDArray[np.float64]
ROWS, COLUMNS = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
LANDING = 1e-5  # of logarithmic strain, as in the default scene
_ARGUMENTS = 37
_PLACES = {"stress": 0, "statev": 1, "ddsdde": 2, "scd": 5, "dtime": 13, "props": 23, "pnewdt": 27, "f0": 29, "f1": 30}


@dataclass(frozen=True)
class Increment:
    """What one call works out: stress (6,), DDSDDE (6, 6) in MPa, state (8,), dissipation density in MPa, PNEWDT."""

    stress: Array
    ddsdde: Array
    statev: Array
    dissipated: float
    pnewdt: float


class DifferentiatedUmat:
    """The potentials of `plyflow.evidence.bench.peers.potentials` as a UMAT: `address` is a C function.

    Parameters
    ----------
    names : names of PROPS, in the order of the default scene.
    """

    standin_address = 0
    path = ""

    def __init__(self, names: Sequence[str]) -> None:
        self._names = list(names)
        prototype = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * _ARGUMENTS, ctypes.c_size_t)
        self._entry = prototype(self._called)  # kept: the address is good as long as this object lives

    @property
    def address(self) -> int:
        """Address of the C function."""
        return int(ctypes.cast(self._entry, ctypes.c_void_p).value or 0)

    def _called(self, *arguments: Any) -> None:
        stress, statev, props = (_view(arguments[_PLACES[n]], s) for n, s in (("stress", 6), ("statev", 8), ("props", 17)))
        ddsdde = _view(arguments[_PLACES["ddsdde"]], 36).reshape(6, 6, order="F")
        f0, f1 = (_view(arguments[_PLACES[n]], 9).reshape(3, 3, order="F") for n in ("f0", "f1"))
        scd, pnewdt, dtime = (_view(arguments[_PLACES[n]], 1) for n in ("scd", "pnewdt", "dtime"))
        try:
            done = self.increment(f0, f1, float(dtime[0]), dict(zip(self._names, props.tolist(), strict=True)), statev)
        except (ArithmeticError, ValueError):
            pnewdt[0] = min(pnewdt[0], 0.25)
            return
        stress[:], ddsdde[:], statev[:] = done.stress, done.ddsdde, done.statev
        scd += done.dissipated
        pnewdt[0] = min(pnewdt[0], done.pnewdt)

    def increment(self, f0: Array, f1: Array, dt: float, props: dict[str, float], statev: Array) -> Increment:
        """One increment.

        Raises
        ------
        ArithmeticError
            J <= 0, or compacted to or beyond the limit.
        """
        C, C_rate = f1.T @ f1, (f1 - f0).T @ (f1 + f0) / dt
        C_rate = (C_rate + C_rate.T) / 2
        j = float(np.linalg.det(f1))
        x_start, x = _smallest(f0.T @ f0), _smallest(C)
        lock = math.exp(props["eps_lock"])
        limit = props["k"] * lock * math.sqrt(props["chi_ratio"])
        if not (j > 0 and math.sqrt(x) > limit):
            raise ArithmeticError("outside the material's range")
        locked = bool(statev[4] >= 0.5 or x_start <= (lock * (1 + LANDING)) ** 2)
        floor = max(props["rate_floor"], props["strain_floor"] / dt) ** 2
        j2 = float(np.sum(C_rate**2)) / 2
        idle = _idle(j2, floor, C, x, locked, float(statev[6]), props["a"])
        kappa = 0.0 if locked else props["kappa"]
        S, material = differentiate(C, C_rate, dt, props, locked, kappa, floor, idle)
        tau = f1 @ S @ f1.T
        power = _power(S, C, C_rate, kappa, props)
        rate = _strain_rate(C, C_rate, x)
        state = np.array([
            math.log(x) / 2, _width(C, x), j, 0.5 / j, float(locked or math.sqrt(x) <= lock * (1 + LANDING)),
            -kappa * (j - 1), rate, statev[7] + dt * power,
        ])  # fmt: skip
        pnewdt = 1e36 if locked else _landing(x_start, x, lock, limit, rate, dt, props["a"])
        return Increment(tau[ROWS, COLUMNS] / j, _spatial(f1, material, tau) / j, state, dt * power, pnewdt)


def _view(pointer: int, size: int) -> Array:
    return np.ctypeslib.as_array(ctypes.cast(pointer, ctypes.POINTER(ctypes.c_double)), (size,))


def _spatial(F: Array, material: Array, tau: Array) -> Array:
    """J DDSDDE: push-forward of 2 dS/dC (Eq. 17) and the Jaumann terms."""
    spatial = np.einsum("ip,jq,kr,ls,pqrs->ijkl", F, F, F, F, material, optimize="greedy")
    unit = np.eye(3)
    for pattern in ("ik,jl->ijkl", "il,jk->ijkl", "jk,il->ijkl", "jl,ik->ijkl"):
        spatial = spatial + np.einsum(pattern, unit, tau) / 2
    return np.asarray(spatial[ROWS, COLUMNS][:, ROWS, COLUMNS])


def _block(C: Array) -> tuple[float, float, float]:
    return float(C[1, 1]), float(C[2, 2]), float(C[1, 2])


def _smallest(C: Array) -> float:
    a22, a33, a23 = _block(C)
    return (a22 * a33 - a23**2) / ((a22 + a33) / 2 + math.hypot((a22 - a33) / 2, a23))


def _width(C: Array, x: float) -> float:
    a22, a33, a23 = _block(C)
    return math.sqrt((a22 * a33 - a23**2) / x)


def _strain_rate(C: Array, C_rate: Array, x: float) -> float:
    a22, a33, a23 = _block(C)
    radius = max(math.hypot((a22 - a33) / 2, a23), 1e-14 * (a22 + a33))
    cosine, sine = (a22 - a33) / 2 / radius, a23 / radius
    r22, r33, r23 = _block(C_rate)
    return ((1 - cosine) * r22 / 2 + (1 + cosine) * r33 / 2 - sine * r23) / (2 * x)


def _power(S: Array, C: Array, C_rate: Array, kappa: float, props: dict[str, float]) -> float:
    """Dissipation density S_v : Cdot/2 in MPa/s: the power of S less that of its elastic part."""
    elastic = tensortrax.gradient(lambda c: elastic_potential(c, props, kappa))(C)
    return float(np.sum((S / 2 - elastic) * C_rate))


def _idle(j2: float, floor: float, C: Array, x: float, locked: bool, last_rate: float, a: float) -> float:
    if j2 > floor:
        return 1.0
    a22, a33, a23 = _block(C)
    last = 2 * (x**2 if locked else a22**2 + a33**2 + 2 * a23**2) * last_rate**2
    return float((last / (j2 + floor)) ** (a / 2)) if last > j2 + floor else 1.0


def _landing(x_start: float, x: float, lock: float, limit: float, rate: float, dt: float, a: float) -> float:
    """PNEWDT of an increment that oversteps the lock, as the default scene has it; else no opinion."""
    stretch = math.sqrt(x)
    if stretch >= lock * (1 - LANDING):
        return 1e36
    to_lock = math.log(x_start / lock**2)
    chord = to_lock / math.log(x_start / x)
    viscosity = [(limit**2 / (s - limit) ** 2 + 3) / s**3 for s in (stretch, lock)]
    creep = 0.5 * to_lock / (abs(rate) * dt * (viscosity[0] / viscosity[1]) ** (1 / (a + 1)))
    return math.sqrt(chord * min(chord, max(1e-3, creep)))
