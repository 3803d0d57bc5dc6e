"""A CalculiX job repeated by the project's own driver, point by point and increment by increment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plyflow.driver.drive import Controls, History, Library, Step, drive
from plyflow.errors import RunError
from plyflow.hosts.abaqus.mesh import Mesh
from plyflow.hosts.calculix.job import JobResult

Array = NDArray[np.float64]
COMPONENTS = ("11", "22", "33", "12", "13", "23", "21", "31", "32")
_PLACE = {name: (int(name[0]) - 1, int(name[1]) - 1) for name in COMPONENTS}
_CORNER_SIGNS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float
)
_GAUSS = 1.0 / np.sqrt(3.0)


@dataclass(frozen=True)
class Difference:
    """Largest difference between CalculiX and the driver, relative to the largest value of each quantity.

    Parameters
    ----------
    stress, statev : relative differences from the second increment on.
    first_increment : of the stress in the first increment, which CalculiX accepts on a looser criterion.
    points : integration points compared.
    increments : increments compared.
    """

    stress: float
    statev: float
    first_increment: float
    points: int
    increments: int


def deformation_gradients(mesh: Mesh, element: int, displacement: Array) -> Array:
    """Deformation gradients (n, 8, 3, 3) at the eight points of a C3D8, in CalculiX's order.

    Parameters
    ----------
    displacement
        (n, 8, 3) in mm, of the element's nodes in the order of the element.
    """
    corners = np.array([mesh.nodes[node] for node in mesh.elements[element]])
    result = np.zeros((displacement.shape[0], 8, 3, 3))
    for point in range(8):
        bits = [point & 1, point >> 1 & 1, point >> 2 & 1]
        place = np.array([_GAUSS if bit else -_GAUSS for bit in bits])
        slopes = _shape_slopes(place) @ np.linalg.inv(corners.T @ _shape_slopes(place))
        result[:, point] = np.eye(3) + np.einsum("tni,nj->tij", displacement, slopes)
    return result


def _shape_slopes(place: Array) -> Array:
    """Derivatives (8, 3) of the shape functions to the natural coordinates."""
    factors = 1.0 + _CORNER_SIGNS * place
    slopes = np.empty((8, 3))
    for axis in range(3):
        others = [i for i in range(3) if i != axis]
        slopes[:, axis] = _CORNER_SIGNS[:, axis] * factors[:, others[0]] * factors[:, others[1]] / 8.0
    return slopes


def prescribed_steps(times: Sequence[float], gradients: Array) -> list[Step]:
    """One driver step for each increment, all components of F prescribed: gradients (n, 3, 3) at the ends."""
    starts = [0.0, *times[:-1]]
    return [
        Step(end - begin, {name: float(f[_PLACE[name]]) for name in COMPONENTS})
        for begin, end, f in zip(starts, times, gradients, strict=True)
    ]


def mixed_steps(times: Sequence[float], gradients: Array, free: Mapping[str, float], held: Sequence[str]) -> list[Step]:
    """Steps in which some components are free under a stress: `free` has their Cauchy stress in MPa."""
    starts = [0.0, *times[:-1]]
    return [
        Step(
            end - begin,
            {name: float(f[_PLACE[name]]) for name in held} | dict(free),
            dict.fromkeys(free, "S"),
        )
        for begin, end, f in zip(starts, times, gradients, strict=True)
    ]


def drive_increments(
    library: Library, props: Sequence[float], n_statev: int, steps: Sequence[Step], temperature: float = 0.0
) -> History:
    """Drive with one increment a step.

    Raises
    ------
    RunError
        The driver could not do it.
    """
    sizes = [step.duration for step in steps]
    controls = Controls(
        initial_increment=max(sizes), minimum_increment=min(sizes), maximum_increment=max(sizes),
        residual_tolerance=1e-12,
    )  # fmt: skip
    history = drive(library, props, n_statev, steps, controls, temperature=temperature)
    if not history.completed or history.increments != len(steps):
        raise RunError(
            f"the driver did {history.increments} increments in {len(steps)} steps: {history.message or 'sizes differ'}"
        )
    return history


def compare_points(
    result: JobResult,
    block: str,
    histories: Mapping[tuple[int, int], History],
    stresses_in_state: Sequence[int] = (6,),
) -> Difference:
    """Compare stress and state of some (element, point) with driver histories of the same increments.

    Parameters
    ----------
    result, block
        Job, and the element set whose S and SDV it printed.
    histories
        Of the driver, by (element, point).
    stresses_in_state
        State variables, counted from 1, that are stresses in MPa: measured by the largest stress.
    """
    stresses, states = result.tables["S", block], result.tables["SDV", block]
    worst_stress = worst_state = worst_first = 0.0
    for (element, point), history in histories.items():
        largest = float(np.abs(history.stress).max())
        scale = np.full(6, largest)
        host = stresses.of(element, point)
        worst_first = max(worst_first, _relative(host[:1], history.stress[1:2], scale))
        worst_stress = max(worst_stress, _relative(host[1:], history.stress[2:], scale))
        scale = np.abs(history.statev).max(axis=0)
        scale[[number - 1 for number in stresses_in_state]] = largest
        worst_state = max(worst_state, _relative(states.of(element, point)[1:], history.statev[2:], scale))
    return Difference(worst_stress, worst_state, worst_first, len(histories), len(stresses.time))


def _relative(host: Array, own: Array, scale: Array) -> float:
    difference = np.abs(host - own).max(axis=0)
    return float(np.max(difference / np.where(scale > 0.0, scale, 1.0)))


def histories_of_mesh(
    result: JobResult, mesh: Mesh, library: Library, props: Sequence[float], n_statev: int
) -> dict[tuple[int, int], History]:
    """Driver histories of every integration point, from the printed displacements of all nodes."""
    table = result.tables["U", "NALL"]
    order = {key[0]: row for row, key in enumerate(table.keys)}
    found = {}
    for element, nodes in mesh.elements.items():
        moved = table.values[:, [order[node] for node in nodes]]
        gradients = deformation_gradients(mesh, element, moved)
        for point in range(8):
            steps = prescribed_steps(list(table.time), gradients[:, point])
            found[element, point + 1] = drive_increments(library, props, n_statev, steps)
    return found
