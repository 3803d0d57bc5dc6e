"""`plyflow law1d`, `identify`: the one-dimensional law for many cases at once, its parameters from tests."""

from __future__ import annotations

import itertools
import math
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
    OutputIfAny,
    Settings,
    left_text,
    parse_settings,
    print_assumptions,
    print_paths,
)
from plyflow.errors import InputError
from plyflow.files import json_text, write_files

if TYPE_CHECKING:
    from plyflow.case.case import Case
    from plyflow.run.law_run import CaseHistory

LIMIT_NOTE = (
    "limit: h/h0 that the ply approaches and never passes; bleeds at: time at which the fibres lock, the ply stops widening "
    "and resin bleeds out"
)
CYCLE_NOTE = (
    "limit: that of the last temperature; left: time from the end to within 1 % of the limit, if temperature and pressure stay"
)
TIE = "b_squeeze = b_bleed + 2 ln(l0/d), as in the paper's tables: always, never, or auto (where the readings cannot tell b_squeeze)."
LIKE = "Material by whose table k, a and b follow a temperature column that changes; they are fitted at --temperature."
MISFIT = "Write a material although the law does not follow the readings: its intervals are then too narrow."
NOT_KNOWN = 1
DATA = "One CSV file a test: columns time, force, thickness of the specimen and, if measured, width and temperature."


def law1d(
    *,
    material: Annotated[list[str], MATERIAL],
    temperature: Annotated[list[float] | None, TEMPERATURE] = None,
    layup: Annotated[list[str], LAYUP],
    width: Annotated[list[float] | None, WIDTH] = None,
    plies: Annotated[int | None, typer.Option(help="Plies of the specimen, default 16.")] = None,
    load: Load = "ramp-dwell",
    block_thickness: Annotated[float | None, typer.Option(help="Thickness of a block of equal plies, mm.")] = None,
    setting: Settings = None,
    extrapolate: Extrapolate = False,
    every: Annotated[float | None, typer.Option(help="Spacing of the history, s.")] = None,
    match_time: Annotated[
        float | None, typer.Option(help="Time, s, at which the comparison laws have the model's thickness.")
    ] = None,
    as_json: AsJson = False,
    output: OutputIfAny = None,
    as_test: Annotated[Path | None, typer.Option(help="Write a synthetic test of the case for `identify`.")] = None,
    thickness_noise: Annotated[
        float, typer.Option(help="Noise (standard deviation) of the synthetic thickness, mm.")
    ] = 0.0,
    force_noise: Annotated[float, typer.Option(help="Noise (standard deviation) of the synthetic force, N.")] = 0.0,
    seed: Annotated[int, typer.Option(help="Seed of the noise.")] = 0,
) -> None:
    """Thickness, width, fibre fraction and flow stage over time; every combination of the repeated options."""
    from plyflow.case.case import Case
    from plyflow.run.law_run import histories

    settings = parse_settings(setting) | ({} if block_thickness is None else {"h0": block_thickness})
    if every is not None and not every > 0.0:
        raise InputError(f"--every {every:g} s must be above 0")
    choices = itertools.product(material, temperature or [math.nan], layup, width or [15.0])
    cases = [Case(*choice, load, settings, extrapolate, plies) for choice in choices]
    done = histories(cases, every, match_time)
    written = [] if output is None else write_files(output, result_files(done, load))
    if as_test is not None:
        written += write_test(as_test, cases, (thickness_noise, force_noise), every or 1.0, seed)
    if as_json:
        print(json_text(summaries(done, load)))
        return
    show(done, load, Console())
    print_paths(written)


def summaries(done: list[CaseHistory], load: str) -> list[dict[str, Any]]:
    """The summary of every case."""
    return [{"load": load} | history.summary() for history in done]


def result_files(done: list[CaseHistory], load: str) -> dict[str, Any]:
    """Files of a call: all histories in one table, the summaries, a figure."""
    import pandas as pd

    from plyflow.paper.over_time import history_figure
    from plyflow.run.cycle_figure import CycleCurve, cycle_figure

    tables = [history.table() for history in done]
    for number, (table, history) in enumerate(zip(tables, done, strict=True), start=1):
        table.insert(0, "case", number)
        table.insert(1, "label", history.case.specimen)
    files = {"history.csv": pd.concat(tables), "summary.json": summaries(done, load), "thickness.svg": history_figure(done)}
    if done[0].case.is_cycle:
        curves = [
            CycleCurve(one.case.specimen, one.solution.time, one.solution.thickness_ratio, one.solution.fibre_fraction,
                       one.solution.lock_time, one.limits())
            for one in done
        ]  # fmt: skip
        files["cycle.svg"] = cycle_figure(done[0].case.load_programme, curves)
    return files


def write_test(path: Path, cases: list[Case], noise: tuple[float, float], every: float, seed: int) -> list[Path]:
    """Write the synthetic test of the only case."""
    from plyflow.run.synthetic import synthetic_test

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
    from plyflow.show.table import Column, Table

    cycle = done[0].case.is_cycle
    names = ("h/h0", "h mm", "limit", "w/w0", "fibre", "bleeds at", *(("left",) if cycle else ("Rogers", "W-G")))
    columns = [Column("case", wrap=True), *(Column(one, ".3f" if one == "fibre" else ".4f") for one in names)]
    console.print(Table(columns, map(_row, done), f"one-dimensional law, {load}", padding=0).rich())
    console.print(LIMIT_NOTE, highlight=False)
    if cycle:
        console.print(CYCLE_NOTE, highlight=False)
    for history in done:
        if (still := history.solution.still_time) is not None:
            said = f"{history.case.specimen}: from {still:.5g} s on the limit, raised by cooling, is past the ply, which stands still"
            console.print(said, highlight=False)
    met = dict.fromkeys(f"{history.match_time:g} s" for history in done if history.comparison)
    if met:
        said = f"Rogers, W-G: h/h0 of the comparison laws, which have the model's thickness at {', '.join(met)}"
        console.print(said, highlight=False)
    print_assumptions(console, (line for history in done for line in history.assumption_lines()))


def _row(history: CaseHistory) -> list[Any]:
    from plyflow.case.materials import find_material
    from plyflow.case.programme import layup_text

    case, found = history.case, history.summary()
    heat = case.temperature_text.removesuffix(" degC")
    label = f"{find_material(case.material).name} {heat} {layup_text(case.layup)} {case.width:g}"
    names = ("thickness_ratio_final", "thickness_final_mm", "thickness_ratio_limit", "width_ratio_final", "fibre_fraction_final")
    bleeds = "never" if found["lock_time"] is None else f"{found['lock_time']:.4g} s"
    beside = [law["thickness_ratio_final"] for law in found["comparison"].values()] or [None, None]
    beside = [left_text(found["time_left_s"])] if case.is_cycle else beside
    return [label, *(found[name] for name in names), bleeds, *beside]


def identify(
    data: Annotated[list[Path], typer.Argument(help=DATA)],
    *,
    layup: Annotated[str | None, LAYUP] = None,
    width: Annotated[float | None, typer.Option(help="Width of the square specimen, mm.")] = None,
    ply_thickness: Annotated[float | None, typer.Option(help="Thickness of one ply before the test, mm.")] = None,
    plies: Annotated[float | None, typer.Option(help="Plies of the specimen, 16 if nothing says otherwise.")] = None,
    temperature: Annotated[float | None, TEMPERATURE] = None,
    name: Annotated[str | None, typer.Option(help="Name of the material in the file written.")] = None,
    apart: Annotated[bool, typer.Option("--apart", help="Fit every specimen by itself.")] = False,
    tie: Annotated[str, typer.Option(help=TIE)] = "auto",
    intervals: Annotated[
        str, typer.Option(help="covariance, or profile (slower, right in a curved valley too).")
    ] = "covariance",
    offset: Annotated[bool, typer.Option("--offset", help="Fit a zero error of each thickness sensor too.")] = False,
    like: Annotated[str | None, typer.Option(metavar="MATERIAL", help=LIKE)] = None,
    suggest: Annotated[bool, typer.Option("--suggest", help="Say which next test would narrow the intervals most.")] = False,
    skip_bad_rows: Annotated[bool, typer.Option("--skip-bad-rows", help="Leave faulty rows out, a tenth at most.")] = False,
    unusual: Annotated[bool, typer.Option("--unusual", help="Numbers that no usual test has are meant.")] = False,
    accept_misfit: Annotated[bool, typer.Option("--accept-misfit", help=MISFIT)] = False,
    setting: Settings = None,
    as_json: AsJson = False,
    output: OutputIfAny = None,
) -> None:
    """Fit k, a, b_squeeze and b_bleed to compaction tests and write a material file.

    A file starts with a heading such as "time (s);force (N);thickness (mm)": units as wanted, decimal points or commas,
    columns divided by comma, semicolon, tab or blanks. Lines that start with # are comments; those of the form
    "# width: 15 mm" give layup (or plies per block), width, ply thickness, plies, temperature and material. The options
    say the same for files that do not, and win. Tests of one temperature are fitted together; several temperatures give a
    material with as many columns.

    Exit status 1, and no material file, where the readings leave a parameter open or the law does not follow them.
    """
    from plyflow.identify.judged import judge
    from plyflow.identify.output import doubts, fit_groups, result_files, show, show_suggestions
    from plyflow.identify.report import fit_data
    from plyflow.identify.specimen import Reading, read_specimen
    from plyflow.identify.suggest import suggestion_table, suggestions

    given = {"layup": layup, "width": width, "ply_thickness": ply_thickness, "plies": plies, "temperature": temperature}
    known = {key: value for key, value in given.items() if value is not None}
    settings = parse_settings(setting)
    for place, path in enumerate(data):
        if path.resolve() in [other.resolve() for other in data[:place]]:
            raise InputError(f"{path} is given twice: its readings would count double; leave one out")
    reading = Reading(unusual, skip_bad_rows, like)
    specimens = [read_specimen(path, known, settings, reading) for path in data]
    fits = fit_groups(specimens, apart, tie, intervals, Console(stderr=True), offset)
    doubtful = doubts(fits, tie)
    sound = not doubtful or (accept_misfit and not any(judge(one).open for one in fits))
    proposed = suggestions(fits) if suggest else []
    material = name or next((f"{one.material}, fitted" for one in specimens if one.material), "fitted material")
    contents = result_files(material, fits, apart, sound) if output is not None else {}
    contents |= {"suggestions.csv": suggestion_table(proposed)} if suggest else {}
    written = [] if output is None else write_files(output, contents)
    if as_json:
        found = [fit_data(one) for one in fits]
        found[0] |= {"suggestions": [one.row() for one in proposed]} if suggest else {}
        print(json_text(found[0] if len(found) == 1 else found))
    else:
        show(fits, Console())
        if suggest:
            show_suggestions(proposed, Console())
        print_paths(written)
    for line in doubtful:
        print(f"plyflow: {line}", file=sys.stderr)
    if not sound:
        print(f"plyflow: no material comes of this{'' if suggest else '; --suggest says which next test would help'}", file=sys.stderr)
        raise typer.Exit(NOT_KNOWN)
