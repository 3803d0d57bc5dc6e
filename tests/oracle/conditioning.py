"""How much the answer moves when the doubles it is computed from move by one unit in the last place."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from mpmath import mp

from oracle.algebra import Real, voigt
from oracle.response import ddsdde, stress
from oracle.states import State

Quantity = Callable[[State], Sequence[Real]]
DIGITS = 40


def stress_components(state: State) -> Sequence[Real]:
    """Cauchy stress, six components."""
    return voigt(stress(state.start, state.end, state.time_increment, state.props, state.locked, digits=DIGITS))


def tangent_components(state: State) -> Sequence[Real]:
    """DDSDDE, thirty-six entries."""
    rows = ddsdde(state.start, state.end, state.time_increment, state.props, state.locked, digits=DIGITS)
    return [entry for row in rows for entry in row]


def ulp_sensitivity(state: State, quantity: Quantity = stress_components) -> float:
    """Relative change of a quantity for one ulp in every entry of F0, F1 and PROPS, signs at their worst.

    First order, relative to the largest component. Input that carries one rounding leaves the quantity
    uncertain by half of this; a backward stable routine does no worse than a small multiple of it.
    """
    with mp.workdps(DIGITS):
        base = quantity(state)
        movement = [mp.mpf(0)] * len(base)
        for neighbour in _neighbours(state):
            moved = quantity(neighbour)
            movement = [m + abs(s - b) for m, s, b in zip(movement, moved, base, strict=True)]
        return float(max(movement) / max(abs(b) for b in base))


def _neighbours(state: State) -> Iterator[State]:
    for name in ("start", "end", "props"):
        values: Any = getattr(state, name)
        for index in np.ndindex(values.shape):
            moved = values.copy()
            moved[index] = np.nextafter(moved[index], np.inf)
            yield replace(state, **{name: moved})
