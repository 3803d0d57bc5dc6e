"""What several commands share: their options, declared once, and how they print."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from plyflow.errors import InputError

THICKEST_PLY = 10.0  # mm
MATERIAL = typer.Option(help="IM7-8552, IMA-M21 or a material file NAME.toml.")
TEMPERATURE = typer.Option(help="Temperature in degC.")
LAYUP = typer.Option(help="CP, SB, BP (1, 2, 4 equal plies in a block) or any number of equal plies, as 3.")
WIDTH = typer.Option(help="Specimen width in mm; the paper has 15 and 30.")
OUTPUT = typer.Option("-o", "--output", help="Folder of the files.")
Load = Annotated[str, typer.Option(help="ramp-dwell, monotonic or a file NAME.csv of force or pressure.")]
Settings = Annotated[
    list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="Any assumption or constant; may be repeated.")
]
PlyThickness = Annotated[float | None, typer.Option(help="Thickness of one ply in mm, in place of the material's.")]
Extrapolate = Annotated[bool, typer.Option("--extrapolate", help="Allow a temperature outside the material's table.")]
Output = Annotated[Path, OUTPUT]
OutputIfAny = Annotated[Path | None, OUTPUT]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")]
JsonFile = Annotated[Path | None, typer.Option("--json", help="Write the JSON to this file too.")]
SceneName = Annotated[str, typer.Argument(metavar="SCENE", help="Shipped scene or file NAME.toml.")]


def parse_settings(entries: Iterable[str] | None) -> dict[str, float]:
    """NAME=VALUE entries as a dictionary.

    Raises
    ------
    InputError
        An entry has no '=' or its value is not a number.
    """
    settings = {}
    for entry in entries or ():
        name, separator, text = entry.partition("=")
        try:
            settings[name.strip()] = float(text)
        except ValueError:
            separator = ""
        if not separator:
            raise InputError(f"--set {entry}: write NAME=VALUE with a number, for example --set kappa=1000")
    return settings


def with_ply_thickness(settings: dict[str, float], ply_thickness: float | None, layup: str) -> dict[str, float]:
    """Settings with the block thickness h0 [mm] of a layup of plies of another thickness [mm].

    Raises
    ------
    InputError
        Not above 0, more than 10 mm, or h0 set as well.
    """
    from plyflow.case.programme import plies_in_block

    if ply_thickness is None:
        return settings
    if not 0.0 < ply_thickness <= THICKEST_PLY:
        bounds = f"must be above 0 and at most {THICKEST_PLY:g} mm"
        raise InputError(f"--ply-thickness {ply_thickness:g} mm {bounds}: a prepreg ply has some 0.1 to 0.5 mm")
    if "h0" in settings:
        raise InputError("--ply-thickness and --set h0 exclude each other: h0 is that of the block; give one of them")
    return settings | {"h0": ply_thickness * plies_in_block(layup)}


def print_lines(console: Console, lines: Iterable[str]) -> None:
    """Lines as they are, however long."""
    for line in lines:
        console.print(line, highlight=False, markup=False, soft_wrap=True)


def print_assumptions(console: Console, lines: Iterable[str]) -> None:
    """What a result rests on, each line once."""
    console.print("Assumptions", style="bold")
    for line in dict.fromkeys(lines):
        console.print(f"  - {line}", highlight=False, markup=False)


def print_paths(paths: Iterable[Path]) -> None:
    """The files written, one a line."""
    for path in paths:
        print(path)
