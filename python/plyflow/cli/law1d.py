"""`plyflow law1d`: the one-dimensional law for many cases at once."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer
from rich import box
from rich.console import Console
from rich.table import Table

from plyflow.case.case import Case
from plyflow.case.materials import find_material
from plyflow.case.programme import layup_text
from plyflow.cli.run import parse_settings
from plyflow.errors import InputError
from plyflow.files import write_files
from plyflow.run.law_run import CaseHistory, histories
from plyflow.run.synthetic import synthetic_test

LIMIT_NOTE = (
    "limit: h/h0 that the ply approaches and never passes; bleeds at: time at which the fibres lock, the ply stops widening "
    "and resin bleeds out"
)


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="law1d")(law1d)


def law1d(
    *,
    material: Annotated[list[str], typer.Option(help="IM7-8552, IMA-M21 or a material file; may be repeated.")],
    temperature: Annotated[list[float], typer.Option(help="Temperature, degC; may be repeated.")],
    layup: Annotated[
        list[str], typer.Option(help="CP, SB, BP or the number of equal plies in a block; may be repeated.")
    ],
    width: Annotated[list[float] | None, typer.Option(help="Width, mm, default 15; may be repeated.")] = None,
    plies: Annotated[int | None, typer.Option(help="Plies of the specimen, default 16.")] = None,
    load: Annotated[
        str, typer.Option(help="ramp-dwell, monotonic or a file NAME.csv of force or pressure.")
    ] = "ramp-dwell",
    block_thickness: Annotated[float | None, typer.Option(help="Thickness of a block of equal plies, mm.")] = None,
    setting: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="Any assumption or constant.")
    ] = None,
    extrapolate: Annotated[
        bool, typer.Option("--extrapolate", help="Allow a temperature outside the material's table.")
    ] = False,
    every: Annotated[float | None, typer.Option(help="Spacing of the history, s.")] = None,
    match_time: Annotated[
        float | None, typer.Option(help="Time, s, at which the comparison laws have the model's thickness.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON list and nothing else.")] = False,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="Folder for tables and a figure.")] = None,
    as_test: Annotated[Path | None, typer.Option(help="Write a synthetic test of the case for `identify`.")] = None,
    thickness_noise: Annotated[
        float, typer.Option(help="Noise (standard deviation) of the synthetic thickness, mm.")
    ] = 0.0,
    force_noise: Annotated[float, typer.Option(help="Noise (standard deviation) of the synthetic force, N.")] = 0.0,
    seed: Annotated[int, typer.Option(help="Seed of the noise.")] = 0,
) -> None:
    """Thickness, width, fibre fraction and flow stage over time; every combination of the repeated options."""
    settings = parse_settings(setting or []) | ({} if block_thickness is None else {"h0": block_thickness})
    if every is not None and not every > 0.0:
        raise InputError(f"--every {every:g} s must be above 0")
    widths = width or [15.0]
    choices = itertools.product(material, temperature, layup, widths)
    cases = [Case(*choice, load, settings, extrapolate, plies) for choice in choices]
    done = histories(cases, every, match_time)
    written = [] if output is None else write_files(output, result_files(done, load))
    if as_test is not None:
        written += write_test(as_test, cases, (thickness_noise, force_noise), every or 1.0, seed)
    if as_json:
        print(summaries(done, load))
        return
    show(done, load, Console())
    for path in written:
        print(path)


def summaries(done: list[CaseHistory], load: str) -> str:
    """The summary of every case as a JSON list."""
    return json.dumps([{"load": load} | history.summary() for history in done], indent=2, allow_nan=False)


def result_files(done: list[CaseHistory], load: str) -> dict[str, str]:
    """Files of a call: all histories in one table, the summaries, a figure."""
    from plyflow.paper.law_figure import history_figure

    tables = []
    for number, history in enumerate(done, start=1):
        table = history.table()
        table.insert(0, "case", number)
        table.insert(1, "label", history.case.specimen)
        tables.append(table)
    return {
        "history.csv": pd.concat(tables).to_csv(index=False, lineterminator="\n"),
        "summary.json": summaries(done, load) + "\n",
        "thickness.svg": history_figure(done),
    }


def write_test(
    path: Path,
    cases: list[Case],
    noise: tuple[float, float],
    every: float,
    seed: int,
) -> list[Path]:
    """Write the synthetic test of the only case."""
    if len(cases) != 1:
        raise InputError(f"--as-test writes the test of one case, but the options make {len(cases)}: give one of each")
    if min(noise) < 0.0:
        raise InputError(f"noise {min(noise):g} must not be below 0: it is a standard deviation")
    test = synthetic_test(cases[0], every)
    if max(noise) > 0.0:
        test = test.with_noise(*noise, seed)
    return write_files(path.parent, {path.name: test.text()})


def show(done: list[CaseHistory], load: str, console: Console) -> None:
    """Print a line a case, with the comparison laws."""
    table = Table(title=f"one-dimensional law, {load}", title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 0))
    headings = ("case", "h/h0", "h mm", "limit", "w/w0", "fibre", "bleeds at", "Rogers", "W-G")
    for heading in headings:
        table.add_column(heading, justify="left" if heading == "case" else "right", no_wrap=heading != "case")
    for history in done:
        case = history.case
        label = f"{find_material(case.material).name} {case.temperature:g} {layup_text(case.layup)} {case.width:g}"
        table.add_row(*_cells(label, history.summary()))
    console.print(table)
    console.print(LIMIT_NOTE, highlight=False)
    met = dict.fromkeys(f"{history.match_time:g} s" for history in done if history.comparison)
    if met:
        console.print(
            f"Rogers, W-G: h/h0 of the comparison laws, which have the model's thickness at {', '.join(met)}", highlight=False
        )
    console.print("Assumptions", style="bold")
    for line in dict.fromkeys(line for history in done for line in history.assumption_lines()):
        console.print(f"  - {line}", highlight=False, markup=False)


def _cells(label: str, summary: dict[str, Any]) -> list[str]:
    lock = summary["lock_time"]
    comparison = [f"{law['thickness_ratio_final']:.4f}" for law in summary["comparison"].values()] or ["", ""]
    return [
        label,
        f"{summary['thickness_ratio_final']:.4f}",
        f"{summary['thickness_final_mm']:.4f}",
        f"{summary['thickness_ratio_limit']:.4f}",
        f"{summary['width_ratio_final']:.4f}",
        f"{summary['fibre_fraction_final']:.3f}",
        "never" if lock is None else f"{lock:.4g} s",
        *comparison,
    ]
