"""A compiled UMAT called once, with Abaqus's 37 arguments, from Python."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from plyflow.errors import InputError, ToolError
from plyflow.umat.batch import BatchRoutine

Array = NDArray[np.float64]
NO_OPINION = 1.0e36


@dataclass(frozen=True)
class CallResult:
    """What one call returned.

    Parameters
    ----------
    stress : (6,) Cauchy stress in MPa, order 11, 22, 33, 12, 13, 23.
    ddsdde : (6, 6) tangent in MPa, ddsdde[i, j] = d stress_i / d strain_j with engineering shear.
    statev : state at the end.
    sse, spd, scd : energies in MPa.
    pnewdt : suggested ratio of the time increment; `NO_OPINION` when the UMAT said nothing.
    messages : what it reported through STDB_ABQERR.
    stopped : whether it asked for the end of the analysis.
    ddsddt : (6,) change of the stress with temperature in MPa/degC; zero where the UMAT leaves it alone.
    """

    stress: Array
    ddsdde: Array
    statev: Array
    sse: float
    spd: float
    scd: float
    pnewdt: float
    messages: str
    stopped: bool
    ddsddt: Array


class UmatLibrary:
    """A shared library with the symbol umat_, and what makes its batch routine, if it has one, when that is first wanted.

    Raises
    ------
    ToolError
        The file cannot be loaded or has no umat_.
    """

    def __init__(self, path: Path | str, batch: BatchRoutine | None = None) -> None:
        self.path, self.batch = Path(path), batch
        try:
            self._library = ctypes.CDLL(str(self.path))
            self._umat = self._library.umat_
        except (OSError, AttributeError) as error:
            raise ToolError(f"{self.path} is no UMAT library (wanted: a shared library with umat_): {error}") from error
        self._umat.restype = None
        self._take = getattr(self._library, "plyflow_standin_take", None)

    @property
    def address(self) -> int:
        """Address of umat_."""
        return _address(self._umat)

    @property
    def batch_address(self) -> int:
        """Address of the batch routine, compiled where that is still to be done; 0 when the library has none."""
        return 0 if self.batch is None else self.batch.address

    @property
    def standin_address(self) -> int:
        """Address of the accessor of messages, 0 when the library has none."""
        return 0 if self._take is None else _address(self._take)

    def take_messages(self) -> tuple[str, bool]:
        """Messages since the last call and whether the UMAT asked to stop."""
        if self._take is None:
            return "", False
        stop, text = ctypes.c_int(0), ctypes.create_string_buffer(4096)
        self._take(ctypes.byref(stop), text, ctypes.c_int(len(text)))
        return text.value.decode(errors="replace"), bool(stop.value)

    def call(
        self,
        f0: ArrayLike,
        f1: ArrayLike,
        dt: float,
        props: ArrayLike,
        statev: ArrayLike,
        stress: ArrayLike | None = None,
        *,
        time: Sequence[float] = (0.0, 0.0),
        temperature: float = 0.0,
        temperature_increment: float = 0.0,
        ntens: int = 6,
        ndi: int = 3,
        material: str = "PLYFLOW",
        increment: int = 1,
        strain: ArrayLike | None = None,
        strain_increment: ArrayLike | None = None,
        rotation: ArrayLike | None = None,
    ) -> CallResult:
        """One call.

        Parameters
        ----------
        f0, f1 : (3, 3) deformation gradients at the start and end of the increment.
        dt : time increment in s.
        props, statev : constants and state at the start, in the manifest's order.
        stress : (ntens,) Cauchy stress at the start in MPa, zero when not given.
        temperature, temperature_increment : TEMP at the start and DTEMP, degC.
        material : CMNAME, at most 80 characters.
        increment : KINC, the number of the increment in its step.
        strain, strain_increment : (ntens,) STRAN and DSTRAN, zero when not given.
        rotation : (3, 3) DROT, the identity when not given.

        Raises
        ------
        InputError
            An array has the wrong shape.
        """
        constants, state = _vector(props), _vector(statev)
        sigma = np.zeros(ntens) if stress is None else np.array(stress, dtype=np.float64)
        tangent = np.zeros((ntens, ntens), order="F")
        sse, spd, scd, rpl, drpldt, celent = np.zeros((6, 1))
        ddsddt, drplde = np.zeros((2, ntens))
        stran, dstran = (np.zeros(ntens) if given is None else _vector(given) for given in (strain, strain_increment))
        pnewdt, drot = np.array([NO_OPINION]), _matrix("rotation", np.eye(3) if rotation is None else rotation)
        self._umat(*_pointers((
            sigma, state, tangent, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran,
            _vector(time), _vector(dt), _vector(temperature), _vector(temperature_increment), np.zeros(1), np.zeros(1),
            np.array([material.encode("ascii").ljust(80)]), *_integers(ndi, ntens - ndi, ntens, state.size),
            constants, *_integers(constants.size), np.zeros(3), drot, pnewdt, celent, _matrix("f0", f0), _matrix("f1", f1),
            *_integers(1, 1, 1, 1, 1, increment),
        )), ctypes.c_size_t(80))  # fmt: skip
        (messages, stopped), said = self.take_messages(), float(pnewdt[0])
        energies = float(sse[0]), float(spd[0]), float(scd[0])
        return CallResult(sigma, np.array(tangent), state, *energies, said, messages, stopped, ddsddt)


@dataclass(frozen=True)
class QuadResult:
    """What one call in quadruple precision returned, each number as the sum of two doubles along the last axis.

    Parameters
    ----------
    stress : (6, 2) Cauchy stress in MPa.
    ddsdde : (6, 6, 2) tangent in MPa.
    statev : (n, 2) state at the end.
    pnewdt : suggested ratio of the time increment.
    messages, stopped : as in `CallResult`.
    """

    stress: Array
    ddsdde: Array
    statev: Array
    pnewdt: float
    messages: str
    stopped: bool


class QuadLibrary(UmatLibrary):
    """A UMAT compiled with `plyflow.umat.compile.QUAD_FLAGS`.

    Raises
    ------
    ToolError
        The library was not compiled in quadruple precision.
    """

    def __init__(self, path: Path | str) -> None:
        super().__init__(path)
        try:
            self._quad = self._library.plyflow_quad_call
        except AttributeError as error:
            raise ToolError(f"{self.path} has no plyflow_quad_call; compile it with QUAD_FLAGS") from error
        self._quad.restype = None

    def call_quad(self, f0: ArrayLike, f1: ArrayLike, dt: float, props: ArrayLike, statev: ArrayLike) -> QuadResult:
        """One call with the double-precision input taken as exact; arguments as in `UmatLibrary.call`."""
        constants, state, pnewdt = _vector(props), _vector(statev), np.zeros(1)
        stress, tangent, after = (np.zeros((*shape, 2), order="F") for shape in ((6,), (6, 6), (state.size,)))
        start, end, step, given, old = _pointers((_matrix("f0", f0), _matrix("f1", f1), _vector(dt), constants, state))
        sizes = ctypes.c_int(constants.size), ctypes.c_int(state.size)
        self._quad(start, end, step, sizes[0], given, sizes[1], old, *_pointers((stress, tangent, after, pnewdt)))
        messages, stopped = self.take_messages()
        return QuadResult(stress, tangent, after, float(pnewdt[0]), messages, stopped)


def _address(function: ctypes._NamedFuncPointer) -> int:
    return int(ctypes.cast(function, ctypes.c_void_p).value or 0)


def _pointers(arrays: Iterable[NDArray[Any]]) -> list[ctypes.c_void_p]:
    """Pointers that keep their arrays alive."""
    return [array.ctypes.data_as(ctypes.c_void_p) for array in arrays]


def _integers(*values: int) -> list[NDArray[np.int32]]:
    return [np.array([value], dtype=np.int32) for value in values]


def _vector(value: ArrayLike) -> Array:
    return np.array(value, dtype=np.float64).ravel()


def _matrix(name: str, value: ArrayLike) -> Array:
    matrix = np.asfortranarray(value, dtype=np.float64)
    if matrix.shape != (3, 3):
        raise InputError(f"{name} has shape {matrix.shape}; a deformation gradient is 3 by 3")
    return matrix
