"""`plyflow identify`: material parameters from compaction tests."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from plyflow.cli.run import parse_settings
from plyflow.errors import InputError
from plyflow.files import write_files


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="identify")(identify)


def identify(
    data: Annotated[
        list[Path],
        typer.Argument(
            help="One CSV file a test: columns time, force, thickness of the specimen and, if measured, width."
        ),
    ],
    *,
    layup: Annotated[str | None, typer.Option(help="CP, SB, BP or the number of equal plies in a block.")] = None,
    width: Annotated[float | None, typer.Option(help="Width of the square specimen, mm.")] = None,
    ply_thickness: Annotated[float | None, typer.Option(help="Thickness of one ply before the test, mm.")] = None,
    plies: Annotated[float | None, typer.Option(help="Plies of the specimen, 16 if nothing says otherwise.")] = None,
    temperature: Annotated[float | None, typer.Option(help="Temperature of the test, degC.")] = None,
    name: Annotated[str | None, typer.Option(help="Name of the material in the file written.")] = None,
    apart: Annotated[bool, typer.Option("--apart", help="Fit every specimen by itself.")] = False,
    tie: Annotated[
        str,
        typer.Option(
            help="b_squeeze = b_bleed + 2 ln(l0/d), as in the paper's tables: always, never, or auto (where the readings "
            "cannot tell b_squeeze)."
        ),
    ] = "auto",
    intervals: Annotated[
        str, typer.Option(help="covariance, or profile (slower, right in a curved valley too).")
    ] = "covariance",
    setting: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="An assumption, for example gamma_lock=75.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder for material.toml, fit.json, tables and pictures.")
    ] = None,
) -> None:
    """Fit k, a, b_squeeze and b_bleed to compaction tests and write a material file.

    A file starts with a heading such as "time (s);force (N);thickness (mm)": units as wanted, decimal points or commas,
    columns divided by comma, semicolon, tab or blanks. Lines that start with # are comments; those of the form
    "# width: 15 mm" give layup (or plies per block), width, ply thickness, plies, temperature and material. The options
    say the same for files that do not, and win. Tests of one temperature are fitted together; several temperatures give a
    material with as many columns.
    """
    # Loading lmfit takes longer than most commands do, so only this one pays for it.
    from plyflow.identify.output import fit_groups, result_files, show
    from plyflow.identify.report import fit_data
    from plyflow.identify.specimen import read_specimen

    given: dict[str, float | str | None] = {
        "layup": layup,
        "width": width,
        "ply_thickness": ply_thickness,
        "plies": plies,
        "temperature": temperature,
    }
    known = {key: value for key, value in given.items() if value is not None}
    settings = parse_settings(setting or [])
    for place, path in enumerate(data):
        if path.resolve() in [other.resolve() for other in data[:place]]:
            raise InputError(f"{path} is given twice: its readings would count double; leave one out")
    specimens = [read_specimen(path, known, settings) for path in data]
    fits = fit_groups(specimens, apart, tie, intervals, Console(stderr=True))
    material = name or next((f"{one.material}, fitted" for one in specimens if one.material), "fitted material")
    written = [] if output is None else write_files(output, result_files(material, fits, apart))
    if as_json:
        found = [fit_data(one) for one in fits]
        print(json.dumps(found[0] if len(found) == 1 else found, indent=2, allow_nan=False))
        return
    show(fits, Console())
    for path in written:
        print(path)
