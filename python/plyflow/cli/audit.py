"""`plyflow audit`: from the printed page to the machine code."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from plyflow.errors import RunError
from plyflow.files import write_files

STANDARD_OUTPUT = Path("-")


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="audit")(audit)


def audit(
    scene: Annotated[str, typer.Option(help="Scene whose compiled blocks are compared.")] = "default",
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the entries as JSON; - for standard output.")
    ] = None,
    html: Annotated[Path | None, typer.Option(metavar="FILE", help="Write a page with typeset mathematics.")] = None,
    markdown: Annotated[Path | None, typer.Option(metavar="FILE", help="Write Markdown.")] = None,
) -> None:
    """Compare each relation of the paper with what follows from its premises, and with the compiled UMAT."""
    from plyflow.audit.html import render_html  # loads the derivations, which the other commands do not need
    from plyflow.audit.markdown import render_markdown
    from plyflow.audit.report import run_audit
    from plyflow.audit.terminal import show

    result = run_audit(scene)
    entries = json.dumps([row.as_dict() for row in result.rows], indent=2, ensure_ascii=False) + "\n"
    quiet = json_file == STANDARD_OUTPUT
    if quiet:
        print(entries, end="")
    else:
        show(result, Console())
    wanted: list[tuple[Path | None, Callable[[], str]]] = [
        (None if quiet else json_file, lambda: entries),
        (html, lambda: render_html(result)),
        (markdown, lambda: render_markdown(result)),
    ]
    for path, render in wanted:
        if path is not None:
            write_files(path.parent, {path.name: render()})
            if not quiet:
                print(path)
    if not result.agrees:
        raise RunError("the compiled code does not agree with the audited equations: see the lines that say DIFFERS")
