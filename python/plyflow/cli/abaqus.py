"""`plyflow abaqus`: source, material card and ready jobs of a scene for Abaqus."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

FOLDER = Path("plyflow-abaqus")


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="abaqus")(abaqus)


def abaqus(
    scene: Annotated[str, typer.Argument(help="Shipped scene or file NAME.toml.")] = "default",
    *,
    material: Annotated[str, typer.Option(help="IM7-8552, IMA-M21 or a material file NAME.toml.")],
    temperature: Annotated[float, typer.Option(help="Temperature in degC.")] = 70.0,
    layup: Annotated[str, typer.Option(help="CP, SB or BP: 1, 2 or 4 equal plies in a block.")] = "BP",
    width: Annotated[float, typer.Option(help="Specimen width in mm; the paper has 15 and 30.")] = 15.0,
    setting: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="Any assumption or PROPS.")
    ] = None,
    extrapolate: Annotated[
        bool, typer.Option("--extrapolate", help="Allow a temperature outside the material's table.")
    ] = False,
    also: Annotated[
        list[str] | None,
        typer.Option("--also", metavar="SCENE", help="Put this scene and the first into one source, together.for."),
    ] = None,
    aba_param: Annotated[
        bool, typer.Option("--aba-param", help="Begin UMAT with INCLUDE 'ABA_PARAM.INC', for sites that ask for it.")
    ] = False,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder of the files.")] = FOLDER,
) -> None:
    """Write source, decks (C3D8, C3D8R, C3D8H, CPE4, CAX4, a laminate) and a README; print their paths."""
    from plyflow.case.case import Case
    from plyflow.cli.run import parse_settings
    from plyflow.errors import InputError
    from plyflow.files import write_files
    from plyflow.hosts.abaqus.package import abaqus_files

    if not math.isfinite(temperature):
        raise InputError(f"--temperature {temperature:g}: give a finite number in degC, for example --temperature 70")
    settings = parse_settings(setting or [])
    case = Case(material, temperature, layup, width, "ramp-dwell", settings, extrapolate)
    for path in write_files(output, abaqus_files(scene, case, also or (), aba_param=aba_param)):
        print(path)
