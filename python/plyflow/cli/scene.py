"""`plyflow generate`, `scenes`, `explain`, `material`: sources of scenes, what each leaves out, materials to edit."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from plyflow.cli.shared import AsJson, Output, SceneName, print_paths
from plyflow.files import json_text, write_files

CURRENT_FOLDER = Path(".")
ENDINGS = {"fixed": "for", "free": "f90"}
FORM = "fixed: plain fixed form, valid with 72 and with 132 columns (NAME.for); free: free form (NAME.f90)."
HEADINGS = {"operations, raw": "as derived", "operations": "in the source", "pieces left out": "left out"}
FORMATS = {"instructions": ".0f", "time / default": ".2f", "spread": ".2f"}


def generate(
    scene: SceneName = "default",
    form: Annotated[str | None, typer.Option(help=FORM)] = None,
    output: Output = CURRENT_FOLDER,
) -> None:
    """Write the UMAT of a scene (NAME.for) and its manifest (NAME.json); print both paths."""
    from plyflow.umat.prepare import generate_scene

    source, manifest, _ = generate_scene(scene, form)
    name = manifest["name"]
    print_paths(write_files(output, {f"{name}.{ENDINGS[str(manifest['scene']['form'])]}": source, f"{name}.json": manifest}))


def scenes(
    measure: Annotated[
        bool, typer.Option("--measure", help="Also instructions and time of a call, measured here (about a minute).")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """List the shipped scenes with the size of each."""
    from plyflow.umat.sizes import scene_table

    frame = _measured(Console(stderr=True)) if measure else scene_table()
    session = _session() if measure else {}
    if as_json:
        rows = frame.astype(object).where(frame.notna(), None).to_dict(orient="records")
        print(json_text({"scenes": rows, **session} if measure else rows))
        return
    console = Console()
    _show(frame, console)
    for name, value in session.items():
        console.print(f"{name}: {value}", highlight=False)
    console.print("plyflow explain SCENE says, piece by piece, what a scene leaves out and why.")


def _show(frame: Any, console: Console) -> None:
    """Sizes, with the measured columns, and operations, each in a table that fits 80 columns."""
    from plyflow.show.table import Column, Table

    def column(name: str) -> Column:
        return Column(HEADINGS.get(name, name), FORMATS.get(name, "" if name == "scene" else "d"), key=name)

    passes = [name for name in frame.columns if name.startswith(("operations", "after "))]
    sizes = [name for name in frame.columns if name not in passes]
    rows = frame.astype(object).where(frame.notna(), "-").to_dict(orient="records")
    for title, names in (("Shipped scenes", sizes), ("Operations", ["scene", *passes])):
        console.print(Table([column(name) for name in names], rows, title).rich())


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


def explain(scene: SceneName) -> None:
    """Say, piece by piece, what a scene leaves out against the default one and why it could go."""
    from plyflow.show.table import Column, Table
    from plyflow.umat.scenes import find_scene
    from umatgen.explain import explain as left_out

    rows = [(item.kind, item.name, item.reason) for item in left_out(find_scene(scene))]
    if not rows:
        Console().print(f"{scene}: leaves nothing out of the default scene")
        return
    columns = [Column(heading, wrap=True) for heading in ("kind", "piece", "why it could go")]
    Console().print(Table(columns, rows, f"{scene}: left out against the default scene").rich())


def material(
    name: Annotated[str, typer.Argument(metavar="NAME", help="IM7-8552, IMA-M21 or a material file NAME.toml.")],
    output: Annotated[Path | None, typer.Option("-o", "--output", metavar="FILE", help="File to write, NAME.toml.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if there is one.")] = False,
) -> None:
    """Print a shipped material, or write it to a file to edit."""
    from plyflow.case.materials import material_text
    from plyflow.errors import InputError, OutputError

    text = material_text(name)
    if output is None:
        print(text, end="")
        return
    if output.suffix.lower() != ".toml":
        raise InputError(f"-o {output}: a material file is called NAME.toml; that ending tells it from a shipped name")
    if output.exists() and not force:
        raise OutputError(f"{output} is there already: choose another name, or replace it with --force")
    print_paths(write_files(output.parent, {output.name: text}))
