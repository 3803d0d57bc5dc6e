"""`plyflow bench`: error against run time and increments, with peers on the same material."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from plyflow.errors import ToolError

FOLDER = Path("plyflow-bench")


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="bench")(bench)


def bench(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for report and figures.")] = FOLDER,
    quick: Annotated[bool, typer.Option("--quick", help="Two problems, few repeats: under a minute.")] = False,
    json_file: Annotated[Path | None, typer.Option("--json", help="Write the JSON to this file too.")] = None,
    repeats: Annotated[int | None, typer.Option(help="Runs of each combination, in turns (at least 3).")] = None,
) -> None:
    """Measure error against run time for scenes, tangents, integrators, step controls and peers, all in one session."""
    try:
        from plyflow.evidence.bench.run import run_bench
    except ModuleNotFoundError as error:
        if error.name != "tensortrax":
            raise
        raise ToolError("one of the peers needs tensortrax: pip install tensortrax, or './run setup' in the project") from error
    run_bench(output, Console(), quick=quick, json_file=json_file, repeats=repeats)
