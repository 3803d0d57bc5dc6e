"""CalculiX's call of an external material, made from Python, and the mechanics that says what it has to return."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from plyflow.diagnose.mistakes import VOIGT, Point, material_tangent

Array = NDArray[np.float64]


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


def pulled_back(f: Array, cauchy: Array, ddsdde: Array) -> tuple[Array, Array]:
    """Second Piola-Kirchhoff stress and symmetric part of dS/dE from Cauchy stress and DDSDDE."""
    tangent = material_tangent(Point(f, cauchy, ddsdde, ddsdde))
    return np.linalg.det(f) * bond(np.linalg.inv(f)) @ cauchy, (tangent + tangent.T) / 2


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
        props: ArrayLike,
        state: ArrayLike,
        *,
        icmd: int = 0,
        ielas: int = 0,
        orientation: ArrayLike | None = None,
        pnewdt: float = -1.0,
    ) -> Answer:
        """One call; state and constants as in the deck, `orientation` as CalculiX's orab."""
        before, constants = np.array(state, dtype=float), np.array(props, dtype=float)
        after, stress, stiff = np.full(len(before), np.nan), np.zeros(6), np.full(21, np.nan)
        wanted, system = np.array([pnewdt]), np.array(np.zeros(7) if orientation is None else orientation, dtype=float)
        numbers = {
            "one": 1, "kode": -100 - len(constants), "thermal": 0, "icmd": icmd, "ielas": ielas, "mi": 1,
            "nstate": len(before), "iorien": 0 if orientation is None else 1,
        }  # fmt: skip
        n = {name: ctypes.byref(ctypes.c_int(value)) for name, value in numbers.items()}
        det = [float(np.linalg.det(f)) if np.isfinite(f).all() else float("nan") for f in (f0, f1)]
        real = [ctypes.byref(ctypes.c_double(value)) for value in (*det, 20.0, dt, dt, 0.0)]
        start, end, zeros, place = (
            np.asfortranarray(array, dtype=float) for array in (f0, f1, np.zeros(6), [1.0, 2.0, 3.0])
        )
        name = ctypes.create_string_buffer(b"@PFBDF1_PFMATERIAL".ljust(80), 80)
        self._call(
            name, n["one"], n["one"], n["kode"], _pointer(constants), _pointer(zeros), _pointer(zeros),
            _pointer(zeros), _pointer(start), real[0], _pointer(end), real[1], n["thermal"], real[2], real[3],
            real[4], real[5], n["icmd"], n["ielas"], n["mi"], n["nstate"], _pointer(before), _pointer(after),
            _pointer(stress), _pointer(stiff), n["iorien"], _pointer(place), _pointer(system), _pointer(wanted),
            n["one"], ctypes.c_int(80),
        )  # fmt: skip
        stiffness = np.zeros((6, 6))
        columns, rows = np.tril_indices(6)  # the 21 terms are the upper triangle by columns
        stiffness[rows, columns] = stiffness[columns, rows] = stiff
        return Answer(stress, stiffness, after, float(wanted[0]))


def _pointer(array: Array) -> Any:
    return array.ctypes.data_as(ctypes.c_void_p)
