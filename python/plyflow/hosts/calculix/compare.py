"""A CalculiX job repeated by the project's own driver, point by point and increment by increment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plyflow.driver.drive import COMPONENTS, Controls, History, Library, Step, drive
from plyflow.errors import RunError
from plyflow.hosts.calculix.job import JobResult
from plyflow.hosts.mesh import CORNERS, Mesh

Array = NDArray[np.float64]
_CORNER_SIGNS = 2.0 * np.array(CORNERS) - 1.0
_GAUSS = 1.0 / np.sqrt(3.0)


@dataclass(frozen=True)
class Difference:
    """Largest difference between CalculiX and the driver, relative to the largest value of each quantity.

    Parameters
    ----------
    later : of stress and state from the second increment on.
    first_increment : of the stress in the first increment, which CalculiX accepts on a looser criterion.
    """

    later: float
    first_increment: float


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
        place = _GAUSS * np.array([2.0 * (point >> bit & 1) - 1.0 for bit in range(3)])
        slopes = _shape_slopes(place) @ np.linalg.inv(corners.T @ _shape_slopes(place))
        result[:, point] = np.eye(3) + np.einsum("tni,nj->tij", displacement, slopes)
    return result


def _shape_slopes(place: Array) -> Array:
    """Derivatives (8, 3) of the shape functions to the natural coordinates."""
    factors = 1.0 + _CORNER_SIGNS * place
    others = [np.delete(factors, axis, axis=1).prod(axis=1) for axis in range(3)]
    return np.asarray(_CORNER_SIGNS * np.stack(others, axis=1) / 8.0)


def drive_increments(
    library: Library,
    props: Sequence[float],
    n_statev: int,
    times: Sequence[float] | Array,
    gradients: Array,
    free: Sequence[str] = (),
) -> History:
    """Drive through deformation gradients (n, 3, 3) at the ends of increments, some components free of stress.

    Raises
    ------
    RunError
        The driver could not do it in these increments.
    """
    sizes = np.diff(times, prepend=0.0)
    steps = []
    for size, f in zip(sizes, gradients, strict=True):
        targets = {name: float(f[int(name[0]) - 1, int(name[1]) - 1]) for name in COMPONENTS}
        steps.append(Step(float(size), targets | dict.fromkeys(free, 0.0), dict.fromkeys(free, "S")))
    controls = Controls(
        initial_increment=float(max(sizes)), minimum_increment=float(min(sizes)), maximum_increment=float(max(sizes)),
        residual_tolerance=1e-12,
    )  # fmt: skip
    history = drive(library, props, n_statev, steps, controls)
    if not history.completed or history.increments != len(steps):
        raise RunError(
            f"the driver did {history.increments} increments in {len(steps)} steps: {history.message or 'sizes differ'}"
        )
    return history


def compare_points(
    result: JobResult, block: str, histories: Mapping[tuple[int, int], History], stresses_in_state: Sequence[int] = (6,)
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
    later = first = 0.0
    for place, history in histories.items():
        largest, scale = float(np.abs(history.stress).max()), np.abs(history.statev).max(axis=0)
        scale[[number - 1 for number in stresses_in_state]] = largest
        host = stresses.of(*place)
        first = max(first, _relative(host[:1], history.stress[1:2], np.full(6, largest)))
        later = max(later, _relative(host[1:], history.stress[2:], np.full(6, largest)))
        later = max(later, _relative(states.of(*place)[1:], history.statev[2:], scale))
    return Difference(later, first)


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
        gradients = deformation_gradients(mesh, element, table.values[:, [order[node] for node in nodes]])
        for point in range(8):
            found[element, point + 1] = drive_increments(library, props, n_statev, table.time, gradients[:, point])
    return found
