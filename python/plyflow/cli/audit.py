"""`plyflow audit`: from the printed page to the machine code."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from plyflow.errors import InputError, OutputError, RunError
from plyflow.files import require_writable, write_files

STANDARD_OUTPUT = Path("-")


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="audit")(audit)


def audit(
    scene: Annotated[
        str, typer.Option(help="Scene whose compiled blocks are compared, or a file NAME.toml.")
    ] = "default",
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the entries as JSON; - for standard output.")
    ] = None,
    html: Annotated[Path | None, typer.Option(metavar="FILE", help="Write a page with typeset mathematics.")] = None,
) -> None:
    """Compare each relation of the paper with what follows from its premises, and with the compiled UMAT."""
    from plyflow.audit.report import run_audit  # loads the derivations, which the other commands do not need
    from plyflow.audit.shown import page, show

    quiet = json_file == STANDARD_OUTPUT
    files = {"--json": None if quiet else json_file, "--html": html}
    wanted = {option: path for option, path in files.items() if path is not None}
    _require_places(wanted)
    with _progress() as seen:
        result = run_audit(scene, seen)
    entries = json.dumps(result.entries(), indent=2, ensure_ascii=False) + "\n"
    if quiet:
        print(entries, end="")
    else:
        show(result, Console())
    texts = {"--json": lambda: entries, "--html": lambda: page(result).html()}
    write_files(Path.cwd(), {str(path.absolute()): texts[option]() for option, path in wanted.items()})
    if not quiet:
        for path in wanted.values():
            print(path)
    if not result.agrees:
        raise RunError("the compiled code does not agree with the audited equations: see the lines that say DIFFERS")


def _require_places(files: dict[str, Path]) -> None:
    """See that every file can be written, before the work begins.

    Raises
    ------
    InputError
        Two options name the same file.
    OutputError
        A file cannot be written.
    """
    options: dict[Path, str] = {}
    for option, path in files.items():
        place = path.resolve()
        if place in options:
            raise InputError(f"{options[place]} and {option} name the same file {path}; give each its own")
        options[place] = option
        if path.is_dir():
            raise OutputError(f"{path} is a folder; give {option} the name of a file")
        try:
            require_writable(path.parent)
        except OutputError as error:
            reason = str(error).partition(";")[0]
            raise OutputError(f"{reason}; give {option} a file in a folder that can be written") from error


@contextmanager
def _progress() -> Iterator[Callable[[str], None]]:
    """A bar on standard error while the audit runs, where that is a terminal; the caller says what is done."""
    from umataudit import PAPER

    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("generating, compiling", total=len(PAPER) + 1)
        yield lambda what: progress.update(task, advance=1, description=f"done: {what}")
