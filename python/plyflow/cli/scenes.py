"""`plyflow scenes` and `plyflow explain`: what the scenes are, what each leaves out and why it could go."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from plyflow.umat.scenes import find_scene


def register(app: typer.Typer) -> None:
    """Add the commands to the application."""
    app.command(name="scenes")(scenes)
    app.command(name="explain")(explain)


def scenes(
    measure: Annotated[
        bool, typer.Option("--measure", help="Also instructions and time of a call, measured here (about a minute).")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
) -> None:
    """List the shipped scenes with the size of each."""
    from plyflow.umat.sizes import scene_table

    frame = _measured(Console(stderr=True)) if measure else scene_table()
    if as_json:
        rows = frame.astype(object).where(frame.notna(), None).to_dict(orient="records")
        print(json.dumps({"scenes": rows, **_session()} if measure else rows, indent=2))
        return
    console = Console()
    _show(frame, console)
    if measure:
        for name, value in _session().items():
            console.print(f"{name}: {value}", highlight=False)
    console.print("plyflow explain SCENE says, piece by piece, what a scene leaves out and why.")


def _show(frame: Any, console: Console) -> None:
    """Sizes, with the measured columns, and operations, each in a table that fits 80 columns."""
    passes = [name for name in frame.columns if name.startswith(("operations", "after "))]
    sizes = [name for name in frame.columns if name not in passes]
    headings = {"operations, raw": "as derived", "operations": "in the source", "pieces left out": "left out"}
    for title, columns in (("Shipped scenes", sizes), ("Operations", ["scene", *passes])):
        table = Table(title=title)
        for number, column in enumerate(columns):
            table.add_column(headings.get(column, column), justify="right" if number else "left", no_wrap=number == 0)
        for row in frame[columns].itertuples(index=False):
            table.add_row(*(_cell(name, value) for name, value in zip(columns, row, strict=True)))
        console.print(table)


def _cell(column: str, value: Any) -> str:
    if column == "instructions":
        return "-" if value is None or value != value else f"{value:.0f}"  # noqa: PLR0124 - not a number
    return f"{value:.2f}" if column in ("time / default", "spread") else str(value)


def _measured(console: Console) -> Any:
    from plyflow.evidence.bench.scene_costs import STEPS, measured_table
    from plyflow.show.progress import progress

    with progress(console, "measured", STEPS, transient=True) as advance:
        return measured_table(advance)


def _session() -> dict[str, str]:
    """What the measured columns were taken with."""
    from plyflow.evidence.bench.instructions import FLAGS
    from plyflow.evidence.bench.machine import machine
    from plyflow.evidence.bench.scene_costs import note

    here = machine()
    return {
        "measured": note(),
        "machine": f"{here['processor']}, {here['cores']} cores, {here['system']}",
        "compiler": f"{here['compiler']}, {' '.join(FLAGS)}, umat/benchmark/calls.f90",
    }


def explain(scene: Annotated[str, typer.Argument(help="Shipped scene or file NAME.toml.")]) -> None:
    """Say, piece by piece, what a scene leaves out against the default one and why it could go."""
    from umatgen.explain import explain as left_out

    found = left_out(find_scene(scene))
    console = Console()
    if not found:
        console.print(f"{scene}: leaves nothing out of the default scene")
        return
    table = Table(title=f"{scene}: left out against the default scene")
    for column in ("kind", "piece", "why it could go"):
        table.add_column(column)
    for item in found:
        table.add_row(item.kind, item.name, item.reason)
    console.print(table)
