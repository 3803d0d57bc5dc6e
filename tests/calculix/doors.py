"""CalculiX's two calls of an external material, made from Python, and the mechanics that says what they have to return."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@dataclass
class Answer:
    """Stress (6,), stiffness (6, 6), state and pnewdt as CalculiX would find them."""

    stress: Array
    stiffness: Array
    state: Array
    pnewdt: float


def bond(q: Array) -> Array:
    """(6, 6) with Q T Q^T = B T for tensor components."""
    return np.array([[q[i, k] * q[j, m] + (q[i, m] * q[j, k] if k != m else 0.0) for k, m in VOIGT] for i, j in VOIGT])


def jaumann(stress: Array) -> Array:
    """2 I (.) stress as (6, 6)."""
    s, one = np.zeros((3, 3)), np.eye(3)
    for value, (i, j) in zip(stress, VOIGT, strict=True):
        s[i, j] = s[j, i] = value
    return np.array(
        [
            [
                0.5 * (one[i, k] * s[j, m] + one[i, m] * s[j, k] + one[j, k] * s[i, m] + one[j, m] * s[i, k])
                for k, m in VOIGT
            ]
            for i, j in VOIGT
        ]
    )


def pulled_back(f: Array, cauchy: Array, ddsdde: Array) -> tuple[Array, Array]:
    """Second Piola-Kirchhoff stress and symmetric part of dS/dE from Cauchy stress and DDSDDE."""
    back, det_f = bond(np.linalg.inv(f)), np.linalg.det(f)
    tangent = det_f * back @ (ddsdde - jaumann(cauchy)) @ back.T
    return det_f * back @ cauchy, (tangent + tangent.T) / 2


def rotation_and_stretch(f: Array) -> tuple[Array, Array]:
    """R and U of F = R U."""
    left, values, right = np.linalg.svd(f)
    return left @ right, right.T @ np.diag(values) @ right


def _pointer(array: Array) -> Any:
    return array.ctypes.data_as(ctypes.c_void_p)


class NativeDoor:
    """PFMATERIAL called as call_external_umat_user_ does."""

    def __init__(self, path: Path) -> None:
        self._call = ctypes.CDLL(str(path)).PFMATERIAL
        self._call.restype = None

    def __call__(
        self,
        f0: Array,
        f1: Array,
        dt: float,
        props: Array,
        state: Array,
        *,
        icmd: int = 0,
        ielas: int = 0,
        orientation: Array | None = None,
        pnewdt: float = -1.0,
    ) -> Answer:
        """One call; state and constants as in the deck, `orientation` as CalculiX's orab."""
        before, after = np.array(state, dtype=float), np.full(len(state), np.nan)
        start, end = np.asfortranarray(f0, dtype=float), np.asfortranarray(f1, dtype=float)
        stress, stiff, wanted = np.zeros(6), np.full(21, np.nan), np.array([pnewdt])
        constants, zeros, place = np.array(props, dtype=float), np.zeros(6), np.array([1.0, 2.0, 3.0])
        system = np.zeros(7) if orientation is None else np.array(orientation, dtype=float)
        numbers = {
            "one": 1, "kode": -100 - len(constants), "thermal": 0, "icmd": icmd, "ielas": ielas, "mi": 1,
            "nstate": len(state), "iorien": 0 if orientation is None else 1,
        }  # fmt: skip
        n = {name: ctypes.byref(ctypes.c_int(value)) for name, value in numbers.items()}
        real = [ctypes.byref(ctypes.c_double(value)) for value in (_det(f0), _det(f1), 20.0, dt, dt, 0.0)]
        name = ctypes.create_string_buffer(b"@PFDEFAULT_PFMATERIAL".ljust(80), 80)
        self._call(
            name, n["one"], n["one"], n["kode"], _pointer(constants), _pointer(zeros), _pointer(zeros),
            _pointer(zeros), _pointer(start), real[0], _pointer(end), real[1], n["thermal"], real[2], real[3],
            real[4], real[5], n["icmd"], n["ielas"], n["mi"], n["nstate"], _pointer(before), _pointer(after),
            _pointer(stress), _pointer(stiff), n["iorien"], _pointer(place), _pointer(system), _pointer(wanted),
            n["one"], ctypes.c_int(80),
        )  # fmt: skip
        return Answer(stress, _square(stiff), after, float(wanted[0]))


class AdapterDoor:
    """PFUMAT called as call_external_umat_ does from umat_abaqusnl; stress and stiffness taken on as there."""

    def __init__(self, path: Path) -> None:
        self._call = ctypes.CDLL(str(path)).PFUMAT
        self._call.restype = None

    def __call__(self, f0: Array, f1: Array, dt: float, props: Array, state: Array, *, pnewdt: float = -1.0) -> Answer:
        """Second Piola-Kirchhoff stress and dS/dE after CalculiX's own transformation with U^-1."""
        statev, constants = np.array(state, dtype=float), np.array(props, dtype=float)
        stress, ddsdde = np.zeros(6), np.full((6, 6), np.nan, order="F")
        start, end = np.asfortranarray(f0, dtype=float), np.asfortranarray(f1, dtype=float)
        wanted = np.array([pnewdt])
        scalars = [ctypes.byref(ctypes.c_double(0.0)) for _ in range(12)]
        n = {k: ctypes.byref(ctypes.c_int(k)) for k in (1, 3, 6, len(statev), len(constants))}
        zeros, time, step = np.zeros(6), np.zeros(2), (ctypes.c_int * 4)(1, 1, 1, 0)
        drot, place = np.asfortranarray(np.eye(3)), np.zeros(3)
        name = ctypes.create_string_buffer(b"@ABAQUSNL_X_PFUMAT".ljust(80), 80)
        self._call(
            _pointer(stress), _pointer(statev), _pointer(ddsdde), scalars[0], scalars[1], scalars[2], scalars[3],
            _pointer(zeros.copy()), _pointer(zeros.copy()), scalars[4], _pointer(zeros), _pointer(zeros),
            _pointer(time), ctypes.byref(ctypes.c_double(dt)), scalars[5], scalars[6], scalars[7], scalars[8],
            name, n[3], n[3], n[6], n[len(statev)], _pointer(constants), n[len(constants)], _pointer(place),
            _pointer(drot), _pointer(wanted), scalars[9], _pointer(start), _pointer(end), n[1], n[1], n[1], n[1],
            step, n[1], ctypes.c_int(80),
        )  # fmt: skip
        if not _det(f1) > 0:
            return Answer(stress, ddsdde, statev, float(wanted[0]))
        back = bond(np.linalg.inv(rotation_and_stretch(np.asarray(f1))[1]))
        tangent = back @ ((ddsdde + ddsdde.T) / 2) @ back.T
        return Answer(np.linalg.det(f1) * back @ stress, tangent, statev, float(wanted[0]))


def _det(f: Array) -> float:
    return float(np.linalg.det(f)) if np.isfinite(f).all() else float("nan")


def _square(stiff: Array) -> Array:
    """The 21 terms, upper triangle by columns, as (6, 6)."""
    result, n = np.zeros((6, 6)), 0
    for column in range(6):
        for row in range(column + 1):
            result[row, column] = result[column, row] = stiff[n]
            n += 1
    return result
