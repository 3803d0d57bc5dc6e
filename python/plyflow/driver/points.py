"""One call of a UMAT at each of many material points, shared out over threads by the Fortran driver (OpenMP).

A library with a batch routine (NAME_batch.f90 of the scene) does blocks of points with vector instructions; every result is
within 1e-13 of that of a single call (`plyflow.umat.library.UmatLibrary.call`), relative to the largest component. Points with a
fault or through the lock, and all points of other libraries, are called one by one: bit for bit a single call. No bit depends on
the number of threads.
"""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from plyflow.driver.drive import Library, binding
from plyflow.driver.history import OUTCOMES, text_of
from plyflow.errors import InputError

Array = NDArray[np.float64]
FEWEST_FOR_BLOCKS = 64  # below, the routine's compilation does not pay
_ONE_BATCH_AT_A_TIME = threading.Lock()


@dataclass(frozen=True)
class BatchResult:
    """What the calls at n points returned.

    Parameters
    ----------
    stress : (n, ntens) Cauchy stress in MPa, order 11, 22, 33, 12, 13, 23.
    ddsdde : (n, ntens, ntens) tangent in MPa, ddsdde[p, i, j] = d stress_i / d strain_j with engineering shear.
    statev : (n, n_statev) state at the end.
    energies : (n, 3) SSE, SPD, SCD in MPa.
    pnewdt : (n,) suggested ratio of the time increment; `plyflow.umat.library.NO_OPINION` where the UMAT said nothing.
    outcome : (n,) "converged" (the point can be used), or why not: "pnewdt", "inverted", "not_finite", "stopped".
    messages : what the UMAT said through STDB_ABQERR, by point (from 0); points without words are missing.
    in_blocks : number of points that the batch routine did; the others were called one by one.
    """

    stress: Array
    ddsdde: Array
    statev: Array
    energies: Array
    pnewdt: Array
    outcome: NDArray[np.str_]
    messages: dict[int, str]
    in_blocks: int = 0

    @property
    def failed(self) -> NDArray[np.intp]:
        """Points (from 0) whose result cannot be used as it is."""
        return np.flatnonzero(self.outcome != OUTCOMES[0])


def call_points(
    library: Library,
    props: ArrayLike,
    f0: ArrayLike,
    f1: ArrayLike,
    dt: ArrayLike,
    statev: ArrayLike,
    stress: ArrayLike | None = None,
    *,
    energies: ArrayLike | None = None,
    temperature: ArrayLike = 0.0,
    time: Sequence[float] = (0.0, 0.0),
    ntens: int = 6,
    increment: int = 1,
    threads: int | None = None,
    out: BatchResult | None = None,
    blocks: bool = True,
) -> BatchResult:
    """Call the UMAT once at each point.

    Parameters
    ----------
    library : the compiled UMAT.
    props : (n_props,) constants of all points, or (n, n_props) of each.
    f0, f1 : (n, 3, 3) deformation gradients at the start and end of the increment.
    dt : time increment in s, a number or (n,).
    statev : (n, n_statev) state at the start; it is not changed.
    stress : (n, ntens) Cauchy stress at the start in MPa, default zero.
    energies : (n, 3) SSE, SPD, SCD at the start in MPa, default zero.
    temperature : degC, a number or (n,).
    time : step time and total time at the start in s.
    ntens : 6, or 4 for scenes of plane strain and axisymmetric elements.
    increment : KINC, the number of the increment in its step.
    threads : number of threads; default what OpenMP takes by itself (OMP_NUM_THREADS, else all cores).
    out : result of an earlier call with as many points, stresses and states, whose arrays are written anew and handed back: no
        memory is asked for. `stress`, `energies` and `statev` may be its own, the state then goes on from there.
    blocks : whether the library's batch routine is used, if it has one and there are at least `FEWEST_FOR_BLOCKS` points.

    Raises
    ------
    InputError
        An array has the wrong shape, also one of `out`; or a number of threads below 1.
    ToolError
        The Fortran driver is not built.
    """
    start, end = _gradients("f0", f0), _gradients("f1", f1)
    n = len(start)
    state = _points("statev", statev, n)
    if len(end) != n or ntens not in (4, 6):
        raise InputError(f"f0 has {n} points, f1 {len(end)}, ntens is {ntens}: give as many of both, and ntens 4 or 6")
    result = _fresh(n, ntens, state.shape[1]) if out is None else _reused(out, n, ntens, state.shape[1])
    result.statev[...] = state
    result.stress[...] = 0.0 if stress is None else _points("stress", stress, n, ntens)
    result.energies[...] = 0.0 if energies is None else _points("energies", energies, n, 3)
    numbers, spoken = np.zeros((2, n), dtype=np.int32)
    constants = _constants(props, n)
    batch = int(getattr(library, "batch_address", 0)) if blocks and n >= FEWEST_FOR_BLOCKS else 0
    with _ONE_BATCH_AT_A_TIME:
        driver = binding("driver_batch")
        in_blocks = driver.call_points(
            library.address, library.standin_address, batch, _threads(threads, driver), n, constants.shape[1], len(constants),
            state.shape[1], ntens, increment, constants.T, _each("temperature", temperature, n), np.array(time, dtype=float),
            _each("dt", dt, n), start.T, end.T, result.stress.T, result.statev.T, result.energies.T,
            result.ddsdde.transpose(1, 2, 0), result.pnewdt, numbers, spoken,
        )  # fmt: skip
        np.take(OUTCOMES, numbers, out=result.outcome, mode="clip")
        messages = {int(p): text_of(driver.get_point_message(int(p) + 1)) for p in np.flatnonzero(spoken)}
        return replace(result, messages=messages, in_blocks=int(in_blocks))


def available_threads() -> int:
    """Number of threads that a batch takes by default; 1 when the driver was built without OpenMP.

    Raises
    ------
    ToolError
        The Fortran driver is not built.
    """
    return int(binding("driver_batch").available_threads())


def _fresh(n: int, ntens: int, n_statev: int) -> BatchResult:
    tangent = np.empty((n, ntens, ntens)).transpose(0, 2, 1)  # Fortran's columns
    outcome = np.empty(n, dtype=np.array(OUTCOMES).dtype)
    return BatchResult(np.empty((n, ntens)), tangent, np.empty((n, n_statev)), np.empty((n, 3)), np.empty(n), outcome, {})


def _reused(out: BatchResult, n: int, ntens: int, n_statev: int) -> BatchResult:
    found = out.stress.shape, out.statev.shape
    if found != ((n, ntens), (n, n_statev)):
        raise InputError(f"out has stress {found[0]} and statev {found[1]}; wanted {(n, ntens)} and {(n, n_statev)}")
    return out


def _threads(wanted: int | None, driver: Any) -> int:
    if wanted is None:
        return int(driver.available_threads())
    if wanted < 1:
        raise InputError(f"threads is {wanted}; it must be at least 1, or left out for all cores")
    return wanted


def _gradients(name: str, value: ArrayLike) -> Array:
    """(n, 3, 3), rows first."""
    array = np.asarray(value, dtype=float)
    if array.ndim != 3 or array.shape[1:] != (3, 3):
        raise InputError(f"{name} has shape {array.shape}; deformation gradients of n points are (n, 3, 3)")
    return np.ascontiguousarray(array)


def _points(name: str, value: ArrayLike, n: int, width: int | None = None) -> Array:
    array = np.asarray(value, dtype=float)
    if array.ndim != 2 or len(array) != n or (width is not None and array.shape[1] != width):
        raise InputError(
            f"{name} has shape {array.shape}; wanted ({n}, {'number of values' if width is None else width})"
        )
    return array


def _each(name: str, value: ArrayLike, n: int) -> Array:
    array = np.asarray(value, dtype=float)
    if array.shape not in ((), (n,)):
        raise InputError(f"{name} has shape {array.shape}; give one number or ({n},)")
    return np.ascontiguousarray(np.broadcast_to(array, (n,)))


def _constants(props: ArrayLike, n: int) -> Array:
    array = np.ascontiguousarray(props, dtype=float)
    if array.ndim == 1:
        array = array[None, :]
    if array.ndim != 2 or len(array) not in (1, n):
        raise InputError(f"props has shape {array.shape}; give (n_props,), or ({n}, n_props) for each point its own")
    return array
