"""`plyflow identify`: material parameters from compaction tests."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from plyflow.cli.run import parse_settings
from plyflow.files import write_files


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="identify")(identify)


def identify(
    data: Annotated[list[Path], typer.Argument(help="Tests: time, force, thickness, if measured width.")],
    *,
    layup: Annotated[str | None, typer.Option(help="CP, SB or BP, for files that do not say.")] = None,
    width: Annotated[float | None, typer.Option(help="Specimen width [mm].")] = None,
    ply_thickness: Annotated[float | None, typer.Option(help="Thickness of one ply [mm].")] = None,
    plies: Annotated[float | None, typer.Option(help="Plies of the specimen, default 16.")] = None,
    temperature: Annotated[float | None, typer.Option(help="Temperature [degC].")] = None,
    name: Annotated[str | None, typer.Option(help="Name of the material.")] = None,
    apart: Annotated[bool, typer.Option("--apart", help="Fit every specimen by itself.")] = False,
    tie: Annotated[str, typer.Option(help="b_squeeze from b_bleed: auto, always or never.")] = "auto",
    intervals: Annotated[str, typer.Option(help="covariance or profile (slower).")] = "covariance",
    setting: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="An assumption, as in run.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder for material file, tables and pictures.")
    ] = None,
) -> None:
    """Fit k, a, b_squeeze and b_bleed; files of several temperatures give a material with as many columns."""
    # Loading lmfit takes longer than most commands do, so only this one pays for it.
    from plyflow.identify.output import grouped, result_files, show
    from plyflow.identify.refine import fit
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
    specimens = [read_specimen(path, known, settings) for path in data]
    fits = [fit(group, tie, intervals) for group in grouped(specimens, apart)]
    material = name or next((one.material for one in specimens if one.material), "fitted material")
    written = [] if output is None else write_files(output, result_files(material, fits, apart))
    if as_json:
        found = [fit_data(one) for one in fits]
        print(json.dumps(found[0] if len(found) == 1 else found, indent=2, allow_nan=False))
        return
    show(fits, Console())
    for path in written:
        print(path)
