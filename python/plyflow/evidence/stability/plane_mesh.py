"""Four-node plane-strain elements with any UMAT at 2 x 2 points, J averaged over the element as C3D8 and CPE4 do.

The fibre (axis 1) stands out of the plane and is held; the mesh lies in axes 2 (across) and 3 (thickness).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

Array = NDArray[np.float64]
IN_PLANE = [1, 2, 5]  # 22, 33, 23 of the UMAT's order
CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
SHAPE_SLOPES = 0.25 * CORNERS * (1.0 + CORNERS[:, None, ::-1] * CORNERS[:, ::-1] / np.sqrt(3.0))  # point, node, direction


@dataclass(frozen=True)
class Mesh:
    """Nodes, elements, what their displacements are tied to, and where the plate presses.

    Parameters
    ----------
    nodes : (n, 2) places in mm.
    elements : (e, 4) node numbers, counterclockwise.
    ties : (2 n, q) displacements of all nodes from the q unknowns, in mm.
    plate : the unknown that is the plate's displacement.
    length, height : of the whole, in mm.
    """

    nodes: Array
    elements: NDArray[np.intp]
    ties: Any
    plate: int
    length: float
    height: float

    @cached_property
    def slopes(self) -> Array:
        """(e, 4, 4, 2) derivatives of the shape functions by place, in 1/mm: element, point, node, direction."""
        return np.asarray(np.einsum("paj,epji->epai", SHAPE_SLOPES, np.linalg.inv(self._local)))

    @cached_property
    def weights(self) -> Array:
        """(e, 4) area of each point in mm2."""
        return np.asarray(np.linalg.det(self._local))

    @property
    def _local(self) -> Array:
        """(e, 4, 2, 2) derivatives of the place by the element's own coordinates."""
        return np.asarray(np.einsum("eai,paj->epij", self.nodes[self.elements], SHAPE_SLOPES))

    @cached_property
    def unknowns(self) -> NDArray[np.intp]:
        """(e, 8) numbers of the nodal displacements of each element."""
        return (2 * self.elements[:, :, None] + np.arange(2)).reshape(len(self.elements), 8)

    def gradients(self, displacement: Array) -> tuple[Array, Array]:
        """(e, 4, 2, 2) deformation gradients in the plane as they are, and with the element's mean J.

        Parameters
        ----------
        displacement : (q,) unknowns in mm.
        """
        moved = self.nodes + (self.ties @ displacement).reshape(-1, 2)
        plain = np.einsum("eai,epaj->epij", moved[self.elements], self.slopes)
        volume = np.linalg.det(plain)
        mean = (self.weights * volume).sum(1) / self.weights.sum(1)
        with np.errstate(invalid="ignore", divide="ignore"):
            return plain, plain * np.sqrt(mean[:, None] / volume)[:, :, None, None]

    def forces(self, plain: Array, volume: Array, stress: Array, tangent: Array) -> tuple[Array, Any]:
        """Internal forces on the unknowns (q,) in N/mm, and their derivative (q, q), sparse.

        Parameters
        ----------
        plain : (e, 4, 2, 2) deformation gradients, not averaged.
        volume : (e,) mean J of the elements.
        stress, tangent : (e, 4, 3) Cauchy stress and (e, 4, 3, 3) DDSDDE in MPa, both of the averaged gradient, 22, 33, 23.
        """
        here = np.einsum("epai,epij->epaj", self.slopes, np.linalg.inv(plain))
        swept = self.weights * np.linalg.det(plain)
        swept /= swept.sum(1, keepdims=True)
        e, p = here.shape[:2]
        divergence = here.reshape(e, p, 8)
        mean = np.einsum("ep,epd->ed", swept, divergence)
        strain, spin = np.zeros((e, p, 3, 8)), np.zeros((e, p, 8))
        strain[:, :, 0, 0::2] = strain[:, :, 2, 1::2] = here[..., 0]
        strain[:, :, 1, 1::2] = strain[:, :, 2, 0::2] = here[..., 1]
        spin[..., 0::2], spin[..., 1::2] = 0.5 * here[..., 1], -0.5 * here[..., 0]
        strain[:, :, :2] += 0.5 * (mean[:, None] - divergence)[:, :, None]
        tau = self.weights[..., None] * volume[:, None, None] * stress
        turned = np.stack([2.0 * tau[..., 2], -2.0 * tau[..., 2], tau[..., 1] - tau[..., 0]], axis=-1)
        rate = np.einsum("ep,epij,epjd->epid", self.weights * volume[:, None], tangent, strain)
        rate += turned[..., None] * spin[:, :, None]
        stiff = np.einsum("epic,epid->ecd", strain, rate)
        full = tau[..., [0, 2, 2, 1]].reshape(e, p, 2, 2)
        stiff -= np.einsum("epij,epbj,epak->eaibk", full, here, here).reshape(e, 8, 8)
        crossed = np.einsum("epbi,epak->epaibk", here, here).reshape(e, p, 8, 8)
        pressure = 0.5 * (tau[..., 0] + tau[..., 1])
        products = np.einsum("epc,epd->epcd", divergence, divergence) - crossed
        spread = np.einsum("ep,epcd->ecd", swept, products) - np.einsum("ec,ed->ecd", mean, mean)
        stiff += pressure.sum(1)[:, None, None] * spread + np.einsum("ep,epcd->ecd", pressure, crossed)
        force = np.zeros(self.nodes.size)
        np.add.at(force, self.unknowns, np.einsum("epid,epi->ed", strain, tau))
        rows, columns = np.broadcast_arrays(self.unknowns[:, :, None], self.unknowns[:, None, :])
        whole = sparse.coo_array((stiff.ravel(), (rows.ravel(), columns.ravel())), shape=(force.size, force.size))
        return self.ties.T @ force, sparse.csc_array(self.ties.T @ whole.tocsr() @ self.ties)


def series(number: int) -> Mesh:
    """Stack `number` elements of 1 mm between plates without friction: each widens by itself, all carry the same force."""
    level = np.arange(number)
    nodes = (level[:, None, None] * [0.0, 1.0] + 0.5 * (CORNERS + 1.0)).reshape(-1, 2)
    node = 4 * level[:, None] + np.arange(4)
    pairs = [
        (2 * node[:, [1, 2]], number + level[:, None]),  # the right side moves as one
        (2 * node[:, [2, 3]] + 1, level[:, None]),  # the top
        (2 * node[1:, [0, 1]] + 1, level[1:, None] - 1),  # the bottom is the top of the element below
    ]
    return Mesh(nodes, node, _ties(pairs, nodes.size, 2 * number), number - 1, 1.0, float(number))


def block(across: int, high: int, sticking: bool = False, length: float = 2.0, height: float = 1.0) -> Mesh:
    """A rectangle under a rigid plate; symmetric about its left and lower edge, the right edge free.

    Parameters
    ----------
    across, high : number of elements.
    sticking : the material under the plate cannot move sideways.
    length, height : in mm.
    """
    grid = np.arange((across + 1) * (high + 1)).reshape(high + 1, across + 1)
    places = np.meshgrid(np.linspace(0.0, length, across + 1), np.linspace(0.0, height, high + 1))
    nodes = np.stack(places, axis=-1).reshape(-1, 2)
    corners = [grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]]
    own = np.concatenate([2 * grid[: -1 if sticking else None, 1:].ravel(), 2 * grid[1:-1].ravel() + 1])
    pairs = [(own, np.arange(own.size)), (2 * grid[-1] + 1, np.array(own.size))]
    elements = np.stack([corner.ravel() for corner in corners], axis=-1)
    return Mesh(nodes, elements, _ties(pairs, nodes.size, own.size + 1), own.size, length, height)


def _ties(pairs: Sequence[tuple[ArrayLike, ArrayLike]], rows: int, columns: int) -> Any:
    """Sparse matrix of ones from pairs of (nodal displacements, unknowns)."""
    spread = [np.broadcast_arrays(row, column) for row, column in pairs]
    row, column = (np.concatenate([pair[i].ravel() for pair in spread]) for i in (0, 1))
    return sparse.csr_array((np.ones(row.size), (row, column)), shape=(rows, columns))
