"""The pressed square of section 5 as a mesh: layers of plies, what they share, their frames."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import felupe
import numpy as np
from numpy.typing import NDArray

from plyflow.case.case import Case
from plyflow.errors import InputError
from plyflow.hosts.laminate.element import Array

RIGHT_ANGLES = (0.0, 90.0)
STRETCHED = 1.5  # length of an element of an arm over that of the one before it


@dataclass(frozen=True)
class Specimen:
    """Blocks of plies between plates.

    Parameters
    ----------
    case : Case
        Material, block thickness, width, load.
    angles : tuple of float
        Fibre directions of the blocks, degrees from x, bottom to top.
    cells : int
        Elements along the edge of the quarter; each block is one element thick.
    arms : float
        Length [mm] of the plies beyond the plates, on either side along their fibres: the arms of a crucifix.

    Raises
    ------
    InputError
        No cells; arms shorter than nothing, or of plies that lie askew.
    """

    case: Case
    angles: tuple[float, ...]
    cells: int = 8
    arms: float = 0.0

    def __post_init__(self) -> None:
        if self.cells < 1:
            raise InputError(f"--cells {self.cells}: give at least one element along the edge of the quarter")
        if not (math.isfinite(self.arms) and self.arms >= 0.0):
            raise InputError(f"--arms {self.arms:g}: a length in mm of at least 0")
        if self.arms and not self.quarter:
            raise InputError(f"--arms {self.arms:g}: plies of a crucifix lie at 0 and 90 degrees; leave the arms out")

    @property
    def quarter(self) -> bool:
        """Whether the planes x = 0 and y = 0 are planes of symmetry: all fibres lie along x or y."""
        return all(angle % 180.0 in RIGHT_ANGLES for angle in self.angles)

    @property
    def share(self) -> float:
        """Share of the specimen that is meshed."""
        return 0.25 if self.quarter else 1.0

    @cached_property
    def mesh(self) -> felupe.Mesh:
        """All blocks, each with nodes of its own, block after block; then the arms."""
        edge, h0 = self.case.width / 2.0, self.case.block_thickness
        low, n = (0.0, self.cells + 1) if self.quarter else (-edge, 2 * self.cells + 1)
        layers = [
            felupe.Cube(a=(low, low, i * h0), b=(edge, edge, (i + 1) * h0), n=(n, n, 2)) for i in range(len(self.angles))
        ]
        square = felupe.mesh.concatenate(layers)
        return self._with_arms(square) if self.arms else square

    @property
    def columns(self) -> int:
        """Elements of a block between the plates."""
        return (self.cells if self.quarter else 2 * self.cells) ** 2

    @property
    def nodes(self) -> int:
        """Nodes of a block's face between the plates."""
        return (math.isqrt(self.columns) + 1) ** 2

    @property
    def layer(self) -> NDArray[np.intp]:
        """Block (c,) of each element."""
        blocks = np.arange(len(self.angles))
        outside = int(self.mesh.ncells) // len(blocks) - self.columns
        return np.concatenate([np.repeat(blocks, self.columns), np.repeat(blocks, outside)])

    def _with_arms(self, square: felupe.Mesh) -> felupe.Mesh:
        """The mesh and elements beyond the edges across the fibres, longer and longer, to the end of the arms."""
        edge = self.case.width / 2.0
        count = math.ceil(math.log1p(self.arms * (STRETCHED - 1.0) * self.cells / edge) / math.log(STRETCHED))
        lengths = STRETCHED ** np.arange(1, count + 1) - 1.0
        points, cells = [square.points], [square.cells]
        last = len(square.points)
        for block, angle in enumerate(self.angles):
            axis = 0 if math.isclose(angle % 180.0, 0.0, abs_tol=1e-9) else 1
            rims = [face[np.isclose(square.points[face, axis], edge)] for face in self.faces(block)]
            ends = np.concatenate(rims)
            for length in self.arms * lengths / lengths[-1]:
                new = [last + np.arange(len(rim)) + len(rim) * i for i, rim in enumerate(rims)]
                points.append(square.points[ends] + length * np.eye(3)[axis])
                quads = [_quads(near, far, axis) for near, far in zip(rims, new, strict=True)]
                cells.append(np.hstack(quads))
                rims, last = new, last + len(ends)
        return felupe.Mesh(np.vstack(points), np.vstack(cells), square.cell_type)

    @property
    def frames(self) -> Array:
        """(c, 3, 3) columns: fibre, across, ply normal of each element."""
        turn = np.radians(self.angles)
        frames = np.zeros((len(turn), 3, 3))
        frames[:, 0, 0] = frames[:, 1, 1] = np.cos(turn)
        frames[:, 1, 0] = np.sin(turn)
        frames[:, 0, 1] = -np.sin(turn)
        frames[:, 2, 2] = 1.0
        return frames[self.layer]

    def faces(self, block: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Nodes of the lower and the upper face of a block, in the same order."""
        start = 2 * self.nodes * block
        return np.arange(start, start + self.nodes), np.arange(start + self.nodes, start + 2 * self.nodes)

    def unknowns(self, sticking: bool) -> NDArray[np.intp]:
        """(3 nodes,) unknown that each displacement of a node is, -1 where it is held; the last unknown is the plate's.

        Blocks of different directions share the normal displacement, those of the same all of it.

        Parameters
        ----------
        sticking : bool
            Whether plates hold the outer plies in their plane, so that a whole square needs no support there.
        """
        owner = np.arange(3 * self.mesh.npoints).reshape(-1, 3)
        for block, (below, above) in enumerate(zip(self.angles, self.angles[1:], strict=False)):
            tied = slice(None) if math.isclose(below % 180.0, above % 180.0) else slice(2, 3)
            owner[self.faces(block + 1)[0], tied] = owner[self.faces(block)[1], tied]
        held = self._held(sticking)
        held[self.faces(0)[0], 2] = True
        top = self.faces(len(self.angles) - 1)[1]
        owner[top, 2] = owner[top[0], 2]
        plate = owner[top[0], 2]
        free = np.append(np.setdiff1d(np.unique(owner[~held]), [plate]), plate)
        number = np.full(owner.size, -1)
        number[free] = np.arange(len(free))
        return np.where(held, -1, number[owner]).ravel()

    def _held(self, sticking: bool) -> NDArray[np.bool_]:
        """(nodes, 3) displacements held: by symmetry, or to keep a whole layer from drifting and turning."""
        points = self.mesh.points
        held: NDArray[np.bool_] = np.isclose(points, 0.0, atol=1e-9 * self.case.width)
        held[:, 2] = False
        if self.quarter:
            return held
        centre, turning = held[:, 0] & held[:, 1], np.isclose(points[:, 0], points[:, 0].max()) & held[:, 1]
        outer = np.isin(np.arange(len(points)) // (2 * self.nodes), (0, len(self.angles) - 1)) & sticking
        return np.column_stack([centre, centre | (turning & ~outer), np.zeros(len(points), dtype=bool)])


def _quads(near: NDArray[np.intp], far: NDArray[np.intp], axis: int) -> NDArray[np.intp]:
    """(n - 1, 4) corners between two rows of n nodes, counter-clockwise from above; the rows lie one after another along axis."""
    corners = near[:-1], far[:-1], far[1:], near[1:]
    return np.column_stack(corners if axis == 0 else (near[:-1], near[1:], far[1:], far[:-1]))
