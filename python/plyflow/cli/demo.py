"""`plyflow demo`: the paper's compaction programme, 84 cases, with table, figures and report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

FOLDER = Path("plyflow-demo")


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="demo")(demo)


def demo(
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for report and data.")] = FOLDER,
) -> None:
    """Generate, compile and run the 84 cases; end with a table, figures and one HTML report."""
    from plyflow.paper.demo import run_demo

    run_demo(output, Console())
