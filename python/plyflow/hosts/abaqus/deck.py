"""An input deck as data, and its text: the keywords that Abaqus and CalculiX share, and the few that differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from jinja2 import Environment, PackageLoader, StrictUndefined

from plyflow.errors import InputError
from plyflow.hosts.abaqus.mesh import Mesh

Host = Literal["abaqus", "calculix"]
LONGEST_NUMBER = 20
ENTRIES_PER_LINE = 12
CONSTANTS_PER_LINE = 8


@dataclass(frozen=True)
class Section:
    """Material and orientation of a block; hourglass stiffness in MPa where the element needs one."""

    block: str
    material: str
    orientation: str | None = None
    hourglass: float | None = None


@dataclass(frozen=True)
class Boundary:
    """Displacement of a node set or node: degrees of freedom first to last, value in mm, amplitude name."""

    place: str | int
    first: int
    last: int
    value: float = 0.0
    amplitude: str | None = None


@dataclass(frozen=True)
class Pressure:
    """Pressure in MPa on a face of all elements of a block, times an amplitude."""

    block: str
    face: str
    value: float
    amplitude: str | None = None


@dataclass(frozen=True)
class Contact:
    """Contact pairs (slave, master) with one law: penalty stiffness in MPa/mm, friction coefficient."""

    pairs: Sequence[tuple[str, str]]
    stiffness: float
    friction: float
    kind: str = "SURFACE TO SURFACE"


@dataclass(frozen=True)
class Increments:
    """Increments of a step in s; `direct`: all of the initial size; accuracy of creep strain for *VISCO."""

    initial: float
    total: float
    minimum: float
    maximum: float
    direct: bool = False
    strain_tolerance: float | None = None


@dataclass(frozen=True)
class Step:
    """One step: its name, increments, what is prescribed and what is printed.

    Attributes
    ----------
    name, increments, boundaries, pressures
        Name, increments, and what changes in the step.
    print_nodes, print_elements
        (set, variables, whether totals) and (set, variables) of the printed tables.
    field_controls
        Residual and correction relative to the average flux, its first value and its fixed value in N.
    unsymmetric, largest_number
        Whether the equations are unsymmetric; largest number of increments.
    """

    name: str
    increments: Increments
    boundaries: Sequence[Boundary] = ()
    pressures: Sequence[Pressure] = ()
    print_nodes: Sequence[tuple[str, str, bool]] = ()
    print_elements: Sequence[tuple[str, str]] = ()
    field_controls: tuple[float, ...] | None = None
    unsymmetric: bool = False
    largest_number: int = 10_000


@dataclass(frozen=True)
class Deck:
    """Everything of an input file.

    Attributes
    ----------
    host
        Whose deck it is.
    title, comments
        Heading and comment lines.
    mesh, element_types
        Mesh and the element type of each of its blocks.
    node_sets, surfaces
        Node numbers by set name; (block, axis, side) of the mesh by surface name.
    materials
        Text of each material card.
    sections, orientations
        Sections; by name the six coordinates of *ORIENTATION: points on local axis 1 and in the plane 1-2.
    amplitudes
        By name the pairs (time in s, value).
    equations
        Each a list of (node, degree of freedom, coefficient) whose sum is zero.
    contact, temperature, boundaries, steps
        Contact, temperature in degC where the material asks for it, boundaries of the whole analysis, steps.
    """

    host: Host
    title: str
    mesh: Mesh
    element_types: Mapping[str, str]
    materials: Sequence[str]
    sections: Sequence[Section]
    steps: Sequence[Step]
    comments: Sequence[str] = ()
    node_sets: Mapping[str, Sequence[int]] = field(default_factory=dict)
    surfaces: Mapping[str, tuple[str, int, int]] = field(default_factory=dict)
    orientations: Mapping[str, Sequence[float]] = field(default_factory=dict)
    amplitudes: Mapping[str, Sequence[tuple[float, float]]] = field(default_factory=dict)
    equations: Sequence[Sequence[tuple[int, int, float]]] = ()
    contact: Contact | None = None
    temperature: float | None = None
    boundaries: Sequence[Boundary] = ()

    def text(self) -> str:
        """Text of the input file."""
        return environment().get_template("deck.inp.j2").render(deck=self, **vars(self))


@dataclass(frozen=True)
class MaterialCard:
    """A user material: name, constants and state variables as the manifest lists them, and their values."""

    name: str
    values: Sequence[float]
    props: Sequence[Mapping[str, object]]
    statev: Sequence[Mapping[str, object]]
    unsymmetric: bool
    comments: Sequence[str] = ()
    hybrid: str | None = None

    def text(self, host: Host) -> str:
        """Text of *MATERIAL with its options; UNSYMM and names of state variables for Abaqus only.

        Raises
        ------
        InputError
            The number of values is not that of the constants.
        """
        if len(self.values) != len(self.props):
            raise InputError(f"{self.name}: {len(self.values)} values for {len(self.props)} constants")
        return environment().get_template("material.inp.j2").render(host=host, card=self, **vars(self))


def environment() -> Environment:
    """Templates of the decks, with the formats of numbers and lists."""
    made = Environment(
        loader=PackageLoader("plyflow.hosts.abaqus", "templates"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.filters |= {"number": number, "numbers": numbers, "entries": entries}
    return made


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


def numbers(values: Sequence[float], per_line: int = CONSTANTS_PER_LINE) -> str:
    """Numbers in lines of at most `per_line`."""
    return "\n".join(
        ", ".join(number(value) for value in values[first : first + per_line])
        for first in range(0, len(values), per_line)
    )


def entries(values: Sequence[int], per_line: int = ENTRIES_PER_LINE) -> str:
    """Whole numbers in lines that end with a comma where another follows."""
    lines = [
        ", ".join(str(value) for value in values[first : first + per_line]) for first in range(0, len(values), per_line)
    ]
    return ",\n".join(lines)
