"""Regular meshes of hexahedra, or of one quadrilateral, in the numbering that Abaqus and CalculiX share."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

IntArray = NDArray[np.int64]
Point = tuple[float, float, float]
Cells = tuple[int, int, int]
CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
# Outward face of C3D8 by axis and side.
FACES = {(2, 0): "S1", (2, 1): "S2", (1, 0): "S3", (0, 1): "S4", (1, 1): "S5", (0, 0): "S6"}


@dataclass
class Mesh:
    """Nodes and elements of one or more blocks, numbered from 1.

    Attributes
    ----------
    nodes, elements
        Coordinates in mm by node number; node numbers by element number.
    blocks, grids
        By block the numbers of its elements and of its nodes, (nz, ny, nx) and (nz + 1, ny + 1, nx + 1).
    """

    nodes: dict[int, Point] = field(default_factory=dict)
    elements: dict[int, tuple[int, ...]] = field(default_factory=dict)
    blocks: dict[str, IntArray] = field(default_factory=dict)
    grids: dict[str, IntArray] = field(default_factory=dict)

    def add_block(self, name: str, cells: Cells, size: Point, origin: Point = (0.0, 0.0, 0.0)) -> None:
        """Add a box of equal cells with nodes of its own, or with no cells along 3 a rectangle that is one cell.

        Parameters
        ----------
        name
            Of the block.
        cells
            Number of elements along each axis.
        size, origin
            In mm.
        """
        ticks = [o + s * np.arange(n + 1) / max(n, 1) for o, s, n in zip(origin, size, cells, strict=True)]
        x, y, z = (tick.tolist() for tick in ticks)
        grid = len(self.nodes) + 1 + np.arange(len(x) * len(y) * len(z)).reshape(len(z), len(y), len(x))
        if cells[2] == 0:
            grid[:, 1] = grid[:, 1, ::-1].copy()  # a quadrilateral is numbered around
        places: dict[int, Point] = {int(number): (x[i], y[j], z[k]) for (k, j, i), number in np.ndenumerate(grid)}
        self.nodes |= dict(sorted(places.items()))
        counts = [max(count, 1) for count in reversed(cells)]
        self.grids[name] = grid
        self.blocks[name] = len(self.elements) + 1 + np.arange(np.prod(counts)).reshape(counts)
        corners = CORNERS if cells[2] else CORNERS[:4]
        for (k, j, i), element in np.ndenumerate(self.blocks[name]):
            self.elements[int(element)] = tuple(int(grid[k + c, j + b, i + a]) for a, b, c in corners)

    def face(self, block: str, axis: int, side: int) -> tuple[list[int], str]:
        """Numbers of the elements at one side of a block, low (0) or high (1), and the name of their face there."""
        return sorted(np.take(self.blocks[block], -side, axis=2 - axis).ravel().tolist()), FACES[axis, side]

    def face_nodes(self, block: str, axis: int, side: int) -> list[int]:
        """Numbers of the nodes at one side of a block."""
        return sorted(np.take(self.grids[block], -side, axis=2 - axis).ravel().tolist())
