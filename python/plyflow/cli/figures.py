"""`plyflow figures`: counterparts of the paper's figures from the model, and the paper's claims as checks."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from plyflow.cli.run import parse_settings
from plyflow.errors import InputError

if TYPE_CHECKING:
    from plyflow.paper.run import Report

FOLDER = Path("plyflow-figures")
ONLY = "2a, 2b, 6a, 6b, 7, 8, 9, 10 or 11; several with commas (6a,7) or the option repeated."
COLOURS = {"holds": "green", "does not hold": "red", "cannot be judged": "yellow"}


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="figures")(figures)


def figures(
    *,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for figures, data and index page.")] = FOLDER,
    only: Annotated[list[str] | None, typer.Option(help=ONLY)] = None,
    with_map: Annotated[bool, typer.Option("--map/--no-map", help="Judge over gamma_lock and l0/d too.")] = True,
    setting: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="An assumption or constant of the law.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the claims as one JSON list and nothing else.")] = False,
) -> None:
    """Draw Figs. 2a, 2b, 6a, 6b, 7 to 11 from the model and judge the paper's claims."""
    # Matplotlib and pandas take a second to load, so only the commands that draw pay for them.
    from plyflow.paper.run import make_report, report_steps, write_report

    console = Console(quiet=as_json)
    settings, chosen = parse_settings(setting or []), split_numbers(only or [])
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("figures", total=report_steps(chosen, with_map) + 1)

        def step(what: str) -> None:
            progress.update(task, advance=1, description=what)

        report = make_report(settings, chosen, with_map, step)
        written = write_report(report, output)
    if as_json:
        print(json.dumps(report.claims().to_dict("records"), indent=2))
        return
    show(report, console)
    for path in written:
        print(path)


def split_numbers(given: list[str]) -> list[str]:
    """Figure numbers of options that hold one or several, divided by commas; each once.

    Raises
    ------
    InputError
        No number before, after or between commas.
    """
    numbers = [number.strip() for text in given for number in text.split(",")]
    if "" in numbers:
        raise InputError(f"--only {','.join(given)!r} leaves a figure number out; write for example --only 6a,7")
    return list(dict.fromkeys(numbers))


def show(report: Report, console: Console) -> None:
    """Print verdicts and numbers."""
    if not report.findings:
        return
    table = Table("claim", "verdict", "number", title="the paper's claims by the model", title_justify="left")
    for claim in report.claims().to_dict("records"):
        colour = COLOURS[claim["verdict"]]
        table.add_row(claim["text"], f"[{colour}]{claim['verdict']}[/]", claim["words"])
    console.print(table)
