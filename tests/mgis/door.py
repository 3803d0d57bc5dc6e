"""The call of an MGIS host, made from Python: the structures of version 1 of the generic interface, and tensors by their orders."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
ROOT_2 = np.sqrt(2.0)
TENSOR = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1))
SYMMETRIC = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_STATE = (
    "gradients", "thermodynamic_forces", "mass_density", "material_properties", "internal_state_variables", "stored_energy",
    "dissipated_energy", "external_state_variables",
)  # fmt: skip


class State(ctypes.Structure):
    """One end of an increment."""

    _fields_ = [(name, ctypes.c_void_p) for name in _STATE]


class Point(ctypes.Structure):
    """What the host hands over."""

    _fields_ = [
        ("error_message", ctypes.c_char_p), ("dt", ctypes.c_double), ("K", ctypes.c_void_p), ("rdt", ctypes.c_void_p),
        ("speed_of_sound", ctypes.c_void_p), ("s0", State), ("s1", State),
    ]  # fmt: skip


@dataclass
class Answer:
    """Outcome, forces, operator as a matrix, the UMAT's state, energies, proposed ratio of the increment, message."""

    outcome: int
    forces: Array
    operator: Array
    state: Array
    energies: Array
    ratio: float
    message: str


class Door:
    """One behaviour of a library."""

    def __init__(self, path: Path, name: str, hypothesis: str = "Tridimensional") -> None:
        self.library, self.name, self.hypothesis = ctypes.CDLL(str(path)), name, hypothesis
        plane = hypothesis != "Tridimensional"
        self.full, self.short = TENSOR[: 5 if plane else 9], SYMMETRIC[: 4 if plane else 6]

    def symbol(self, suffix: str) -> Any:
        """A function of the hypothesis."""
        return getattr(self.library, f"{self.name}_{self.hypothesis}{suffix}")

    def number(self, suffix: str) -> int:
        """A number of the metadata."""
        return ctypes.c_ushort.in_dll(self.library, f"{self.name}_{suffix}").value

    def names(self, suffix: str) -> list[str]:
        """A list of the metadata."""
        found = (ctypes.c_char_p * self.number(f"n{suffix}")).in_dll(self.library, f"{self.name}_{suffix}")
        return [one.decode() for one in found]

    def __call__(
        self, f0: Array, f1: Array, dt: float, props: ArrayLike, state: ArrayLike, *, wanted: float = 4.0, measure: int = 0,
        operator: int = 0, temperatures: tuple[float, float] = (70.0, 70.0),
        kept: Array | None = None,
    ) -> Answer:  # fmt: skip
        """One call; `kept` is the gradient in the state, default that of the start."""
        rows = len(self.full) if operator == 2 else len(self.short)
        columns = len(self.short) if operator == 1 else len(self.full)
        K, ratio, text = np.zeros(81), np.ones(1), ctypes.create_string_buffer(512)
        K[:3] = wanted, measure, operator
        start, end, last = (np.array([f[i, j] for i, j in self.full]) for f in (f0, f1, f0 if kept is None else kept))
        forces, before, energies = np.zeros(9), np.array([*np.ravel(state), *last]), np.zeros(4)
        after = np.full(before.size, np.nan)
        constants, cold, warm = np.array(props, dtype=float), *(np.array([t]) for t in temperatures)
        s0 = State(*map(_place, (start, np.zeros(9), None, constants, before, energies, energies[1:], cold)))
        s1 = State(*map(_place, (end, forces, None, constants, after, energies[2:], energies[3:], warm)))
        point = Point(ctypes.cast(text, ctypes.c_char_p), dt, _place(K), _place(ratio), None, s0, s1)
        outcome = self.symbol("")(ctypes.byref(point))
        count = len(self.full) if measure == 2 else len(self.short)
        shown = K[: rows * columns].reshape(rows, columns)
        assert outcome != 1 or wanted < 0.0 or (after[np.size(state) :] == end).all()
        return Answer(outcome, forces[:count], shown, after[: np.size(state)], energies[2:], float(ratio[0]), text.value.decode())

    def turned(self, suffix: str, values: Array, basis: Array) -> Array:
        """What the rotation of that name makes of components; the columns of the basis are the material axes."""
        made, given, axes = np.zeros(values.size), np.ascontiguousarray(values.ravel()), np.ascontiguousarray(basis)
        self.symbol(f"_rotate{suffix}")(*(ctypes.c_void_p(_place(a)) for a in (made, given, axes)))
        return made.reshape(values.shape)


def _place(array: Array | None) -> int | None:
    return None if array is None else array.ctypes.data


def mandel(tensor: Array, short: tuple[tuple[int, int], ...] = SYMMETRIC) -> Array:
    """Components of a symmetric tensor, shears times sqrt 2."""
    return np.array([tensor[i, j] * (1.0 if i == j else ROOT_2) for i, j in short])
