"""Distances between what a UMAT returns and what the oracle says."""

from collections.abc import Iterable, Sequence
from functools import cache
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from oracle.algebra import voigt
from oracle.response import ddsdde, stress
from oracle.states import State

Array = NDArray[np.float64]
N_STATEV = 8
LOCKED = 4
"""Position of the lock among the state variables."""


class Answer(Protocol):
    """The part of a UMAT's answer that is compared: stress (6,), ddsdde (6, 6), MPa."""

    @property
    def stress(self) -> Array:
        """Cauchy stress at the end."""
        ...

    @property
    def ddsdde(self) -> Array:
        """Tangent at the end."""
        ...


class Library(Protocol):
    """Anything that can be called as a UMAT."""

    def call(self, f0: ArrayLike, f1: ArrayLike, dt: float, props: ArrayLike, statev: ArrayLike) -> Answer:
        """One increment."""
        ...


class Errors(NamedTuple):
    """Largest error of the stress and of the tangent, relative to the largest component."""

    stress: float
    ddsdde: float


def statev_at_start(locked: bool) -> Array:
    """State variables at the start of an increment of the given regime, (8,)."""
    statev = np.zeros(N_STATEV)
    statev[LOCKED] = float(locked)
    return statev


@cache
def witness_stress(state: State) -> Array:
    """Cauchy stress of the oracle in Voigt order, rounded once; MPa, (6,)."""
    exact = stress(state.start, state.end, state.time_increment, state.props, state.locked)
    return np.array([float(component) for component in voigt(exact)])


@cache
def witness_ddsdde(state: State) -> Array:
    """Perturbed Kirchhoff stress of the oracle, rounded once; MPa, (6, 6)."""
    exact = ddsdde(state.start, state.end, state.time_increment, state.props, state.locked)
    return np.array([[float(entry) for entry in row] for row in exact])


def relative_error(found: Iterable[Any] | Array, expected: Iterable[Any] | Array) -> float:
    """Largest difference relative to the largest expected entry; infinite where the found is not a number."""
    one, other = np.asarray(found, dtype=float), np.asarray(expected, dtype=float)
    if not np.all(np.isfinite(one)):
        return float("inf")
    return float(np.max(np.abs(one - other)) / np.max(np.abs(other)))


def scaled_error(found: Array, expected: Array) -> float:
    """Largest difference, each entry relative to the geometric mean of the largest in its row and column."""
    rows = np.max(np.abs(expected), axis=1, keepdims=True)
    columns = np.max(np.abs(expected), axis=0, keepdims=True)
    return float(np.max(np.abs(found - expected) / np.sqrt(rows * columns)))


def umat_errors(library: Library, states: Sequence[State]) -> list[Errors]:
    """Errors of a UMAT against the oracle, an entry per increment."""
    found = []
    for state in states:
        statev = statev_at_start(state.locked)
        answer = library.call(state.start, state.end, state.time_increment, state.props, statev)
        sigma = relative_error(answer.stress, witness_stress(state))
        found.append(Errors(sigma, relative_error(answer.ddsdde, witness_ddsdde(state))))
    return found
