"""Case files of the driver as text: what is to be changed to run another UMAT, or one increment alone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from plyflow.driver.history import FailedIncrement
from plyflow.errors import InputError

_OUTPUTS = ("library", "symbol", "history", "increments", "replay")
_QUIET = ("history = none", "increments = none", "replay = none")
_ROWS = ("11", "12", "13", "21", "22", "23", "31", "32", "33")
PROGRAMMES: Mapping[str, Sequence[Mapping[str, float]]] = {
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
Blocks = Sequence[tuple[str, Sequence[str]]]


@dataclass(frozen=True)
class Case:
    """A case: lines outside all blocks (without library and outputs), and its blocks by order with their names.

    `name` is that of its file or programme; `numbers` has, of the file, the line of each line of `text`, 0 for those
    that are not in it.
    """

    settings: Sequence[str]
    blocks: Blocks
    name: str = "case"
    numbers: Sequence[int] = ()

    def text(self, library: Path, blocks: Blocks | None = None) -> str:
        """The programme for a UMAT library, whole or with other blocks."""
        parts = [f"library = {library}", *self.settings, *_QUIET]
        for name, lines in self.blocks if blocks is None else blocks:
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

    def increment_text(self, library: Path, single: FailedIncrement) -> str:
        """One increment alone, all of F prescribed, with the tangent compared with differences."""
        size = single.increment_size
        start = {
            "deformation_gradient": single.deformation_gradient_start,
            "stress": single.stress,
            "strain": single.strain,
            "energies": single.energies,
        }
        begin = [f"{name} = {_list(values)}" for name, values in start.items()]
        begin += _in_fours("statev", single.statev)
        begin += [f"{name} = {getattr(single, name)!r}" for name in ("step_time", "total_time", "step", "increment")]
        controls = [f"{which}_increment = {size!r}" for which in ("initial", "minimum", "maximum")]
        controls += ["tangent_check = 1", "max_attempts = 1"]
        ends = zip(_ROWS, map(float, single.deformation_gradient_end.ravel()), strict=True)
        step = [f"duration = {size!r}", *(f"F{name} = {value!r}" for name, value in ends)]
        return self.text(library, (("start", begin), ("controls", controls), ("step", step)))


def props_lines(props: Sequence[float]) -> list[str]:
    """Lines of a case that give constants, four in each."""
    return _in_fours("props", props)


def _in_fours(name: str, values: ArrayLike) -> list[str]:
    flat = np.ravel(values)
    return [f"{name} = {_list(flat[i : i + 4])}" for i in range(0, len(flat), 4)]


def _list(values: ArrayLike) -> str:
    return " ".join(repr(float(value)) for value in np.ravel(values))


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
    for number, words in _statements(lines):
        if words[0] in ("begin", "end"):
            wanted = "end" if inside else "begin"
            if words[0] != wanted or len(words) != 2 or (inside and words[1] != inside):
                said, due = lines[number - 1].strip(), f"{wanted} {inside or 'NAME'}"
                raise InputError(f"case {path}, line {number}: '{said}' where '{due}' is due")
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
    return Case(settings, blocks, str(path), [0, *of_settings, *(0 for _ in _QUIET), *of_blocks])


def _statements(lines: Sequence[str]) -> Iterable[tuple[int, list[str]]]:
    """Number, from 1, and words of the lines that say something."""
    split = ((number, line.partition("!")[0].replace("=", " = ").split()) for number, line in enumerate(lines, 1))
    return ((number, words) for number, words in split if words)


def programme(name: str, props: Sequence[float], n_statev: int, temperature: float = 0.0) -> Case:
    """One of the built-in programmes, each step of 1 s in ten increments.

    Raises
    ------
    InputError
        Unknown name.
    """
    if name not in PROGRAMMES:
        raise InputError(f"case '{name}' is neither a file nor one of {', '.join(PROGRAMMES)}")
    settings = [*props_lines(props), f"n_statev = {n_statev}", f"temperature = {temperature!r}"]
    controls = [f"{which}_increment = {1.0 / INCREMENTS}" for which in ("initial", "maximum")]
    steps = [
        ("step", ["duration = 1.0", *(f"{key} = {value}" for key, value in targets.items())])
        for targets in PROGRAMMES[name]
    ]
    return Case(settings, [("controls", controls), *steps], f"programme {name}")
