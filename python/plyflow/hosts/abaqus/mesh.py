"""Regular meshes of hexahedra, in the numbering that Abaqus and CalculiX share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from plyflow.errors import InputError

Point = tuple[float, float, float]
Cells = tuple[int, int, int]

# Corners of a cell in the order of C3D8, then mid-edges in the order of C3D20, in half cells.
_CORNERS = ((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2))
_MIDDLES = (
    (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
    (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1),
)  # fmt: skip
# Outward face by axis and side: the face numbers of C3D8 and C3D20.
FACES = {(2, 0): "S1", (2, 1): "S2", (1, 0): "S3", (0, 1): "S4", (1, 1): "S5", (0, 0): "S6"}


@dataclass
class Mesh:
    """Nodes and hexahedra of one or more blocks.

    Attributes
    ----------
    nodes
        Coordinates in mm by node number, from 1.
    elements
        Node numbers by element number, from 1.
    blocks
        Element numbers of each block by name.
    faces
        For (block, axis, side) the element numbers and the face name, axis 0 to 2, side 0 (low) or 1 (high).
    """

    nodes: dict[int, Point] = field(default_factory=dict)
    elements: dict[int, tuple[int, ...]] = field(default_factory=dict)
    blocks: dict[str, list[int]] = field(default_factory=dict)
    faces: dict[tuple[str, int, int], tuple[list[int], str]] = field(default_factory=dict)

    def add_block(
        self, name: str, cells: Cells, size: Point, origin: Point = (0.0, 0.0, 0.0), quadratic: bool = False
    ) -> None:
        """Add a box of equal cells with nodes of its own.

        Parameters
        ----------
        name
            Of the block, for `blocks` and `faces`.
        cells
            Number of elements along each axis.
        size, origin
            In mm.
        quadratic
            20 nodes an element in place of 8.

        Raises
        ------
        InputError
            The name is taken, or a number of cells or a size is not positive.
        """
        if name in self.blocks:
            raise InputError(f"the mesh has a block '{name}' already; give each block its own name")
        if min(cells) < 1 or min(size) <= 0.0:
            raise InputError(f"block '{name}': cells {cells} and size {size} mm must all be positive")
        places = _places(cells, quadratic)
        first = len(self.nodes) + 1
        numbers = {place: first + i for i, place in enumerate(places)}
        for place, number in numbers.items():
            x, y, z = (o + s * p / (2 * n) for o, s, p, n in zip(origin, size, place, cells, strict=True))
            self.nodes[number] = (x, y, z)
        self._add_elements(name, cells, numbers, quadratic)

    def add_quadrilateral(self, name: str, size: tuple[float, float], origin: tuple[float, float] = (0.0, 0.0)) -> None:
        """Add one plane or axisymmetric element with four nodes; lengths in mm.

        Raises
        ------
        InputError
            The name is taken, or a size is not positive.
        """
        if name in self.blocks:
            raise InputError(f"the mesh has a block '{name}' already; give each block its own name")
        if min(size) <= 0.0:
            raise InputError(f"block '{name}': size {size} mm must be positive")
        first, element = len(self.nodes) + 1, len(self.elements) + 1
        for number, (i, j) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1)), first):
            self.nodes[number] = (origin[0] + i * size[0], origin[1] + j * size[1], 0.0)
        self.elements[element] = tuple(range(first, first + 4))
        self.blocks[name] = [element]

    def _add_elements(self, name: str, cells: Cells, numbers: dict[Cells, int], quadratic: bool) -> None:
        pattern = _CORNERS + _MIDDLES if quadratic else _CORNERS
        self.blocks[name] = []
        for k in range(cells[2]):
            for j in range(cells[1]):
                for i in range(cells[0]):
                    element = len(self.elements) + 1
                    self.elements[element] = tuple(numbers[2 * i + a, 2 * j + b, 2 * k + c] for a, b, c in pattern)
                    self.blocks[name].append(element)
                    for axis, (place, count) in enumerate(zip((i, j, k), cells, strict=True)):
                        if place == 0:
                            self._on_face(name, axis, 0, element)
                        if place == count - 1:
                            self._on_face(name, axis, 1, element)

    def _on_face(self, name: str, axis: int, side: int, element: int) -> None:
        self.faces.setdefault((name, axis, side), ([], FACES[axis, side]))[0].append(element)

    def nodes_where(self, condition: Callable[[Point], bool], block: str | None = None) -> list[int]:
        """Numbers of the nodes, of a block if given, whose coordinates meet a condition."""
        chosen = sorted(self.nodes)
        if block is not None:
            chosen = sorted({n for e in self.blocks[block] for n in self.elements[e]})
        return [number for number in chosen if condition(self.nodes[number])]

    def face_nodes(self, block: str, axis: int, side: int) -> list[int]:
        """Numbers of the nodes on one side of a block."""
        own = [self.nodes[n][axis] for e in self.blocks[block] for n in self.elements[e]]
        level = min(own) if side == 0 else max(own)
        tolerance = 1e-9 * (max(own) - min(own))
        return self.nodes_where(lambda p: abs(p[axis] - level) <= tolerance, block)


def _places(cells: Cells, quadratic: bool) -> list[Cells]:
    """Node places in half cells, in the order of numbering: x fastest."""
    return [
        (i, j, k)
        for k in range(2 * cells[2] + 1)
        for j in range(2 * cells[1] + 1)
        for i in range(2 * cells[0] + 1)
        if i % 2 + j % 2 + k % 2 <= (1 if quadratic else 0)
    ]
