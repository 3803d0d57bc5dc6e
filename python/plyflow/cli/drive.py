"""`plyflow drive`: anybody's UMAT through the driver, with its tangent checked and what is wrong with it named."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

TANGENT_WRONG = 1
PROPS_HELP = "Constants, separated by commas; for the built-in programmes."


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="drive")(drive)


def drive(
    umat: Annotated[Path, typer.Argument(metavar="SOURCE_OR_LIBRARY", help="Fortran source or shared library.")],
    case: Annotated[
        str, typer.Argument(metavar="CASE", help="Case file, or uniaxial, shear, volumetric, general, rotation.")
    ],
    *,
    props: Annotated[str, typer.Option(help=PROPS_HELP)] = "",
    n_statev: Annotated[int, typer.Option(help="State variables; for the built-in programmes.")] = 0,
    temperature: Annotated[float, typer.Option(help="Temperature in degC; for the built-in programmes.")] = 0.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
) -> None:
    """Drive a UMAT and check its DDSDDE along the path; exit status 1 if it is wrong."""
    from plyflow.diagnose.case import programme, read_case
    from plyflow.diagnose.check import diagnose
    from plyflow.diagnose.library import load_umat
    from plyflow.diagnose.report import made_with, numbers, report_data, report_lines

    chosen = read_case(Path(case)) if Path(case).is_file() else programme(case, numbers(props), n_statev, temperature)
    diagnosis = diagnose(load_umat(umat), chosen)
    if as_json:
        inputs = {"umat": str(umat), "case": case, "props": numbers(props), "temperature": temperature}
        print(json.dumps(inputs | made_with(umat) | report_data(diagnosis), indent=2))
    else:
        for line in report_lines(diagnosis):
            Console().print(line, highlight=False, markup=False, soft_wrap=True)
    if not diagnosis.right:
        raise typer.Exit(TANGENT_WRONG)
