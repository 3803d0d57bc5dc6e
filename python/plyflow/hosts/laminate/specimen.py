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

    Raises
    ------
    InputError
        No cells.
    """

    case: Case
    angles: tuple[float, ...]
    cells: int = 8

    def __post_init__(self) -> None:
        if self.cells < 1:
            raise InputError(f"--cells {self.cells}: give at least one element along the edge of the quarter")

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
        """All blocks, each with nodes of its own, block after block."""
        edge, h0 = self.case.width / 2.0, self.case.block_thickness
        low, n = (0.0, self.cells + 1) if self.quarter else (-edge, 2 * self.cells + 1)
        layers = [
            felupe.Cube(a=(low, low, i * h0), b=(edge, edge, (i + 1) * h0), n=(n, n, 2)) for i in range(len(self.angles))
        ]
        return felupe.mesh.concatenate(layers)

    @property
    def nodes(self) -> int:
        """Nodes of a block's face."""
        return int(self.mesh.npoints) // (2 * len(self.angles))

    @property
    def layer(self) -> NDArray[np.intp]:
        """Block (c,) of each element."""
        blocks = len(self.angles)
        return np.repeat(np.arange(blocks), int(self.mesh.ncells) // blocks)

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
