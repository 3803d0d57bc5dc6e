"""Jobs on a cube that show that a material runs in CalculiX: homogeneous ones, which the driver repeats, and others."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plyflow.hosts.deck import render
from plyflow.hosts.mesh import Mesh, Point

Array = NDArray[np.float64]
DURATION = 20.0  # s
TIGHT = (1e-9, 1e-9)


@dataclass(frozen=True)
class CubeJob:
    """A cube of 1 mm, fibre along 1, deformed within `DURATION` in increments of one size.

    Parameters
    ----------
    name, title
        Of the job's files; heading of its deck.
    cells
        Elements along each edge.
    held
        (set, first, last degree of freedom) that stay where they are.
    driven
        (set, degree of freedom, displacement in mm) that is reached at constant speed.
    level
        Whether the nodes at high 3 keep one height.
    motion
        Displacement in mm over time and place: of all nodes, or of the end at high `axis` while the low one is held.
    gradient, free
        Deformation gradient (3, 3) over time where it is the same in all points, and the components that the driver
        finds from their zero stress.
    """

    name: str
    title: str
    cells: int = 1
    held: Sequence[tuple[str | int, int, int]] = ()
    driven: tuple[str, int, float] | None = None
    level: bool = False
    motion: Callable[[float, Point], Sequence[float] | Array] | None = None
    axis: int | None = None
    gradient: Callable[[float], Array] | None = None
    free: Sequence[str] = ()
    increments: int = 20

    @property
    def mesh(self) -> Mesh:
        """The cube, a block BODY."""
        made = Mesh()
        made.add_block("BODY", (self.cells,) * 3, (1.0, 1.0, 1.0))
        return made

    def deck(self, card: str, material: str) -> str:
        """Input file with a material's card and name."""
        mesh, size = self.mesh, DURATION / self.increments
        sides = {f"{'XYZ'[axis]}{end}": (axis, side) for axis in range(3) for side, end in enumerate(("LOW", "HIGH"))}
        node_sets = {name: mesh.face_nodes("BODY", *place) for name, place in sides.items()}
        ends = [] if self.axis is None else mesh.face_nodes("BODY", self.axis, 0)
        return render(
            "cube.inp.j2",
            host="calculix",
            title=self.title,
            mesh=mesh,
            element="C3D8",
            node_sets=node_sets,
            card=card,
            material=material,
            held=[*self.held, *((node, 1, 3) for node in ends)],
            driven=self.driven,
            tied=node_sets["ZHIGH"] if self.level else [],
            paths=self._paths(mesh),
            steps=[(size, DURATION)],
            controls=TIGHT,
        )

    def _paths(self, mesh: Mesh) -> list[dict[str, object]]:
        """Amplitudes of all coordinates that follow the motion, exact at the ends of the increments."""
        if self.motion is None:
            return []
        times = np.linspace(0.0, DURATION, self.increments + 1)
        found: list[dict[str, object]] = []
        for node in sorted(mesh.nodes) if self.axis is None else mesh.face_nodes("BODY", self.axis, 1):
            moved = np.array([self.motion(time, mesh.nodes[node]) for time in times])
            for freedom in (1, 2, 3):
                points = list(zip(times, moved[:, freedom - 1], strict=True))
                found.append({"name": f"N{node}D{freedom}", "node": node, "freedom": freedom, "points": points})
        return found


def uniaxial(strain: float = -0.05, increments: int = 20) -> CubeJob:
    """One element, compacted along 3, fibre (1) held, free along 2."""
    return CubeJob(
        "uniaxial",
        "uniaxial compaction of one element",
        held=[("NALL", 1, 1), ("YLOW", 2, 2), ("ZLOW", 3, 3)],
        driven=("ZHIGH", 3, strain),
        gradient=lambda time: np.diag([1.0, 1.0, 1.0 + strain * time / DURATION]),
        free=["22"],
        increments=increments,
    )


def turned_gradient(time: float) -> Array:
    """F = Q(t) diag(1, 1/s(t), s(t)) with s linear in time down to 0.97, Q a rotation about 1 by up to 90 degrees."""
    part = time / DURATION
    thickness, angle = 1.0 + (0.97 - 1.0) * part, math.radians(90.0) * part
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])
    return np.asarray(turn @ np.diag([1.0, 1.0 / thickness, thickness]))


def _turned(time: float, point: Point) -> Array:
    return np.asarray(turned_gradient(time) @ np.array(point) - np.array(point))


def _twisted(time: float, point: Point) -> Point:
    angle, x, y = math.radians(5.0) * time / DURATION, point[0] - 0.5, point[1] - 0.5
    cosine, sine = math.cos(angle), math.sin(angle)
    return (cosine * x - sine * y - x, sine * x + cosine * y - y, -0.01 * time / DURATION)


def _bent(time: float, point: Point) -> Point:
    angle, height = math.radians(3.0) * time / DURATION, point[2] - 0.5
    return (0.0, math.sin(angle) * height, math.cos(angle) * height - height)


SHEAR = CubeJob(
    "shear",
    "simple shear of one element",  # transverse (F23), thickness free
    held=[("NALL", 1, 1), ("ZLOW", 2, 3)],
    driven=("ZHIGH", 2, 0.1),
    level=True,
    gradient=lambda time: np.eye(3) + 0.1 * time / DURATION * np.outer([0, 1, 0], [0, 0, 1]),
    free=["33"],
)
ROTATION = CubeJob("rotation", "rotation with stretch of one element", motion=_turned, gradient=turned_gradient)
HOMOGENEOUS = (uniaxial(), SHEAR, ROTATION)
# Bent across the fibre: fibres that are pressed along themselves in a resin without shear stiffness buckle.
INHOMOGENEOUS = (
    CubeJob("twist", "2x2x2 elements, top twisted and pressed", 2, motion=_twisted, axis=2),
    CubeJob("bend", "2x2x2 elements, bent across the fibre", 2, motion=_bent, axis=1),
)
