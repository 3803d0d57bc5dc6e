"""Ready single-element jobs: a block or its cross section under the plate's pressure, its edge free."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from plyflow.hosts.deck import Host, material_card, render
from plyflow.hosts.mesh import Mesh
from plyflow.law import LoadProgramme

SOLID, PLANE = ("C3D8", "C3D8R", "C3D8H"), ("CPE4", "CAX4")
FIRST_INCREMENT, SMALLEST_INCREMENT, LARGEST_INCREMENT = 1e-2, 1e-9, 20.0  # s
FAR_FROM_AXIS = 100.0
HOURGLASS_STRAIN = 1e-2
HOURGLASS_PART = 5e-3
FIELD_RESIDUAL, FIELD_CORRECTION = 1e-3, 1e-2
MATERIAL = "PLY"


def element_deck(
    element: str,
    size: tuple[float, float],
    load: LoadProgramme,
    constants: Sequence[float],
    manifest: Mapping[str, Any],
    host: Host = "abaqus",
    material: str = MATERIAL,
    **values: object,
) -> str:
    """Deck of one element under the plate.

    Parameters
    ----------
    element
        C3D8, C3D8R, C3D8H (fibre along 1, edge along 2, plate along 3) or CPE4, CAX4 (edge along 1, plate along
        2, fibre along 3: out of the plane, or the hoop).
    size, load
        Width and thickness of the ply block in mm; its load.
    constants, manifest
        Values of the scene's constants in its order, and its manifest.
    host, material
        Whose deck, and the material's name.
    values
        What else the template takes: job and source for its comment, temperature in degC.
    """
    width, thickness = size
    solid, mesh = element in SOLID, Mesh()
    if solid:
        mesh.add_block("PLY1", (1, 1, 1), (width, width, thickness))
    else:
        left = FAR_FROM_AXIS * width if element == "CAX4" else 0.0
        mesh.add_block("PLY1", (1, 1, 0), (width, thickness, 0.0), (left, 0.0, 0.0))
    across, along = (1, 2) if solid else (0, 1)
    node_sets = {
        "EDGELOW": mesh.face_nodes("PLY1", across, 0),
        "PLATELOW": mesh.face_nodes("PLY1", along, 0),
        "PLATEHIGH": mesh.face_nodes("PLY1", along, 1),
    }
    # Force of the plate on one node in N at the largest pressure: what residuals are compared with.
    node_load = load.peak * width * (width / 4 if solid else 0.5)
    return render(
        "element.inp.j2",
        host=host,
        element=element,
        mesh=mesh,
        node_sets=node_sets,
        card=material_card(host, material, constants, manifest, "INCREMENTAL" if element.endswith("H") else None),
        material=material,
        fibre=_fibre(solid, host),
        hourglass=HOURGLASS_PART * load.peak / HOURGLASS_STRAIN,
        amplitude=list(zip(load.times, load.pressures, strict=True)),
        steps=_steps(load),
        controls=(FIELD_RESIDUAL, FIELD_CORRECTION, node_load, node_load),
        unsymmetric=manifest["unsymmetric"],
        **values,
    )


def _steps(load: LoadProgramme) -> list[tuple[float, ...]]:
    """One step for each straight piece of the load, so that increments end at its corners."""
    durations = [end - begin for begin, end, _, _ in load.pieces()]
    return [(min(FIRST_INCREMENT, d), d, SMALLEST_INCREMENT, min(LARGEST_INCREMENT, d)) for d in durations]


def _fibre(solid: bool, host: Host) -> Sequence[float] | None:
    """Local system, if one is due: CalculiX's plane elements are slices of solid ones, for the scene with fibre 1."""
    if solid:
        return (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)
    return (0.0, 0.0, 1.0, 1.0, 0.0, 0.0) if host == "calculix" else None
