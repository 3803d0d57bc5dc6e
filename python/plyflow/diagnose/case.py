"""Case files of the driver as text: what is to be changed to run another UMAT, or one increment alone."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

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


@dataclass(frozen=True)
class Case:
    """A case: its lines, those outside all blocks first, without library and outputs.

    `name` is that of its file or programme; `numbers` has, of the file, the line of each line.
    """

    lines: Sequence[str]
    name: str = "case"
    numbers: Sequence[int] = ()

    def text(self, library: Path) -> str:
        """The whole programme for a UMAT library."""
        return "\n".join([f"library = {library}", *self.lines, *_QUIET]) + "\n"

    @property
    def from_file(self) -> bool:
        """Whether it was read from a file, in contrast to the built-in programmes."""
        return bool(self.numbers)

    def setting(self, name: str) -> list[float]:
        """All numbers of the lines NAME = ... outside the blocks; those that are none are left to the driver."""
        head = itertools.takewhile(lambda line: not line.startswith("begin "), self.lines)
        found = [line.partition("=")[2].split() for line in head if line.partition("=")[0].strip() == name]
        return [float(word.replace("d", "e")) for words in found for word in words]

    def place(self, number: int) -> str:
        """Where a line of `text`, counted from 1, stands in the user's file."""
        inside = 1 < number <= len(self.numbers) + 1
        return f"{self.name}:{self.numbers[number - 2]}" if inside else self.name

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
        settings = itertools.takewhile(lambda line: not line.startswith("begin "), self.lines)
        blocks = (_block("start", begin), _block("controls", controls), _block("step", step))
        return replace(self, lines=[*settings, *itertools.chain(*blocks)]).text(library)


def _block(name: str, lines: Iterable[str]) -> list[str]:
    return [f"begin {name}", *lines, f"end {name}"]


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
    outside: list[tuple[int, str]] = []
    inside: list[tuple[int, str]] = []
    block = ""
    for number, line in enumerate(lines, 1):
        words = line.partition("!")[0].replace("=", " = ").split()
        if not words:
            continue
        said = " ".join(words)
        if words[0] in ("begin", "end"):
            due = f"end {block}" if block else "begin NAME"
            if said != due and (block or words[0] != "begin" or len(words) != 2):
                raise InputError(f"case {path}, line {number}: '{line.strip()}' where '{due}' is due")
            block = "" if block else words[1]
            inside.append((number, said))
        elif block:
            inside.append((number, said))
        elif words[0] not in _OUTPUTS:
            outside.append((number, said))
    if block:
        raise InputError(f"case {path}: the block '{block}' does not end; write 'end {block}'")
    kept = [*outside, *inside]
    return Case([said for _, said in kept], str(path), [number for number, _ in kept])


def with_manifest(case: Case, manifest: Mapping[str, Any], name: str) -> Case:
    """The case with what it leaves open from a manifest: constants at their defaults, the number of state variables.

    Raises
    ------
    InputError
        The case gives another number of constants or state variables than the manifest, called `name`, has.
    """
    outside = list(itertools.takewhile(lambda line: not line.startswith("begin "), case.lines))
    found = [line.partition(" = ")[::2] for line in outside]
    props = [word for key, values in found if key == "props" for word in values.replace(",", " ").split()]
    counts = [values for key, values in found if key == "n_statev"]
    wanted = {"constants": len(manifest["props"]), "state variables": len(manifest["statev"])}
    given = {"constants": str(len(props)) if props else "", "state variables": counts[-1] if counts else ""}
    for what, number in given.items():
        if number and number != str(wanted[what]):
            raise InputError(f"{case.name} gives {number} {what}, {name} has {wanted[what]}: give that many, or none")
    defaults = sorted(manifest["props"], key=lambda row: int(row["index"]))
    added = [] if props else props_lines([row["default"] for row in defaults])
    added += [] if counts else [f"n_statev = {wanted['state variables']}"]
    place = len(outside)
    numbers = [*case.numbers[:place], *([0] * len(added)), *case.numbers[place:]] if case.from_file else []
    return replace(case, lines=[*outside, *added, *case.lines[place:]], numbers=numbers)


def programme(name: str, props: Sequence[float], n_statev: int | None, temperature: float = 0.0) -> Case:
    """One of the built-in programmes, each step of 1 s in ten increments.

    Raises
    ------
    InputError
        Unknown name.
    """
    if name not in PROGRAMMES:
        raise InputError(f"case '{name}' is neither a file nor one of {', '.join(PROGRAMMES)}")
    counts = [] if n_statev is None else [f"n_statev = {n_statev}"]
    settings = [*props_lines(props), *counts, f"temperature = {temperature!r}"]
    settings += _block("controls", [f"{which}_increment = {1.0 / INCREMENTS}" for which in ("initial", "maximum")])
    for targets in PROGRAMMES[name]:
        settings += _block("step", ["duration = 1.0", *(f"{key} = {value}" for key, value in targets.items())])
    return Case(settings, f"programme {name}")
