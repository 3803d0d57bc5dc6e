"""`plyflow demo`, `figures`, `stability`, `bench`: the standing reports, each into a folder of its own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from plyflow.cli.shared import AsJson, JsonFile, Output, Settings, parse_settings, print_paths
from plyflow.errors import InputError, ToolError
from plyflow.files import json_text

ONLY = "2a, 2b, 6a, 6b, 7, 8, 9, 10 or 11; several with commas (6a,7) or the option repeated."
LAMINATE = "Draw Figs. 8 to 11 from this table of plyflow sweep --model laminate (its folder will do) and judge by it."
MEASURED = "CSV of measured points: material, temperature, layup, width [mm], and thickness_mm or width_ratio, after the test."
DEMO, FIGURES, STABILITY, BENCH = (Path(f"plyflow-{name}") for name in ("demo", "figures", "stability", "bench"))


def demo(output: Output = DEMO) -> None:
    """Generate, compile and run the 84 cases; end with a table, figures and one HTML report."""
    from plyflow.paper.demo import run_demo

    run_demo(output, Console())


def figures(
    *,
    output: Output = FIGURES,
    only: Annotated[list[str] | None, typer.Option(help=ONLY)] = None,
    with_map: Annotated[bool, typer.Option("--map/--no-map", help="Judge over gamma_lock and l0/d too.")] = True,
    setting: Settings = None,
    laminate: Annotated[Path | None, typer.Option(metavar="FILE", help=LAMINATE)] = None,
    measured: Annotated[Path | None, typer.Option(metavar="FILE", help=MEASURED)] = None,
    as_json: AsJson = False,
) -> None:
    """Draw Figs. 2a, 2b, 6a, 6b, 7 to 11 from the model and judge the paper's claims."""
    from plyflow.paper.laminates import FIGURES as OF_LAMINATES
    from plyflow.paper.laminates import read_laminates
    from plyflow.paper.run import claims_table, make_report, report_steps, write_report
    from plyflow.show.progress import progress

    console = Console(quiet=as_json)
    settings, chosen = parse_settings(setting), split_numbers(only or [])
    if measured is not None and laminate is None:
        raise InputError(f"--measured {measured}: the points stand beside laminates; give their table with --laminate")
    laminates = None if laminate is None else read_laminates(laminate, measured)
    steps = report_steps(chosen, with_map) if laminates is None else len(chosen or OF_LAMINATES)
    with progress(console, "figures", steps + 1, transient=True) as advance:
        report = make_report(settings, chosen, with_map, advance, laminates)
        written = write_report(report, output)
    if as_json:
        print(json_text(report.claims().to_dict("records")))
        return
    if report.findings:
        console.print(claims_table(report).rich())
    if laminates is not None and laminates.missing:
        console.print(f"claims not judged: {laminates.missing} of the 56 cases of section 5 are not in {laminate}", highlight=False)
    print_paths(written)


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


def stability(
    json_file: JsonFile = None,
    output: Output = STABILITY,
    quick: Annotated[bool, typer.Option("--quick", help="A reduced matrix.")] = False,
) -> None:
    """Run the stability matrix; ends with tables as HTML and JSON."""
    from plyflow.evidence.stability.run import run_stability

    run_stability(output, Console(), json_file, quick)


def bench(
    output: Output = BENCH,
    quick: Annotated[bool, typer.Option("--quick", help="Three programmes, few repeats: under a minute of processor time.")] = False,
    json_file: JsonFile = None,
    repeats: Annotated[int | None, typer.Option(help="Runs of each combination, in turns (at least 3).")] = None,
) -> None:
    """Measure error against run time for scenes, tangents, integrators, step controls and peers, all in one session."""
    try:
        from plyflow.evidence.bench.run import run_bench
    except ModuleNotFoundError as error:
        if error.name != "tensortrax":
            raise
        needed = "tensortrax is not installed, which a peer of the bench needs"
        raise ToolError(f"{needed}; install it with: pip install 'plyflow[bench]'") from error
    run_bench(output, Console(), quick=quick, json_file=json_file, repeats=repeats)
