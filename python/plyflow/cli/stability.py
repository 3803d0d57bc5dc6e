"""`plyflow stability`: stiff, extreme and refused states of UMAT and driver, as a matrix with verdicts."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

FOLDER = Path("plyflow-stability")


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="stability")(stability)


def stability(
    json_file: Annotated[Path | None, typer.Option("--json", help="Write the JSON to this file too.")] = None,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the tables.")] = FOLDER,
    quick: Annotated[bool, typer.Option("--quick", help="A reduced matrix.")] = False,
) -> None:
    """Run the stability matrix; ends with tables as HTML and JSON."""
    from plyflow.evidence.stability.run import run_stability

    run_stability(output, Console(), json_file, quick)
