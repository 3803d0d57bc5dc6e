"""`plyflow run`: one case of the compaction programme."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from plyflow.case.case import Case
from plyflow.errors import InputError
from plyflow.files import write_files
from plyflow.run.case_run import RunResult, case_controls, run_case
from plyflow.umat.prepare import prepare_umat
from plyflow.wording import count_text

REPLAY_FILE = "failed-increment.txt"


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="run")(run)


def run(
    *,
    material: Annotated[str, typer.Option(help="IM7-8552, IMA-M21 or a material file NAME.toml.")],
    temperature: Annotated[float, typer.Option(help="Temperature in degC.")],
    layup: Annotated[str, typer.Option(help="CP, SB, BP (1, 2, 4 equal plies in a block) or that number itself.")],
    width: Annotated[float, typer.Option(help="Specimen width in mm; the paper has 15 and 30.")] = 15.0,
    load: Annotated[str, typer.Option(help="ramp-dwell, monotonic or a file NAME.csv of force or pressure.")] = "ramp-dwell",
    scene: Annotated[str, typer.Option(help="Scene of the UMAT.")] = "default",
    gamma_lock: Annotated[float | None, typer.Option(help="Assumed largest edge shear in degrees.")] = None,
    l0_over_d: Annotated[float | None, typer.Option(help="Assumed fibre length over edge length of the square fibre.")] = None,
    fibre_fraction: Annotated[float | None, typer.Option(help="Assumed initial fibre fraction.")] = None,
    chi_ratio: Annotated[float | None, typer.Option(help="Assumed chi_l / chi_f.")] = None,
    setting: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="Any assumption or PROPS.")
    ] = None,
    extrapolate: Annotated[
        bool, typer.Option("--extrapolate", help="Allow a temperature outside the material's table.")
    ] = False,
    refine: Annotated[float, typer.Option(help="Shorten every increment by this factor.")] = 1.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder for result and history files.")
    ] = None,
) -> None:
    """Compact one ply block under the plate and compare with the one-dimensional law."""
    named = {
        "gamma_lock": gamma_lock,
        "l0_over_d": l0_over_d,
        "fibre_fraction_initial": fibre_fraction,
        "chi_ratio": chi_ratio,
    }
    settings = {name: value for name, value in named.items() if value is not None} | parse_settings(
        setting or []
    )
    case = Case(material, temperature, layup, width, load, settings, extrapolate)
    replay = (output if output is not None else Path()) / REPLAY_FILE
    result = run_case(case, prepare_umat(scene, case.fibre_fraction), case_controls(refine), replay)
    written = write_files(output, result_files(result)) if output is not None else []
    if as_json:
        print(result.to_json())
        return
    show(result, Console())
    for path in written:
        print(path)


def parse_settings(entries: list[str]) -> dict[str, float]:
    """NAME=VALUE entries as a dictionary.

    Raises
    ------
    InputError
        An entry has no '=' or its value is not a number.
    """
    settings = {}
    for entry in entries:
        name, separator, text = entry.partition("=")
        try:
            settings[name.strip()] = float(text)
        except ValueError:
            separator = ""
        if not separator:
            raise InputError(f"--set {entry}: write NAME=VALUE with a number, for example --set kappa=1000")
    return settings


def result_files(result: RunResult) -> dict[str, str]:
    """Files of one run: result, history and increment table, by name."""
    return {
        "result.json": result.to_json() + "\n",
        "history.csv": result.history_table().to_csv(index=False, lineterminator="\n"),
        "increments.csv": result.history.increment_table.to_csv(index=False, lineterminator="\n"),
    }


def _lock_cells(umat: float | None, law: float | None) -> list[str]:
    """Lock times [s] by the UMAT, at the end of the increment in which it locked, and by the law; their difference."""
    cells = ["never" if time is None else f"{time:.4g}" for time in (umat, law)]
    return [*cells, "" if umat is None or law is None else f"{umat - law:+.1e}"]


def show(result: RunResult, console: Console) -> None:
    """Print the result and what it rests on."""
    summary = result.summary()
    table = Table(title=result.case.label)
    for heading in ("", "UMAT", "1D law", "difference"):
        table.add_column(heading, justify="left" if not heading else "right")
    for quantity in ("thickness", "width"):
        umat, law = summary[f"{quantity}_ratio_final"], summary[f"{quantity}_ratio_1d"]
        table.add_row(f"{quantity} ratio, final", f"{umat:.6f}", f"{law:.6f}", f"{umat - law:+.1e}")
    table.add_row("lock time, s", *_lock_cells(summary["lock_time"], summary["lock_time_1d"]))
    console.print(table)
    counts = (count_text(summary[f"{one}s"], one, f"{one}s") for one in ("increment", "iteration", "cutback"))
    console.print(f"{', '.join(counts)}, {summary['run_time_s']:.3f} s")
    console.print("Assumptions", style="bold")
    for line in result.assumptions:
        console.print(f"  - {line}", highlight=False, markup=False)
