"""`plyflow calculix`: build CalculiX with external materials, write a scene's face for it, check it in it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from plyflow.errors import RunError

FOLDER = Path("plyflow-calculix")
calculix = typer.Typer(help="CalculiX as a finite-element host.", no_args_is_help=True)


def register(app: typer.Typer) -> None:
    """Add the group of commands to the application."""
    app.add_typer(calculix, name="calculix")


@calculix.command()
def build(jobs: Annotated[int, typer.Option(help="Processes of the compilation.")] = 2) -> None:
    """Build CalculiX with external materials from the system's source package; print where it is."""
    from plyflow.hosts.calculix.build import ensure_ccx

    messages = Console(stderr=True)
    print(ensure_ccx(lambda line: messages.print(line, highlight=False), jobs))


@calculix.command()
def write(
    scene: Annotated[str, typer.Argument(help="Name of the scene.")] = "default",
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder of the sources.")] = FOLDER,
) -> None:
    """Write the sources of a scene's face, with the command that compiles them and the name of the material."""
    from plyflow.files import write_files
    from plyflow.hosts.calculix.faces import face_files

    for path in write_files(output, face_files(scene)):
        print(path)


@calculix.command()
def check(
    scene: Annotated[str, typer.Argument(help="Name of the scene.")] = "default",
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder of the jobs.")] = FOLDER,
) -> None:
    """Run a scene's jobs in CalculiX and in the driver; exit status 2 if one of them misses its mark."""
    from plyflow.hosts.calculix.build import require_ccx
    from plyflow.hosts.calculix.checks import check_scene
    from plyflow.provenance import package_version
    from plyflow.umat.compile import compiler_version

    made_with = (
        f"plyflow {package_version()}, {compiler_version()}, {require_ccx()}; constants: the scene's defaults, "
        "with kappa = 100 MPa in twist, bend and laminate"
    )
    table = Table(title=f"{scene} in CalculiX", caption=escape(made_with))
    for heading in ("job", "iterations", "cutbacks", "difference", "remark"):
        table.add_column(heading, justify="left" if heading in ("job", "remark") else "right")
    failed = []
    messages = Console(stderr=True)
    for row in check_scene(scene, output):
        messages.print(f"{row.job}: {'done' if row.passed else 'missed its mark'}", highlight=False)
        difference = "" if row.difference is None else f"{row.difference:.1e}"
        table.add_row(row.job, str(row.iterations), str(row.cutbacks), difference, row.remark)
        if not row.passed:
            failed.append(f"{row.job}: {row.remark}")
    Console().print(table)
    if failed:
        raise RunError("; ".join(failed))
