"""Single increments of a driven path, called from Python with all that Abaqus prepares: strains, rotation, turned stress."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from plyflow.diagnose.mistakes import VOIGT
from plyflow.driver.history import History
from plyflow.umat.library import CallResult, UmatLibrary

Array = NDArray[np.float64]
MOST_INCREMENTS = 12
_SHEAR = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])


@dataclass(frozen=True)
class Increment:
    """One increment: deformation gradients (3, 3), s, and stress and strain (6,) and state at its start, times in s."""

    start: Array
    end: Array
    size: float
    stress: Array
    strain: Array
    state: Array
    time: tuple[float, float]
    number: int

    def turned(self, turn: Array) -> Increment:
        """The same seen after a rigid turn."""
        return replace(
            self, start=turn @ self.start, end=turn @ self.end, stress=rotated(self.stress, turn),
            strain=rotated(self.strain / _SHEAR, turn) * _SHEAR,
        )  # fmt: skip


@dataclass(frozen=True)
class Subject:
    """A UMAT with its constants, temperature in degC, and increments of a path that it did."""

    library: UmatLibrary
    props: Sequence[float]
    temperature: float
    increments: Sequence[Increment]

    def call(self, one: Increment, library: UmatLibrary | None = None, props: Sequence[float] | None = None) -> CallResult:
        """One call as Abaqus makes it."""
        strain, turn = strain_and_rotation(one.start, one.end)
        return (library or self.library).call(
            one.start, one.end, one.size, self.props if props is None else props, one.state, rotated(one.stress, turn),
            time=one.time, temperature=self.temperature, material="UMAT", increment=one.number,
            strain=rotated(one.strain / _SHEAR, turn) * _SHEAR, strain_increment=strain, rotation=turn,
        )  # fmt: skip


def path_of(history: History) -> list[Increment]:
    """Increments of a history, spread over it, the first among them."""
    last = history.increments
    rows = np.unique(np.linspace(1, last, min(last, MOST_INCREMENTS)).astype(int)).tolist()
    return [
        Increment(
            history.deformation_gradient[row - 1], history.deformation_gradient[row], float(history.increment[row]),
            history.stress[row - 1], history.strain[row - 1], history.statev[row - 1],
            (float(history.step_time[row] - history.increment[row]), float(history.time[row - 1])),
            int(history.increment_number[row]),
        )
        for row in rows
    ]  # fmt: skip


def strain_and_rotation(start: Array, end: Array) -> tuple[Array, Array]:
    """DSTRAN (6,) and DROT (3, 3) by the midpoint rule (Hughes and Winget, 1980); not numbers where F is none."""
    try:
        gradient = (end - start) @ np.linalg.inv(0.5 * (start + end))
        spin = 0.25 * (gradient - gradient.T)
        turn = np.linalg.solve(np.eye(3) - spin, np.eye(3) + spin)
    except np.linalg.LinAlgError:
        gradient, turn = np.full((3, 3), np.nan), np.eye(3)
    strain = 0.5 * (gradient + gradient.T)
    return np.array([strain[i, j] for i, j in VOIGT]) * _SHEAR, np.asarray(turn)


def rotated(components: Array, turn: Array) -> Array:
    """Components (6,) of a symmetric tensor after a turn."""
    full = np.zeros((3, 3))
    for value, (i, j) in zip(components, VOIGT, strict=True):
        full[i, j] = full[j, i] = value
    full = turn @ full @ turn.T
    return np.array([full[i, j] for i, j in VOIGT])


def refused(answer: CallResult) -> bool:
    """Whether the UMAT asked for another increment or for the end."""
    return answer.stopped or answer.pnewdt < 1.0


def bits(answer: CallResult) -> bytes:
    """Everything a call returns, to the bit."""
    numbers = np.array([answer.sse, answer.spd, answer.scd, answer.pnewdt])
    return b"".join(np.ascontiguousarray(one).tobytes() for one in (answer.stress, answer.statev, answer.ddsdde, numbers))
