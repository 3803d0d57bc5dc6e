"""A host of one material point in Python, and the mistakes it can make on demand."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from plyflow.diagnose.calls import strain_and_rotation
from plyflow.hosts.canary.files import umat

Array = NDArray[np.float64]
SIZE, STEPS, ITERATIONS = 2.0, 4, 2


def gradient(time: float) -> Array:
    """Stretch, shear in all planes and a turn, some hundredths an increment."""
    part = time / (SIZE * STEPS)
    turn = Rotation.from_rotvec([0.1 * part, 0.05 * part, 0.2 * part]).as_matrix()
    return turn @ (np.eye(3) + part * np.array([[0.1, 0.06, -0.04], [0.0, -0.08, 0.05], [0.0, 0.0, 0.07]]))


@dataclass
class Call:
    """What the host hands over."""

    f0: Array
    f1: Array
    dt: float
    state: Array
    time: tuple[float, float]
    increment: int
    strain_increment: Array
    rotation: Array
    ndi: int = 3
    options: dict[str, Any] = field(default_factory=dict)


Change = Callable[[Call], Call]


def host(
    copy: Path, change: Change = lambda call: call, *, ask: bool = False, ignores_ratio: bool = False, keeps_attempt: bool = False,
    carries: bool = True,
) -> str:
    """Drive the canary over the path; what it said.

    Parameters
    ----------
    change : what the host does to a call before it makes it.
    ask : whether the canary asks for half an increment; ignores_ratio: whether the host goes on nevertheless.
    keeps_attempt : whether the next call begins with the state that the last one left, accepted or not.
    carries : whether the state goes from increment to increment.
    """
    library, said = umat(copy), []
    props = [1.0, 3.0, 1.0, float(ask)]
    time, number, size, start, state = 0.0, 1, SIZE, np.eye(3), np.zeros(12)
    while time < SIZE * STEPS - 1e-9 and size > 0.1 * SIZE:
        for trial in range(ITERATIONS):
            end = gradient(time + size) if trial else start + 0.9 * (gradient(time + size) - start)
            strain, turn = strain_and_rotation(start, end)
            call = change(Call(start, end, size, state, (time, time), number, strain, turn))
            answer = library.call(
                call.f0, call.f1, call.dt, props, call.state, time=call.time, increment=call.increment, ndi=call.ndi,
                strain_increment=call.strain_increment, rotation=call.rotation, **call.options,
            )  # fmt: skip
            said.append(answer.messages)
            if keeps_attempt:
                state = answer.statev
            if answer.stopped:
                return "\n".join(filter(None, said))
            if answer.pnewdt < 1.0 and not ignores_ratio:
                break
        else:
            time, number, start = time + size, number + 1, end
            state = answer.statev if carries else np.zeros(12)
            continue
        size *= answer.pnewdt
    return "\n".join(filter(None, said))


def changed(**values: Callable[[Call], Any]) -> Change:
    """A host that hands over something else."""
    return lambda call: replace(call, **{name: value(call) for name, value in values.items()})


def late(change: Change) -> Change:
    """A mistake that begins with the third increment."""
    return lambda call: change(call) if call.increment > 2 else call


# d sigma_33 by the logarithmic strain, sides held, as a host makes it of DDSDDE(3,3) that it takes for each rate.
ASSUMED: dict[int, Callable[[float, float], float]] = {
    1: lambda stiffness, stress: stiffness - stress,
    2: lambda stiffness, stress: stiffness + stress,
    3: lambda stiffness, stress: stiffness,
}


def iterations(copy: Path, rate: int, assumed: int, pressure: float = 2.0) -> int:
    """Newton iterations of a host, which takes DDSDDE for that of one rate, with the canary that returns that of another."""
    library, stretch = umat(copy), 1.0
    for count in range(1, 100):
        f = np.diag([1.0, 1.0, stretch])
        answer = library.call(np.eye(3), f, 1.0, [1.0, 3.0, float(rate), 0.0], np.zeros(12))
        stress = float(answer.stress[2])
        if abs(stress + pressure) < 1e-12 * pressure:
            return count
        stretch *= np.exp(-(stress + pressure) / ASSUMED[assumed](float(answer.ddsdde[2, 2]), stress))
    return 100
