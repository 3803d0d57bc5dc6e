"""One run of the stability matrix from the command line: progress, files, verdict."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from plyflow.errors import RunError
from plyflow.evidence.stability.bench import Bench
from plyflow.evidence.stability.cells import Task, Verdict
from plyflow.evidence.stability.matrix import Matrix, run_matrix
from plyflow.evidence.stability.report import messages, rows_by_group, terminal_tables, to_html, to_json, to_markdown
from plyflow.files import require_writable, write_files

PLAIN_LINE_EVERY = 100


def run_stability(folder: Path, console: Console, json_file: Path | None = None, quick: bool = False) -> Matrix:
    """Run the matrix and write its table as Markdown, HTML and JSON.

    Parameters
    ----------
    folder : Path
        Where to write stability.html, stability.md and stability.json; made if missing.
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
    bench = Bench(quick)
    bench.scene()
    matrix = _with_progress(bench, console)
    written = write_files(
        folder,
        {"stability.html": to_html(matrix), "stability.md": to_markdown(matrix), "stability.json": to_json(matrix)},
    )
    if json_file is not None:
        written += write_files(json_file.parent, {json_file.name: to_json(matrix)})
    _show(matrix, written, console)
    if matrix.failing:
        raise RunError(f"{len(matrix.failing)} of {len(matrix.cells)} cells fail, see {written[0]}")
    return matrix


def _with_progress(bench: Bench, console: Console) -> Matrix:
    """Show a bar, or plain lines where the output is not a terminal."""
    if not console.is_terminal:
        return run_matrix(bench, lambda number, total, task: _plain_line(number, total, task, console))
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console) as progress:
        bar = progress.add_task("cells", total=None)
        return run_matrix(
            bench,
            lambda number, total, task: progress.update(
                bar, completed=number, total=total, description=task.check.group[:40].ljust(40)
            ),
        )


def _plain_line(number: int, total: int, task: Task, console: Console) -> None:
    if number % PLAIN_LINE_EVERY == 0 or number == total:
        console.print(f"{number}/{total} cells, last {task.check.group}", highlight=False)


def _show(matrix: Matrix, written: list[Path], console: Console) -> None:
    console.print(*terminal_tables(matrix), sep="\n")
    for group, rows in rows_by_group(matrix).items():
        for message, count in messages(rows, Verdict.FAILS):
            line = f"fails: {group}, {count} cell{'s' if count > 1 else ''}: {message}"
            console.print(line, style="red", highlight=False, markup=False)
    console.print(f"{len(matrix.cells)} cells in {matrix.seconds:.0f} s", highlight=False)
    for path in written:
        console.print(str(path), soft_wrap=True, highlight=False)
