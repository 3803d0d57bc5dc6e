"""`plyflow sweep`: a grid or a list of cases through Dask, resumable, into one table."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

if TYPE_CHECKING:
    from plyflow.sweep.run import SweepOutcome

FOLDER = Path("plyflow-sweep")


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="sweep")(sweep)


def sweep(
    file: Annotated[
        Path | None, typer.Argument(help="Cases: TOML with a grid table or case tables, or CSV with a case a row.")
    ] = None,
    *,
    grid: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUES",
            help="A name that varies: 30,50,70 or FROM:TO:STEP or FROM:TO@COUNT. Names: material, temperature, layup, "
            "width, load, scene, refine, any assumption or PROPS. Repeat; every combination is run.",
        ),
    ] = None,
    setting: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="The same value in every case.")
    ] = None,
    model: Annotated[str | None, typer.Option(help="law1d (default) or umat.")] = None,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for the result.")] = FOLDER,
    workers: Annotated[
        int | None,
        typer.Option(help="Local processes, default one a processor if there are cases enough; 0 for none besides this."),
    ] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help="An existing Dask scheduler.")] = None,
    chunk: Annotated[int | None, typer.Option(help="Cases a part, default 500 (law1d) or 25 (umat).")] = None,
    extrapolate: Annotated[
        bool, typer.Option("--extrapolate", help="Allow temperatures outside the material's table.")
    ] = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Discard another sweep in the folder.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
) -> None:
    """Run many cases; stopped or killed, the same command goes on where it was.

    A case that fails stands in the table with its reason and does not change the exit status, which is 0; only if every
    case failed is it 2.
    """
    # Parquet and Dask take a second to load, so only this command pays for them.
    from plyflow.sweep.plan import make_plan
    from plyflow.sweep.run import run_sweep
    from plyflow.sweep.sources import read_fixed, read_source

    source, said = read_source(file, grid or [], read_fixed(setting or []))
    plan = make_plan(source, str(model or said.get("model", "law1d")), chunk, extrapolate)
    console = Console(quiet=as_json)
    try:
        outcome = run_sweep(plan, output, console, workers=workers, scheduler=scheduler, overwrite=overwrite)
    except KeyboardInterrupt:
        print("plyflow: stopped; what is done stays, the same command goes on from there", file=sys.stderr)
        raise typer.Exit(130) from None
    if as_json:
        print(json.dumps(vars(outcome) | {"files": [str(path) for path in outcome.files]}, indent=2))
        return
    show(outcome, console)


def show(outcome: SweepOutcome, console: Console) -> None:
    """Print counts, the first failures and the files."""
    console.print(f"{outcome.cases} cases, {outcome.failed} failed, {outcome.run} run now", highlight=False)
    for example in outcome.examples:
        console.print(f"  case {example['case']}: {example['reason']}", highlight=False, markup=False, style="red")
    if outcome.failed > len(outcome.examples):
        console.print(f"  {outcome.failed - len(outcome.examples)} more, see the column reason", highlight=False)
    for path in outcome.files:
        print(path)
