"""`plyflow scenes` and `plyflow explain`: what the scenes are, what each leaves out and why it could go."""

from __future__ import annotations

import json
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from plyflow.scenes import find_scene, scene_table
from umatgen.pipeline import explain as explain_scene


def register(app: typer.Typer) -> None:
    """Add the commands to the application."""
    app.command(name="scenes")(scenes)
    app.command(name="explain")(explain)


def scenes(as_json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False) -> None:
    """List the shipped scenes with the size of each."""
    frame = scene_table()
    if as_json:
        print(json.dumps(frame.to_dict(orient="records"), indent=2))
        return
    table = Table(title="Shipped scenes")
    for number, column in enumerate(frame.columns):
        table.add_column(column, justify="right" if number else "left")
    for row in frame.itertuples(index=False):
        table.add_row(*map(str, row))
    console = Console()
    console.print(table)
    console.print("plyflow explain SCENE says, piece by piece, what a scene leaves out and why.")


def explain(scene: Annotated[str, typer.Argument(help="Shipped scene or file NAME.toml.")]) -> None:
    """Say, piece by piece, what a scene leaves out against the default one and why it could go."""
    found = explain_scene(find_scene(scene))
    console = Console()
    if not found:
        console.print(f"{scene}: leaves nothing out")
        return
    table = Table(title=f"{scene}: left out against the default scene")
    for column in ("kind", "piece", "why it could go"):
        table.add_column(column)
    for item in found:
        table.add_row(item.kind, item.name, item.reason)
    console.print(table)
