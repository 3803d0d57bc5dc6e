"""One run of the stability matrix from the command line: progress, files, verdict."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console

from plyflow.errors import RunError
from plyflow.evidence.stability.matrix import Matrix, all_tasks, run_matrix
from plyflow.evidence.stability.report import claims_table, failures, groups_table, to_html, to_json
from plyflow.evidence.stability.subject import Subject
from plyflow.files import require_writable, write_files
from plyflow.show.progress import progress

PLAIN_LINE_EVERY = 100


def run_stability(folder: Path, console: Console, json_file: Path | None = None, quick: bool = False) -> Matrix:
    """Run the matrix and write its table as HTML and JSON.

    Parameters
    ----------
    folder : Path
        Where to write stability.html and stability.json; made if missing.
    console : rich.console.Console
        Where progress and tables go.
    json_file : Path, optional
        A further place for the JSON.
    quick : bool
        The reduced matrix.

    Raises
    ------
    PlyflowError
        A folder cannot be written, the compiler is missing, or cells fail (after the report is written).
    """
    require_writable(folder)
    if json_file is not None:
        require_writable(json_file.parent)
    subject = Subject(quick)
    subject.scene()
    tasks = all_tasks(subject)
    with progress(console, "cells", len(tasks), lines=max(len(tasks) // PLAIN_LINE_EVERY, 1)) as advance:
        matrix = run_matrix(subject, tasks, advance)
    written = write_files(folder, {"stability.html": to_html(matrix), "stability.json": to_json(matrix)})
    if json_file is not None:
        written += write_files(json_file.parent, {json_file.name: to_json(matrix)})
    console.print(claims_table(matrix).rich(), groups_table(matrix).rich(), sep="\n")
    for line in failures(matrix):
        console.print(f"fails: {line}", style="red", highlight=False, markup=False)
    console.print(f"{len(matrix.cells)} cells in {matrix.seconds:.0f} s", highlight=False)
    for path in written:
        console.print(str(path), soft_wrap=True, highlight=False)
    if matrix.failing:
        raise RunError(f"{len(matrix.failing)} of {len(matrix.cells)} cells fail, see {written[0]}")
    return matrix
