"""Jobs that show that a material runs in CalculiX: homogeneous ones, which the driver repeats, and inhomogeneous ones."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from plyflow.hosts.abaqus.deck import Boundary, Contact, Deck, Increments, Section, Step
from plyflow.hosts.abaqus.mesh import Mesh, Point

Array = NDArray[np.float64]
Motion = Callable[[float, Point], Point]
TIGHT = (1e-9, 1e-9)
PLATE_MODULUS = 1.0e3  # MPa
EVERYTHING = ("U, RF", "S, SDV")


@dataclass(frozen=True)
class Scenario:
    """A deck's geometry and loading for any material.

    Parameters
    ----------
    name : of the job.
    title : one line.
    make : deck from the material's card and name.
    """

    name: str
    title: str
    make: Callable[[str, str], Deck]


def uniaxial(strain: float = -0.05, duration: float = 20.0, increments: int = 20) -> Scenario:
    """One element, compacted along 3, fibre (1) held, free along 2."""

    def make(card: str, material: str) -> Deck:
        mesh = _cube(1)
        boundaries = [
            Boundary("NALL", 1, 1),
            Boundary("YLOW", 2, 2),
            Boundary("ZLOW", 3, 3),
        ]
        step = _fixed_step(duration, increments, [Boundary("ZHIGH", 3, 3, strain)])
        return _deck("uniaxial compaction of one element", mesh, card, material, [step], boundaries)

    return Scenario("uniaxial", "one element, compacted, free edge", make)


def locking(strain: float = -0.1, duration: float = 20.0, increments: int = 20) -> Scenario:
    """`uniaxial` across the lock; for scenes whose lock is a blend.

    An instant lock stops the widening from one increment to the next, and CalculiX extrapolates the last increment
    into the next one without a line search: from there its Newton method diverges.
    """
    made = uniaxial(strain, duration, increments)
    return replace(made, name="locking", title="one element, compacted across a blended lock")


def shear(angle: float = 0.1, duration: float = 20.0, increments: int = 20) -> Scenario:
    """One element sheared in the transverse plane (F23), its thickness free (S33 = 0), all else held."""

    def make(card: str, material: str) -> Deck:
        mesh = _cube(1)
        top = mesh.face_nodes("BODY", 2, 1)
        equations = [[(node, 3, 1.0), (top[0], 3, -1.0)] for node in top[1:]]
        boundaries = [Boundary("NALL", 1, 1), Boundary("ZLOW", 2, 3)]
        step = _fixed_step(duration, increments, [Boundary("ZHIGH", 2, 2, angle)])
        return _deck("simple shear of one element", mesh, card, material, [step], boundaries, equations=equations)

    return Scenario("shear", "one element, transverse shear, free thickness", make)


def rotation(stretch: float = 0.97, degrees: float = 90.0, duration: float = 20.0, increments: int = 20) -> Scenario:
    """One element compacted along 3, widened along 2, while it turns rigidly about 1."""
    motion = turned_compaction(stretch, degrees, duration)

    def make(card: str, material: str) -> Deck:
        mesh = _cube(1)
        times = np.linspace(0.0, duration, increments + 1)
        return _moved("rotation with stretch of one element", mesh, card, material, motion, times, sorted(mesh.nodes))

    return Scenario("rotation", f"one element, compacted while turning by {degrees:g} degrees", make)


def twist(degrees: float = 5.0, strain: float = -0.01, duration: float = 20.0, increments: int = 20) -> Scenario:
    """2 x 2 x 2 elements: top twisted about 3 and pressed down, sides free."""

    def motion(time: float, point: Point) -> Point:
        angle, x, y = math.radians(degrees) * time / duration, point[0] - 0.5, point[1] - 0.5
        cosine, sine = math.cos(angle), math.sin(angle)
        return (cosine * x - sine * y - x, sine * x + cosine * y - y, strain * time / duration)

    return _ends("twist", "2x2x2 elements, top twisted and pressed", motion, 2, duration, increments)


def bend(degrees: float = 3.0, duration: float = 20.0, increments: int = 20) -> Scenario:
    """2 x 2 x 2 elements bent across the fibre: the end at high 2 turned about 1, the low end held, sides free.

    Across, because fibres that are pressed along themselves in a resin without shear stiffness buckle.
    """

    def motion(time: float, point: Point) -> Point:
        angle, height = math.radians(degrees) * time / duration, point[2] - 0.5
        return (0.0, math.sin(angle) * height, math.cos(angle) * height - height)

    return _ends("bend", "2x2x2 elements, bent across the fibre", motion, 1, duration, increments)


def laminate(
    width: float = 15.0,
    thickness: float = 0.5,
    compaction: float = 0.04,
    friction: float = 0.05,
    cells: tuple[int, int, int] = (3, 3, 1),
    duration: float = 240.0,
) -> Scenario:
    """A quarter of two crossed blocks between plates with contact: fibre of A along 1, of B along 2.

    The plates close by `compaction` of the stack's thickness at constant speed.
    """

    def make(card: str, material: str) -> Deck:
        return laminate_deck("calculix", card, material, width, thickness, compaction, friction, cells, duration)

    return Scenario("laminate", "two crossed blocks between plates, contact and friction", make)


def laminate_deck(
    host: str,
    card: str,
    material: str,
    width: float,
    thickness: float,
    compaction: float,
    friction: float,
    cells: tuple[int, int, int],
    duration: float,
) -> Deck:
    """Deck of `laminate` for either host; lengths in mm, duration in s."""
    half, plate = width / 2, 0.65 * width
    mesh = Mesh()
    mesh.add_block("BOTTOM", (1, 1, 1), (plate, plate, thickness), (0.0, 0.0, -thickness))
    mesh.add_block("A", cells, (half, half, thickness))
    mesh.add_block("B", cells, (half, half, thickness), (0.0, 0.0, thickness))
    mesh.add_block("TOP", (1, 1, 1), (plate, plate, thickness), (0.0, 0.0, 2 * thickness))
    node_sets = {
        "XLOW": mesh.face_nodes("A", 0, 0) + mesh.face_nodes("B", 0, 0),
        "YLOW": mesh.face_nodes("A", 1, 0) + mesh.face_nodes("B", 1, 0),
        "AEDGE": mesh.face_nodes("A", 1, 1),
        "BEDGE": mesh.face_nodes("B", 0, 1),
        "NBOTTOM": mesh.nodes_where(lambda p: True, "BOTTOM"),
        "NTOP": mesh.nodes_where(lambda p: True, "TOP"),
    }
    surfaces = {
        "BOTTOMUP": ("BOTTOM", 2, 1),
        "ADOWN": ("A", 2, 0),
        "AUP": ("A", 2, 1),
        "BDOWN": ("B", 2, 0),
        "BUP": ("B", 2, 1),
        "TOPDOWN": ("TOP", 2, 0),
    }
    step = Step(
        "PRESS",
        Increments(1e-2, duration, 1e-6, duration / 24),
        boundaries=[Boundary("NTOP", 3, 3, -2 * thickness * compaction)],
        print_nodes=[("NTOP", "RF", True), ("AEDGE", "U", False), ("BEDGE", "U", False)],
        print_elements=[("A", "S, SDV"), ("B", "S, SDV")],
    )
    return Deck(
        "abaqus" if host == "abaqus" else "calculix",
        "two crossed blocks between plates, a quarter",
        mesh,
        {"BOTTOM": "C3D8", "A": "C3D8", "B": "C3D8", "TOP": "C3D8"},
        [card, f"*MATERIAL, NAME=PLATE\n*ELASTIC\n{PLATE_MODULUS}, 0.3\n"],
        [
            Section("A", material, "ALONG"),
            Section("B", material, "ACROSS"),
            Section("BOTTOM", "PLATE"),
            Section("TOP", "PLATE"),
        ],
        [step],
        node_sets=node_sets,
        surfaces=surfaces,
        orientations={"ALONG": (1.0, 0.0, 0.0, 0.0, 1.0, 0.0), "ACROSS": (0.0, 1.0, 0.0, -1.0, 0.0, 0.0)},
        contact=Contact((("ADOWN", "BOTTOMUP"), ("BDOWN", "AUP"), ("BUP", "TOPDOWN")), 100.0, friction),
        comments=[
            "Block A: fibre along 1, widens along 2. Block B: fibre along 2, widens along 1. Symmetry at XLOW and YLOW.",
            "The plates close at constant speed; contact and friction at all three interfaces.",
        ],
        boundaries=[
            Boundary("XLOW", 1, 1),
            Boundary("YLOW", 2, 2),
            Boundary("NBOTTOM", 1, 3),
            Boundary("NTOP", 1, 2),
        ],
    )


def turned_compaction(stretch: float, degrees: float, duration: float) -> Motion:
    """Displacement of `rotation`: F = Q(t) diag(1, 1/s(t), s(t)) with s linear in time, Q a rotation about 1."""

    def motion(time: float, point: Point) -> Point:
        moved = turned_gradient(stretch, degrees, time / duration) @ np.array(point) - np.array(point)
        return (float(moved[0]), float(moved[1]), float(moved[2]))

    return motion


def turned_gradient(stretch: float, degrees: float, part: float) -> Array:
    """Deformation gradient (3, 3) of `rotation` at a part (0 to 1) of its duration."""
    thickness, angle = 1.0 + (stretch - 1.0) * part, math.radians(degrees) * part
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])
    return np.asarray(turn @ np.diag([1.0, 1.0 / thickness, thickness]))


def _ends(name: str, title: str, motion: Motion, axis: int, duration: float, increments: int) -> Scenario:
    """A 2 x 2 x 2 cube with one end held and the other moved."""

    def make(card: str, material: str) -> Deck:
        mesh = _cube(2)
        held = mesh.face_nodes("BODY", axis, 0)
        boundaries = [Boundary(node, 1, 3) for node in held]
        times = np.linspace(0.0, duration, increments + 1)
        nodes = mesh.face_nodes("BODY", axis, 1)
        return _moved(title, mesh, card, material, motion, times, nodes, boundaries)

    return Scenario(name, title, make)


def _cube(cells: int) -> Mesh:
    mesh = Mesh()
    mesh.add_block("BODY", (cells, cells, cells), (1.0, 1.0, 1.0))
    return mesh


def _moved(
    title: str,
    mesh: Mesh,
    card: str,
    material: str,
    motion: Motion,
    times: Array,
    nodes: Sequence[int],
    boundaries: Sequence[Boundary] = (),
) -> Deck:
    """Every coordinate of some nodes follows a motion, exact at the ends of the increments."""
    amplitudes, moving = {}, []
    for node in nodes:
        paths = np.array([motion(time, mesh.nodes[node]) for time in times])
        for freedom in (1, 2, 3):
            amplitude = f"N{node}D{freedom}"
            amplitudes[amplitude] = [(float(t), float(u)) for t, u in zip(times, paths[:, freedom - 1], strict=True)]
            moving.append(Boundary(node, freedom, freedom, 1.0, amplitude))
    step = _fixed_step(float(times[-1]), len(times) - 1, moving)
    return _deck(title, mesh, card, material, [step], boundaries, amplitudes=amplitudes)


def _fixed_step(duration: float, increments: int, boundaries: Sequence[Boundary]) -> Step:
    size = duration / increments
    return Step(
        "LOAD",
        Increments(size, duration, size, size, direct=True),
        boundaries=boundaries,
        print_nodes=[("NALL", EVERYTHING[0], False)],
        print_elements=[("BODY", EVERYTHING[1])],
        field_controls=TIGHT,
    )


def _deck(
    title: str,
    mesh: Mesh,
    card: str,
    material: str,
    steps: Sequence[Step],
    boundaries: Sequence[Boundary],
    *,
    amplitudes: Mapping[str, Sequence[tuple[float, float]]] | None = None,
    equations: Sequence[Sequence[tuple[int, int, float]]] = (),
) -> Deck:
    names = ("X", "Y", "Z")
    node_sets = {
        f"{names[axis]}{'LOW' if side == 0 else 'HIGH'}": mesh.face_nodes("BODY", axis, side)
        for axis in range(3)
        for side in (0, 1)
    }
    return Deck(
        "calculix",
        title,
        mesh,
        {"BODY": "C3D8"},
        [card],
        [Section("BODY", material)],
        steps,
        node_sets=node_sets,
        amplitudes=amplitudes or {},
        equations=equations,
        boundaries=boundaries,
    )
