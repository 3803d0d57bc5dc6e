"""`plyflow abaqus`, `calculix`: what finite-element hosts need of a scene, and checks in the one that is free."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from plyflow.cli.shared import (
    LAYUP,
    MATERIAL,
    TEMPERATURE,
    WIDTH,
    Extrapolate,
    Output,
    SceneName,
    Settings,
    parse_settings,
    print_lines,
    print_paths,
)
from plyflow.errors import InputError, RunError
from plyflow.files import write_files

ABAQUS, CALCULIX = Path("plyflow-abaqus"), Path("plyflow-calculix")
calculix = typer.Typer(help="CalculiX as a finite-element host.", no_args_is_help=True, add_completion=False)


def abaqus(
    scene: SceneName = "default",
    *,
    material: Annotated[str, MATERIAL],
    temperature: Annotated[float, TEMPERATURE] = 70.0,
    layup: Annotated[str, LAYUP] = "BP",
    width: Annotated[float, WIDTH] = 15.0,
    setting: Settings = None,
    extrapolate: Extrapolate = False,
    also: Annotated[
        list[str] | None,
        typer.Option("--also", metavar="SCENE", help="Put this scene and the first into one source, together.for."),
    ] = None,
    aba_param: Annotated[
        bool, typer.Option("--aba-param", help="Begin UMAT with INCLUDE 'ABA_PARAM.INC', for sites that ask for it.")
    ] = False,
    output: Output = ABAQUS,
) -> None:
    """Write source, decks (C3D8, C3D8R, C3D8H, CPE4, CAX4, a laminate) and a README; print their paths."""
    from plyflow.case.case import Case
    from plyflow.hosts.abaqus.package import abaqus_files

    if not math.isfinite(temperature):
        raise InputError(f"--temperature {temperature:g}: give a finite number in degC, for example --temperature 70")
    case = Case(material, temperature, layup, width, "ramp-dwell", parse_settings(setting), extrapolate)
    print_paths(write_files(output, abaqus_files(scene, case, also or (), aba_param=aba_param)))


@calculix.command()
def build(jobs: Annotated[int, typer.Option(help="Processes of the compilation.")] = 2) -> None:
    """Build CalculiX with external materials from the system's source package; print where it is."""
    from plyflow.hosts.calculix.build import ensure_ccx

    messages = Console(stderr=True)
    print(ensure_ccx(lambda line: messages.print(line, highlight=False), jobs))


@calculix.command()
def write(scene: SceneName = "default", output: Output = CALCULIX) -> None:
    """Write the sources of a scene's face, with the command that compiles them and the name of the material."""
    from plyflow.hosts.calculix.faces import face_files

    print_paths(write_files(output, face_files(scene)))


@calculix.command()
def check(scene: SceneName = "default", output: Output = CALCULIX) -> None:
    """Run a scene's jobs in CalculiX and in the driver; exit status 2 if one of them misses its mark."""
    from plyflow.hosts.calculix.build import require_ccx
    from plyflow.hosts.calculix.checks import check_scene
    from plyflow.provenance import package_version
    from plyflow.show.table import Column, Table
    from plyflow.umat.compile import compiler_version

    made_with = (
        f"plyflow {package_version()}, {compiler_version()}, {require_ccx()}; constants: the scene's defaults, "
        "with kappa = 100 MPa in twist, bend and laminate"
    )
    rows, failed = [], []
    for row in check_scene(scene, output):
        print_lines(Console(stderr=True), [f"{row.job}: {'done' if row.passed else 'missed its mark'}"])
        rows.append((row.job, row.iterations, row.cutbacks, row.difference, row.remark))
        if not row.passed:
            failed.append(f"{row.job}: {row.remark}")
    numbers = (Column("iterations", "d"), Column("cutbacks", "d"), Column("difference", ".1e"))
    Console().print(Table(["job", *numbers, Column("remark", wrap=True)], rows, f"{scene} in CalculiX").rich())
    print_lines(Console(), [made_with])
    if failed:
        raise RunError("; ".join(failed))
