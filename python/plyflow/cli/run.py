"""`plyflow run`, `replay`, `sweep`: one case, the increment a case failed in, many cases."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from plyflow.cli.shared import (
    LAYUP,
    MATERIAL,
    TEMPERATURE,
    WIDTH,
    AsJson,
    Extrapolate,
    Load,
    Output,
    OutputIfAny,
    PlyThickness,
    Settings,
    parse_settings,
    print_assumptions,
    print_lines,
    print_paths,
    with_ply_thickness,
)
from plyflow.errors import InputError
from plyflow.files import write_files
from plyflow.wording import count_text

if TYPE_CHECKING:
    from plyflow.run.case_run import RunResult

REPLAY_FILE = "failed-increment.txt"
FAILS_AGAIN = 1
STOPPED = 130
SWEEP_FOLDER = Path("plyflow-sweep")
ACCURACY = "Pick the increments for this error of the final thickness ratio, e.g. 1e-4, and state the estimate."
CASES = "Cases: TOML with a grid table or case tables, or CSV with a case a row."
GRID = (
    "A name that varies: 30,50,70 or FROM:TO:STEP or FROM:TO@COUNT. Names: material, temperature, layup, width, load, "
    "scene, refine, cells and friction of laminates, any assumption or PROPS. Repeat; every combination is run."
)


def run(
    *,
    material: Annotated[str, MATERIAL],
    temperature: Annotated[float, TEMPERATURE],
    layup: Annotated[str, LAYUP],
    width: Annotated[float, WIDTH] = 15.0,
    ply_thickness: PlyThickness = None,
    load: Load = "ramp-dwell",
    scene: Annotated[str, typer.Option(help="Scene of the UMAT.")] = "default",
    gamma_lock: Annotated[float | None, typer.Option(help="Assumed largest edge shear in degrees.")] = None,
    l0_over_d: Annotated[float | None, typer.Option(help="Assumed fibre length over edge length of the square fibre.")] = None,
    fibre_fraction: Annotated[float | None, typer.Option(help="Assumed initial fibre fraction.")] = None,
    chi_ratio: Annotated[float | None, typer.Option(help="Assumed chi_l / chi_f.")] = None,
    setting: Settings = None,
    extrapolate: Extrapolate = False,
    refine: Annotated[float | None, typer.Option(help="Shorten every increment by this factor (default 1).")] = None,
    accuracy: Annotated[float | None, typer.Option(help=ACCURACY)] = None,
    as_json: AsJson = False,
    output: OutputIfAny = None,
) -> None:
    """Compact one ply block under the plate and compare with the one-dimensional law."""
    from plyflow.case.case import Case
    from plyflow.run.case_run import case_controls, run_case
    from plyflow.umat.prepare import prepare_umat

    if refine is not None and accuracy is not None:
        raise InputError("--refine and --accuracy exclude each other: --accuracy picks the increments itself; give one of them")
    named = {
        "gamma_lock": gamma_lock,
        "l0_over_d": l0_over_d,
        "fibre_fraction_initial": fibre_fraction,
        "chi_ratio": chi_ratio,
    }
    settings = {name: value for name, value in named.items() if value is not None} | parse_settings(setting)
    settings = with_ply_thickness(settings, ply_thickness, layup)
    case = Case(material, temperature, layup, width, load, settings, extrapolate)
    umat = prepare_umat(scene, case.fibre_fraction)
    controls = None if refine is None else case_controls(refine, umat.manifest["scene"]["integrator"])
    result = run_case(case, umat, controls, (output or Path()) / REPLAY_FILE, accuracy)
    written = write_files(output, result_files(result)) if output is not None else []
    if as_json:
        print(result.to_json())
        return
    show(result, Console())
    print_paths(written)


def result_files(result: RunResult) -> dict[str, Any]:
    """Files of one run: result, history and increment table, by name."""
    tables = {"history.csv": result.history_table(), "increments.csv": result.history.increment_table}
    return {"result.json": result.summary(), **tables}


def show(result: RunResult, console: Console) -> None:
    """Print the result and what it rests on."""
    from plyflow.show.table import Column, Table

    found = result.summary()
    finals = {one: (found[f"{one}_ratio_final"], found[f"{one}_ratio_1d"]) for one in ("thickness", "width")}
    rows: list[Any] = [(f"{one} ratio, final", f"{umat:.6f}", f"{law:.6f}", umat - law) for one, (umat, law) in finals.items()]
    locks = [found["lock_time"], found["lock_time_1d"]]
    times = ["never" if time is None else f"{time:.4g}" for time in locks]
    rows.append(("lock time, s", *times, None if None in locks else locks[0] - locks[1]))
    columns = (Column(""), Column("UMAT", align="right"), Column("1D law", align="right"), Column("difference", "+.1e"))
    console.print(Table(columns, rows, result.case.label).rich())
    counts = (count_text(found[f"{one}s"], one, f"{one}s") for one in ("increment", "iteration", "cutback"))
    console.print(f"{', '.join(counts)}, {found['run_time_s']:.3f} s")
    if (reached := result.reached) is not None:
        console.print(
            f"error of the final thickness ratio: estimated {reached.estimate:.1e}, wanted {reached.wanted:g}; "
            f"off the 1D law by {found['error_1d']:+.1e}; {reached.increments} increments in all {reached.runs} runs",
            highlight=False,
        )
    print_assumptions(console, result.assumptions)


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
    print_lines(Console(), repeated.lines())
    if not repeated.history.completed:
        raise typer.Exit(FAILS_AGAIN)


def sweep(
    file: Annotated[Path | None, typer.Argument(help=CASES)] = None,
    *,
    grid: Annotated[list[str] | None, typer.Option(metavar="NAME=VALUES", help=GRID)] = None,
    setting: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="The same value in every case.")
    ] = None,
    model: Annotated[str | None, typer.Option(help="law1d (default), umat or laminate.")] = None,
    output: Output = SWEEP_FOLDER,
    workers: Annotated[
        int | None,
        typer.Option(help="Local processes, default one a processor if there are cases enough; 0 for none besides this."),
    ] = None,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help="An existing Dask scheduler.")] = None,
    chunk: Annotated[int | None, typer.Option(help="Cases a part, default 500 (law1d), 25 (umat), 1 (laminate).")] = None,
    extrapolate: Extrapolate = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Discard another sweep in the folder.")] = False,
    as_json: AsJson = False,
) -> None:
    """Run many cases; stopped or killed, the same command goes on where it was.

    A case that fails stands in the table with its reason and does not change the exit status, which is 0; only if every
    case failed is it 2.
    """
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
        raise typer.Exit(STOPPED) from None
    if as_json:
        print(json.dumps(vars(outcome) | {"files": [str(path) for path in outcome.files]}, indent=2))
        return
    console.print(f"{outcome.cases} cases, {outcome.failed} failed, {outcome.run} run now", highlight=False)
    for example in outcome.examples:
        console.print(f"  case {example['case']}: {example['reason']}", highlight=False, markup=False, style="red")
    if outcome.failed > len(outcome.examples):
        console.print(f"  {outcome.failed - len(outcome.examples)} more, see the column reason", highlight=False)
    print_paths(outcome.files)
