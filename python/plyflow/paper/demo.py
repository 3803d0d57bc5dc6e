"""The compaction programme: 84 cases, a table, figures, CSV files and one HTML report."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from plyflow.case.case import Case, all_cases
from plyflow.errors import PlyflowError, RunError
from plyflow.files import require_writable, write_files
from plyflow.paper.demo_report import demo_files, largest_difference, results_table, shown_tables
from plyflow.run.case_run import RunResult, run_case
from plyflow.show.progress import progress
from plyflow.umat.prepare import Umat, prepare_umat

PLAIN_LINES = 7


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
    console.print(*(one.rich() for one in shown_tables(table)), sep="\n")
    for quantity in ("thickness", "width"):
        console.print("largest {} difference to the 1D law: {} ({})".format(quantity, *largest_difference(table, quantity)),
                      highlight=False)  # fmt: skip
    for label, reason in failures.items():
        console.print(f"not finished: {label}: {reason}", style="red", highlight=False, markup=False)
    console.print(f"report: {files[0]}   ({time.perf_counter() - begin:.1f} s in all)", soft_wrap=True)
    if failures:
        raise RunError(f"{len(failures)} of {len(failures) + len(results)} cases did not finish, see {files[0]}")
    return DemoOutcome(results, failures, files)


def run_cases(
    cases: Sequence[Case], umat: Umat, console: Console, folder: Path
) -> tuple[list[RunResult], dict[str, str]]:
    """Results, and reasons by label, of cases run one after the other; a failed increment is kept for `plyflow replay`."""
    results: list[RunResult] = []
    failures: dict[str, str] = {}
    with progress(console, "cases", len(cases), lines=PLAIN_LINES) as advance:
        for number, case in enumerate(cases, start=1):
            try:
                results.append(run_case(case, umat, replay=folder / f"failed-increment-{number}.txt"))
            except PlyflowError as error:
                failures[case.label] = str(error)
            advance(f"last {case.label}")
    return results, failures
