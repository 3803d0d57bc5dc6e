"""The compaction programme: 84 cases, a table, figures, CSV files and one HTML report."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from plyflow.case.case import Case, all_cases
from plyflow.errors import PlyflowError, RunError
from plyflow.files import require_writable, write_files
from plyflow.paper.demo_figures import all_panels
from plyflow.paper.demo_html import render_report
from plyflow.paper.demo_table import largest_difference, results_table, rich_tables
from plyflow.run.case_run import RunResult, run_case
from plyflow.umat.prepare import Umat, prepare_umat

PLAIN_LINE_EVERY = 12


@dataclass(frozen=True)
class DemoOutcome:
    """Finished cases, reasons of those that did not finish by label, files written."""

    results: list[RunResult]
    failures: dict[str, str]
    files: list[Path]


def run_demo(folder: Path, console: Console, cases: Sequence[Case] | None = None) -> DemoOutcome:
    """Run the programme and write its table, figures and report.

    Parameters
    ----------
    folder : Path
        Where to write; made if missing.
    console : rich.console.Console
        Where progress and table go.
    cases : sequence of Case, optional
        Default the 84 cases.

    Raises
    ------
    PlyflowError
        The folder cannot be written, the compiler is missing, or a case did not finish (after the report
        of the others is written).
    """
    begin = time.perf_counter()
    umat = prepare_umat()
    prepared = time.perf_counter() - begin
    require_writable(folder)
    origin = "unchanged, taken from the cache" if umat.cached else "generated"
    console.print(f"UMAT {origin} and compiled in {prepared:.1f} s")
    results, failures = run_cases(cases if cases is not None else all_cases(), umat, console, folder)
    timing = {
        "generation and compilation": f"{prepared:.1f} s ({origin})",
        "all cases": f"{time.perf_counter() - begin - prepared:.1f} s",
    }
    if not results:
        raise RunError(f"no case finished; the first reason: {next(iter(failures.values()))}")
    table = results_table(results)
    files = write_files(folder, demo_files(results, table, failures, timing))
    _show(table, failures, console)
    console.print(f"report: {files[0]}   ({time.perf_counter() - begin:.1f} s in all)", soft_wrap=True)
    if failures:
        raise RunError(
            f"{len(failures)} of {len(failures) + len(results)} cases did not finish, see {files[0]}"
        )
    return DemoOutcome(results, failures, files)


def run_cases(
    cases: Sequence[Case], umat: Umat, console: Console, folder: Path
) -> tuple[list[RunResult], dict[str, str]]:
    """Run cases one after the other, with a progress bar (plain lines when the output is not a terminal).

    An increment that fails is kept in the folder, for `plyflow replay`.
    """
    results: list[RunResult] = []
    failures: dict[str, str] = {}

    def run_all(advance: Callable[[int, Case], None]) -> None:
        for number, case in enumerate(cases, start=1):
            try:
                results.append(run_case(case, umat, replay=folder / f"failed-increment-{number}.txt"))
            except PlyflowError as error:
                failures[case.label] = str(error)
            advance(number, case)

    if not console.is_terminal:
        run_all(lambda number, case: _plain_line(number, len(cases), case, console))
        return results, failures
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("cases", total=len(cases))
        run_all(lambda number, case: progress.update(task, advance=1, description=case.label))
    return results, failures


def demo_files(
    results: Sequence[RunResult], table: pd.DataFrame, failures: dict[str, str], timing: dict[str, str]
) -> dict[str, str]:
    """Text of every file of the demo by name, the report first."""
    panels = all_panels(results)
    files = {
        "report.html": render_report(results, table, panels, failures, timing),
        "results.csv": table.to_csv(index=False, lineterminator="\n"),
        "histories.csv": _histories(results).to_csv(index=False, lineterminator="\n"),
    }
    return files | {f"figures/{panel.name}.svg": panel.svg for panel in panels}


def _histories(results: Sequence[RunResult]) -> pd.DataFrame:
    tables = []
    for result in results:
        case = result.case
        keys = {
            "material": case.material,
            "temperature": case.temperature,
            "layup": case.layup,
            "width": case.width,
        }
        tables.append(result.history_table().assign(**keys))
    return pd.concat(tables, ignore_index=True)


def _plain_line(number: int, total: int, case: Case, console: Console) -> None:
    if number % PLAIN_LINE_EVERY == 0 or number == total:
        console.print(f"{number}/{total} cases, last {case.label}", highlight=False)


def _show(table: pd.DataFrame, failures: dict[str, str], console: Console) -> None:
    console.print(*rich_tables(table), sep="\n")
    for quantity in ("thickness", "width"):
        value, case = largest_difference(table, quantity)
        console.print(f"largest {quantity} difference to the 1D law: {value:.1e} ({case})", highlight=False)
    for label, reason in failures.items():
        console.print(f"not finished: {label}: {reason}", style="red", highlight=False, markup=False)
