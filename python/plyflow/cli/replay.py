"""`plyflow replay`: the one increment that an analysis failed in, once more."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

FAILS_AGAIN = 1


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="replay")(replay)


def replay(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Replay file that a failed run has written.")],
    umat: Annotated[
        str | None,
        typer.Option(help="Call this UMAT in place of the one that failed: scene, Fortran source or library."),
    ] = None,
) -> None:
    """Repeat the increment an analysis failed in; exit status 1 if it fails again, 0 if it goes through."""
    from plyflow.run.replay import replay_file

    repeated = replay_file(file, umat)
    for line in repeated.lines():
        Console().print(line, highlight=False, markup=False, soft_wrap=True)
    if not repeated.history.completed:
        raise typer.Exit(FAILS_AGAIN)
