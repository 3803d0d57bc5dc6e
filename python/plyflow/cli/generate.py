"""`plyflow generate`: write a scene's Fortran source and manifest."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from plyflow.files import write_files
from plyflow.umat.prepare import generate_scene

CURRENT_FOLDER = Path(".")


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="generate")(generate)


def generate(
    scene: Annotated[str, typer.Argument(help="Shipped scene or file NAME.toml.")] = "default",
    form: Annotated[
        str | None,
        typer.Option(help="both: fixed (72 columns) and free form; fixed: fixed form of 72 or 132 columns, for Abaqus."),
    ] = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="Folder for NAME.for and NAME.json.")
    ] = CURRENT_FOLDER,
) -> None:
    """Write the UMAT of a scene (NAME.for) and its manifest (NAME.json); print both paths."""
    source, manifest, _ = generate_scene(scene, form)
    name = manifest["name"]
    contents = {f"{name}.for": source, f"{name}.json": json.dumps(manifest, indent=2) + "\n"}
    for path in write_files(output, contents):
        print(path)
