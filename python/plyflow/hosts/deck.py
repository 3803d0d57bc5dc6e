"""Input decks from templates: the keywords that Abaqus and CalculiX share, and the few that differ."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal

from jinja2 import Environment, PackageLoader, StrictUndefined

from plyflow.errors import InputError
from plyflow.hosts.mesh import Cells, Mesh

Host = Literal["abaqus", "calculix"]
LONGEST_NUMBER = 20
ENTRIES_PER_LINE, NUMBERS_PER_LINE = 12, 8
PLATE_MODULUS = 1.0e3  # MPa
CONTACT_STIFFNESS = 100.0  # MPa/mm


def render(template: str, **values: object) -> str:
    """Text of a template of the decks with the formats `number`, `numbers` and `entries`."""
    made = Environment(
        loader=PackageLoader("plyflow.hosts"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters |= {"number": number, "numbers": numbers, "entries": entries}
    return made.get_template(template).render(values)


def material_card(
    host: Host, name: str, values: Sequence[float], manifest: Mapping[str, Any], hybrid: str | None = None
) -> str:
    """*MATERIAL with its options; UNSYMM and names of state variables for Abaqus only.

    Parameters
    ----------
    values
        Of the constants, in the manifest's order.
    hybrid
        HYBRID FORMULATION of Abaqus, if the element wants one.
    """
    rows = {key: manifest[key] for key in ("props", "statev", "unsymmetric")}
    return render("material.inp.j2", host=host, name=name, values=values, hybrid=hybrid, **rows)


def orientation_lines(angles: Sequence[float], material: str) -> str:
    """*ORIENTATION of each fibre direction [degrees from axis 1, about 3] of a stack, and the section of each block.

    Raises
    ------
    InputError
        A direction is not finite.
    """
    for angle in angles:
        if not math.isfinite(angle):
            raise InputError(f"direction {angle} must be a finite number of degrees from axis 1")
    systems = {}
    for angle in dict.fromkeys(angles):
        cosine, sine = (round(part(math.radians(angle)), 15) + 0.0 for part in (math.cos, math.sin))
        systems[f"PLY_{angle:g}".replace("-", "M").replace(".", "P")] = (angle, (cosine, sine, 0.0, -sine + 0.0, cosine, 0.0))
    names = {angle: name for name, (angle, _) in systems.items()}
    blocks = [names[angle] for angle in angles]
    return render("orientations.inc.j2", host="abaqus", systems=systems, blocks=blocks, material=material)


def laminate_deck(
    host: Host,
    card: str,
    material: str,
    width: float = 15.0,
    thickness: float = 0.5,
    *,
    compaction: float = 0.04,
    friction: float = 0.05,
    cells: Cells = (6, 6, 2),
    duration: float = 240.0,
    **values: object,
) -> str:
    """A quarter of two crossed blocks between plates with contact: fibre of A along 1, of B along 2.

    The plates close by `compaction` of the stack's thickness at constant speed.

    Parameters
    ----------
    card, material
        The material's card and name.
    width, thickness, duration
        Of a whole block in mm, and of the closing in s.
    values
        What else the template takes.
    """
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
        "NBOTTOM": mesh.grids["BOTTOM"].ravel().tolist(),
        "NTOP": mesh.grids["TOP"].ravel().tolist(),
    }
    return render(
        "laminate.inp.j2",
        host=host,
        mesh=mesh,
        element="C3D8",
        node_sets=node_sets,
        card=card,
        material=material,
        plate_modulus=PLATE_MODULUS,
        contact_stiffness=CONTACT_STIFFNESS,
        friction=friction,
        closing=-2 * thickness * compaction,
        steps=[(1e-2, duration, 1e-6, duration / 24)],
        **values,
    )


def number(value: float) -> str:
    """Shortest text of a number that reads back as it; at most 20 characters, as both programs read.

    Raises
    ------
    InputError
        Not finite.
    """
    if not abs(value) < float("inf"):
        raise InputError(f"{value} cannot be written into a deck; it must be finite")
    text = repr(float(value))
    digits = 16
    while len(text) > LONGEST_NUMBER:
        text = f"{value:.{digits}g}"
        digits -= 1
    return text if any(mark in text for mark in ".en") else f"{text}."


def numbers(values: Sequence[float]) -> str:
    """Numbers, eight in a line."""
    return "\n".join(_lines([number(value) for value in values], NUMBERS_PER_LINE))


def entries(values: Sequence[int]) -> str:
    """Whole numbers in lines that end with a comma where another follows."""
    return ",\n".join(_lines([str(value) for value in values], ENTRIES_PER_LINE))


def _lines(texts: Sequence[str], per_line: int) -> list[str]:
    return [", ".join(texts[first : first + per_line]) for first in range(0, len(texts), per_line)]
