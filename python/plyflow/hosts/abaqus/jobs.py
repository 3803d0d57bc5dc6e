"""Ready single-element jobs: a block or its cross section under the plate's pressure, its edge free."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from plyflow.hosts.abaqus.deck import (
    Boundary,
    Deck,
    Host,
    Increments,
    MaterialCard,
    Pressure,
    Section,
    Step,
)
from plyflow.hosts.abaqus.mesh import Mesh
from plyflow.law import LoadProgramme

SOLID, PLANE = ("C3D8", "C3D8R", "C3D8H"), ("CPE4", "CAX4")
FIRST_INCREMENT, SMALLEST_INCREMENT, LARGEST_INCREMENT = 1e-2, 1e-9, 20.0  # s
FAR_FROM_AXIS = 100.0
HOURGLASS_STRAIN = 1e-2
HOURGLASS_PART = 5e-3
FIELD_RESIDUAL, FIELD_CORRECTION = 1e-3, 1e-2
MATERIAL = "PLY"


@dataclass(frozen=True)
class Block:
    """A ply block: width and thickness in mm, load, and the values of the scene's constants by name."""

    width: float
    thickness: float
    load: LoadProgramme
    values: Mapping[str, float]

    @property
    def largest_pressure(self) -> float:
        """MPa."""
        return self.load.peak


def element_deck(element: str, block: Block, manifest: Mapping[str, object], host: Host, name: str = MATERIAL) -> Deck:
    """Deck of one element under the plate.

    Parameters
    ----------
    element
        C3D8, C3D8R, C3D8H (fibre along 1, edge along 2, plate along 3) or CPE4, CAX4 (edge along 1, plate along
        2, fibre along 3: out of the plane, or the hoop).
    block, manifest
        The block, and the manifest of the scene.
    host, name
        Whose deck, and the material's name.
    """
    solid = element in SOLID
    mesh = Mesh()
    if solid:
        mesh.add_block("PLY1", (1, 1, 1), (block.width, block.width, block.thickness))
    else:
        left = FAR_FROM_AXIS * block.width if element == "CAX4" else 0.0
        mesh.add_quadrilateral("PLY1", (block.width, block.thickness), (left, 0.0))
    card = material_card(block.values, manifest, name, "INCREMENTAL" if element.endswith("H") else None)
    fibre = _fibre(solid, host)
    section = Section("PLY1", name, "FIBRE" if fibre else None, _hourglass(element, block))
    return Deck(
        host,
        f"{element}: one ply block under the plate, edge free",
        mesh,
        {"PLY1": element},
        [card.text(host)],
        [section],
        _steps(block, "P2" if solid else "P3", _node_load(block, solid), card.unsymmetric),
        node_sets=_node_sets(mesh, solid),
        orientations={"FIBRE": fibre} if fibre else {},
        amplitudes={"PLATE": list(zip(block.load.times, block.load.pressures, strict=True))},
        boundaries=_boundaries(solid),
        comments=_comments(element),
    )


def material_card(
    values: Mapping[str, float], manifest: Mapping[str, object], name: str, hybrid: str | None = None
) -> MaterialCard:
    """Material card of a scene with the values of its constants by name."""
    props, statev = manifest["props"], manifest["statev"]
    assert isinstance(props, list)
    assert isinstance(statev, list)
    return MaterialCard(
        name,
        [values[str(row["name"])] for row in props],
        props,
        statev,
        bool(manifest["unsymmetric"]),
        ["Units: N, mm, s, MPa."],
        hybrid,
    )


def _node_sets(mesh: Mesh, solid: bool) -> dict[str, Sequence[int]]:
    across, along = (1, 2) if solid else (0, 1)
    low = [min(point[axis] for point in mesh.nodes.values()) for axis in range(3)]
    return {
        "EDGELOW": mesh.nodes_where(lambda point: point[across] == low[across]),
        "PLATELOW": mesh.nodes_where(lambda point: point[along] == low[along]),
        "PLATEHIGH": mesh.nodes_where(lambda point: point[along] > low[along]),
    }


def _boundaries(solid: bool) -> list[Boundary]:
    if solid:
        return [Boundary("NALL", 1, 1), Boundary("EDGELOW", 2, 2), Boundary("PLATELOW", 3, 3)]
    return [Boundary("EDGELOW", 1, 1), Boundary("PLATELOW", 2, 2)]


def _steps(block: Block, face: str, node_load: float, unsymmetric: bool) -> list[Step]:
    """One step for each straight piece of the load, so that increments end at its corners."""
    pieces = list(block.load.pieces())
    return [
        Step(
            f"LOAD{number}",
            Increments(
                min(FIRST_INCREMENT, end - begin),
                end - begin,
                SMALLEST_INCREMENT,
                min(LARGEST_INCREMENT, end - begin),
            ),
            pressures=[Pressure("PLY1", face, 1.0, "PLATE")] if number == 1 else (),
            print_nodes=[("PLATEHIGH", "U, RF", False)],
            print_elements=[("PLY1", "S, SDV")],
            field_controls=(FIELD_RESIDUAL, FIELD_CORRECTION, node_load, node_load),
            unsymmetric=unsymmetric,
        )
        for number, (begin, end, _, _) in enumerate(pieces, 1)
    ]


def _fibre(solid: bool, host: Host) -> Sequence[float] | None:
    """Local system, if one is due: CalculiX's plane elements are slices of solid ones, for the scene with fibre 1."""
    if solid:
        return (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    return (0.0, 0.0, 1.0, 1.0, 0.0, 0.0) if host == "calculix" else None


def _node_load(block: Block, solid: bool) -> float:
    """Force of the plate on one node in N at the largest pressure: what residuals are compared with."""
    return block.largest_pressure * block.width * (block.width / 4 if solid else 0.5)


def _hourglass(element: str, block: Block) -> float | None:
    if not element.endswith("R"):
        return None
    return HOURGLASS_PART * block.largest_pressure / HOURGLASS_STRAIN


def _comments(element: str) -> list[str]:
    if element in SOLID:
        frame = ["Fibre along 1 (held), free edge along 2, plate along 3."]
    else:
        frame = [
            "Free edge along 1, plate along 2, fibre along 3.",
            "For the scene with fibre 3 and stress state plane.",
        ]
    if element == "C3D8R":
        frame.append(
            "Hourglass stiffness: 0.005 of (largest pressure / 0.01), a shear stiffness of this material's order."
        )
    if element == "CAX4":
        frame.append("A ring far from the axis, with the fibre around it: nearly plane strain.")
    return [
        *frame,
        "The pressure acts on the deformed area, so that it is minus the Cauchy stress along the plate's axis.",
        "Residuals are compared with the plate's force on a node at the largest pressure, not with the present one:",
        "at small loads the material is nearly rigid and no residual relative to them can be met.",
        "EXTRAPOLATION=NO: the first iteration takes the tangent of the last converged rate and lands near the solution.",
    ]
