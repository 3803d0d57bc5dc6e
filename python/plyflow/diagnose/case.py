"""Case files of the driver as text: what is to be changed to run another UMAT, or one increment alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from plyflow.errors import InputError

Array = NDArray[np.float64]
_OUTPUTS = ("library", "symbol", "history", "increments", "replay")
_ROWS = ("11", "12", "13", "21", "22", "23", "31", "32", "33")
PROGRAMMES = {
    "uniaxial": ({"F11": 1.3, "S22": 0.0, "S33": 0.0},),
    "shear": ({"F12": 0.4, "F13": 0.2, "F23": 0.3},),
    "volumetric": ({"F11": 1.1, "F22": 1.1, "F33": 1.1},),
    "general": ({"F11": 1.2, "F22": 0.9, "F33": 1.1, "F12": 0.3, "F13": -0.1, "F23": 0.2, "F21": 0.15, "F31": 0.1},),
    "rotation": (
        {"F11": 1.2, "F22": 0.9, "F33": 0.95},
        {"F11": 0.0, "F21": 1.2, "F12": -0.9, "F22": 0.0},
    ),
}
INCREMENTS = 10


@dataclass(frozen=True)
class Case:
    """A case: lines outside all blocks (without library and outputs), and its blocks by order with their names.

    `name` is that of its file or programme; `numbers` has, of the file, the line of each line of `text`, 0 for those
    that are not in it.
    """

    settings: Sequence[str]
    blocks: Sequence[tuple[str, Sequence[str]]]
    name: str = "case"
    numbers: Sequence[int] = ()

    def text(self, library: Path) -> str:
        """The whole programme for a UMAT library."""
        parts = [f"library = {library}", *self.settings, *_quiet()]
        for name, lines in self.blocks:
            parts += [f"begin {name}", *lines, f"end {name}"]
        return "\n".join(parts) + "\n"

    @property
    def from_file(self) -> bool:
        """Whether it was read from a file, in contrast to the built-in programmes."""
        return bool(self.numbers)

    def place(self, number: int) -> str:
        """Where a line of `text`, counted from 1, stands in the user's file."""
        line = self.numbers[number - 1] if 0 < number <= len(self.numbers) else 0
        return f"{self.name}:{line}" if line else self.name

    def increment_text(self, library: Path, start: IncrementStart, end: Array) -> str:
        """One increment alone, all of F prescribed, with the tangent compared with differences.

        Parameters
        ----------
        start
            State at its start.
        end
            (3, 3) deformation gradient at its end.
        """
        controls = [
            f"initial_increment = {start.size!r}",
            f"minimum_increment = {start.size!r}",
            f"maximum_increment = {start.size!r}",
            "tangent_check = 1",
            "max_attempts = 1",
        ]
        step = [f"duration = {start.size!r}"]
        step += [f"F{name} = {value!r}" for name, value in zip(_ROWS, map(float, end.ravel()), strict=True)]
        parts = [f"library = {library}", *self.settings, *_quiet()]
        blocks = (("start", start.lines()), ("controls", controls), ("step", step))
        for name, lines in blocks:
            parts += [f"begin {name}", *lines, f"end {name}"]
        return "\n".join(parts) + "\n"


@dataclass(frozen=True)
class IncrementStart:
    """State at the start of an increment: F (3, 3), stress and strain (6,), energies (3,), statev; times in s."""

    deformation_gradient: Array
    stress: Array
    strain: Array
    energies: Array
    statev: Array
    step_time: float
    total_time: float
    step: int
    increment: int
    size: float

    def lines(self) -> list[str]:
        """Lines of the block `start`."""
        arrays = {
            "deformation_gradient": self.deformation_gradient.ravel(),
            "stress": self.stress,
            "strain": self.strain,
            "energies": self.energies,
        }
        result = [f"{name} = {_list(values)}" for name, values in arrays.items()]
        result += [f"statev = {_list(self.statev[i : i + 4])}" for i in range(0, len(self.statev), 4)]
        result += [f"step_time = {self.step_time!r}", f"total_time = {self.total_time!r}"]
        return [*result, f"step = {self.step}", f"increment = {self.increment}"]


def props_lines(props: Sequence[float]) -> list[str]:
    """Lines of a case that give constants, four in each."""
    return [f"props = {_list(np.array(props[i : i + 4]))}" for i in range(0, len(props), 4)]


def _list(values: Array) -> str:
    return " ".join(repr(float(value)) for value in values)


def _quiet() -> list[str]:
    return [f"{name} = none" for name in ("history", "increments", "replay")]


def read_case(path: Path) -> Case:
    """Case from a file of the driver; its own library is left out.

    Raises
    ------
    InputError
        The file cannot be read or a block does not end.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"case {path} cannot be read: {error}") from error
    settings: list[str] = []
    blocks: list[tuple[str, list[str]]] = []
    inside: str | None = None
    of_settings: list[int] = []
    of_blocks: list[int] = []
    for number, line in enumerate(lines, 1):
        words = line.partition("!")[0].replace("=", " = ").split()
        if not words:
            continue
        if words[0] in ("begin", "end"):
            wanted = "end" if inside else "begin"
            if words[0] != wanted or len(words) != 2 or (inside and words[1] != inside):
                raise InputError(
                    f"case {path}, line {number}: '{line.strip()}' where '{wanted} {inside or 'NAME'}' is due"
                )
            inside = None if inside else words[1]
            of_blocks.append(number)
            if inside:
                blocks.append((inside, []))
        elif inside:
            blocks[-1][1].append(" ".join(words))
            of_blocks.append(number)
        elif words[0] not in _OUTPUTS:
            settings.append(" ".join(words))
            of_settings.append(number)
    if inside:
        raise InputError(f"case {path}: the block '{inside}' does not end; write 'end {inside}'")
    return Case(settings, blocks, str(path), [0, *of_settings, *(0 for _ in _quiet()), *of_blocks])


def programme(name: str, props: Sequence[float], n_statev: int, temperature: float = 0.0) -> Case:
    """One of the built-in programmes, each step of 1 s in ten increments.

    Raises
    ------
    InputError
        Unknown name.
    """
    if name not in PROGRAMMES:
        raise InputError(f"case '{name}' is neither a file nor one of {', '.join(PROGRAMMES)}")
    settings = props_lines(props)
    settings += [f"n_statev = {n_statev}", f"temperature = {temperature!r}"]
    size = 1.0 / INCREMENTS
    controls = [f"{which}_increment = {size}" for which in ("initial", "maximum")]
    steps = [
        ("step", ["duration = 1.0", *(f"{key} = {value}" for key, value in targets.items())])
        for targets in PROGRAMMES[name]
    ]
    return Case(settings, [("controls", controls), *steps], f"programme {name}")
