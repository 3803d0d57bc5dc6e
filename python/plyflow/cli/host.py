"""`plyflow laminate`, `abaqus`, `calculix`, `mgis`: the laminate of section 5, what hosts need of a scene, checks in them."""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from typer.core import TyperGroup

from plyflow.cli.shared import (
    LAYUP,
    MATERIAL,
    TEMPERATURE,
    WIDTH,
    AsJson,
    Extrapolate,
    Load,
    Output,
    PlyThickness,
    SceneName,
    Settings,
    parse_settings,
    print_assumptions,
    print_lines,
    print_paths,
    with_ply_thickness,
)
from plyflow.errors import InputError, RunError
from plyflow.files import write_files

ABAQUS, CALCULIX, LAMINATE = Path("plyflow-abaqus"), Path("plyflow-calculix"), Path("plyflow-laminate")
MGIS, CANARY = Path("plyflow-mgis"), Path("plyflow-canary")
calculix = typer.Typer(help="CalculiX as a finite-element host.", no_args_is_help=True, add_completion=False)


class WriteUnlessNamed(TyperGroup):
    """`plyflow mgis SCENE` is `plyflow mgis write SCENE`, `plyflow canary -o DIR` is `plyflow canary write -o DIR`."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Put the command in front of what is none."""
        named = args and (args[0] in self.commands or args[0] in ("--help", "-h"))
        return super().parse_args(ctx, args if named or not args else ["write", *args])


canary = typer.Typer(
    cls=WriteUnlessNamed, help="A UMAT that examines its host; alone it is write.", no_args_is_help=True, add_completion=False
)
mgis = typer.Typer(
    cls=WriteUnlessNamed, help="A scene as a behaviour for MGIS hosts; SCENE alone is write SCENE.", no_args_is_help=True,
    add_completion=False,
)  # fmt: skip
STACK = "Directions in degrees, bottom to top, as [90_4/0_4]_2 or 90,0,90,0 (blocks); default 90 and 0 in turn, 16 plies."


DIRECTIONS = "Fibre directions of the blocks as 0/90/45: their *ORIENTATION lines and sections, in orientation.inc."


def laminate(
    *,
    material: Annotated[str, MATERIAL],
    temperature: Annotated[float, TEMPERATURE],
    layup: Annotated[str, LAYUP],
    stack: Annotated[str | None, typer.Option(help=STACK)] = None,
    width: Annotated[float, WIDTH] = 15.0,
    load: Load = "ramp-dwell",
    cells: Annotated[int, typer.Option(help="Elements along half the width.")] = 8,
    arms: Annotated[float, typer.Option(help="Length of the plies beyond the plates along their fibres, mm.")] = 0.0,
    friction: Annotated[float, typer.Option(help="Coulomb friction of ply and plate.")] = 0.05,
    scene: Annotated[str, typer.Option(help="Scene of the UMAT.")] = "default",
    refine: Annotated[float, typer.Option(min=0.1, help="Shorten every increment by this factor.")] = 1.0,
    setting: Settings = None,
    extrapolate: Extrapolate = False,
    as_json: AsJson = False,
    output: Output = LAMINATE,
) -> None:
    """Press a laminate between rigid plates by finite elements; stopped or killed, the same command goes on."""
    from plyflow.case.case import Case
    from plyflow.case.stack import stack_angles
    from plyflow.hosts.laminate.needs import require_libraries

    require_libraries()
    from plyflow.files import json_text, require_writable
    from plyflow.hosts.laminate.equilibrium import Equilibrium
    from plyflow.hosts.laminate.result import result_files, summary
    from plyflow.hosts.laminate.run import LaminateRun
    from plyflow.hosts.laminate.specimen import Specimen
    from plyflow.show.progress import progress
    from plyflow.umat.prepare import prepare_umat

    case = Case(material, temperature, layup, width, load, parse_settings(setting), extrapolate)
    specimen = Specimen(case, stack_angles(stack, layup), cells, arms)
    model = Equilibrium(specimen, prepare_umat(scene), friction)
    require_writable(output)
    run = LaminateRun(model, output, refine)
    total, done = round(case.load_programme.end), [round(run.state.time)]
    with progress(Console(stderr=True), "s of the load", total, done=done[0], lines=0 if as_json else 10) as advance:

        def tell(time: float, increment: int, locked: float) -> None:
            advance(f"increment {increment}, {100.0 * locked:.0f} % locked", round(time) - done[0])
            done[0] = round(time)

        try:
            run.finish(tell)
        finally:  # what is reached is worth as much as a result
            written = write_files(output, result_files(run)) if run.course.increments else []
    found = summary(run)
    if as_json:
        print(json_text(found))
        return
    _show_laminate(found)
    print_paths(written)


def _show_laminate(found: dict[str, Any]) -> None:
    """Print the result of a laminate beside the one-dimensional law."""
    from plyflow.show.table import Column, Table

    rows: list[Any] = [
        (f"{one} ratio, final", found[f"{one}_ratio_final"], found[f"{one}_ratio_1d"]) for one in ("thickness", "width")
    ]
    rows += [(f"width ratio of block {i + 1}", ratio, None) for i, ratio in enumerate(found["width_ratio_of_blocks"])]
    rows += [("first lock, s", found["lock_time"], found["lock_time_1d"]), ("last lock, s", found["lock_time_last"], None)]
    title = f"{found['material']} {found['temperature']:g} degC {found['layup']} {found['width']:g} mm {found['load']}"
    columns = (Column(""), Column("laminate", ".6g"), Column("1D law", ".6g"))
    Console().print(Table(columns, rows, title).rich())
    counts = ", ".join(f"{found[name]} {name.replace('_', ' ')}" for name in ("increments", "iterations", "cutbacks"))
    print_lines(Console(), [f"{counts}, {found['degrees_of_freedom']} degrees of freedom, {found['cpu_s']:.1f} s of CPU"])
    print_assumptions(Console(), found["assumptions"])


def abaqus(
    scene: SceneName = "default",
    *,
    material: Annotated[str, MATERIAL],
    temperature: Annotated[float, TEMPERATURE] = 70.0,
    layup: Annotated[str, LAYUP] = "BP",
    width: Annotated[float, WIDTH] = 15.0,
    ply_thickness: PlyThickness = None,
    stack: Annotated[str | None, typer.Option(help=DIRECTIONS)] = None,
    angle: Annotated[float | None, typer.Option(help="The same for one direction, in degrees from axis 1.")] = None,
    setting: Settings = None,
    extrapolate: Extrapolate = False,
    also: Annotated[
        list[str] | None,
        typer.Option("--also", metavar="SCENE", help="Put this scene and the first into one source, together.for."),
    ] = None,
    aba_param: Annotated[
        bool, typer.Option("--aba-param", help="Begin UMAT with INCLUDE 'ABA_PARAM.INC', for sites that ask for it.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace another job in the folder.")] = False,
    output: Output = ABAQUS,
) -> None:
    """Write source, decks (C3D8, C3D8R, C3D8H, CPE4, CAX4, a laminate) and a README; print their paths."""
    from plyflow.case.case import Case
    from plyflow.case.stack import stack_angles
    from plyflow.files import replace_files
    from plyflow.hosts.abaqus.package import abaqus_files

    if not math.isfinite(temperature):
        raise InputError(f"--temperature {temperature:g}: give a finite number in degC, for example --temperature 70")
    if stack is not None and angle is not None:
        raise InputError("--stack and --angle exclude each other: an angle is a stack of one direction; give one of them")
    settings = with_ply_thickness(parse_settings(setting), ply_thickness, layup)
    case = Case(material, temperature, layup, width, "ramp-dwell", settings, extrapolate)
    angles = stack_angles(stack, layup) if stack is not None else (angle or 0.0,)
    files = abaqus_files(scene, case, also or (), aba_param=aba_param, angles=angles)
    made_from = {"scene": [scene, *(also or ())], "case": case.specimen, "directions": angles, "set": settings}
    print_paths(replace_files(output, files, made_from, force))


@calculix.command()
def build(jobs: Annotated[int, typer.Option(help="Processes of the compilation.")] = 2) -> None:
    """Build CalculiX with external materials from the system's source package; print where it is."""
    from plyflow.hosts.calculix.build import ensure_ccx

    messages = Console(stderr=True)
    print(ensure_ccx(lambda line: messages.print(line, highlight=False), jobs))


@calculix.command()
def write(scene: SceneName = "bdf1", output: Output = CALCULIX) -> None:
    """Write the sources of a scene's face, with the command that compiles them and the name of the material."""
    from plyflow.hosts.calculix.faces import face_files

    print_paths(write_files(output, face_files(scene)))


@calculix.command()
def check(scene: SceneName = "bdf1", output: Output = CALCULIX) -> None:
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


@mgis.command("write")
def mgis_write(scene: SceneName = "default", output: Output = MGIS) -> None:
    """Write the shared library of a scene's behaviour and its sources; print their paths."""
    from plyflow.hosts.mgis.behaviour import behaviour_of, compiled

    behaviour = behaviour_of(scene)
    library = {behaviour.library: compiled(behaviour).read_bytes()}
    print_paths(write_files(output, library | dict(behaviour.files)))


@mgis.command("check")
def mgis_check(
    scene: SceneName = "default",
    full: Annotated[bool, typer.Option("--full", help="Also meshes up to 8x8x4 and held blocks: some minutes.")] = False,
    as_json: AsJson = False,
    output: Output = MGIS,
) -> None:
    """Run blocks of a scene in OpenGeoSys and in the driver; exit status 2 if one of them misses its mark."""
    from plyflow.files import json_text
    from plyflow.hosts.mgis.checks import FULL, KEY, QUICK, check_scene, made_with, table
    from plyflow.show.progress import progress

    rows, total = [], len(FULL if full else QUICK)
    with progress(Console(stderr=True), "blocks", total, lines=0 if as_json else total) as advance:
        for row in check_scene(scene, output, full):
            rows.append(row)
            advance(row.job)
    if as_json:
        print(json_text(made_with(scene) | {"blocks": [asdict(row) for row in rows]}))
    else:
        Console().print(table(scene, rows).rich())
        print_lines(Console(), [KEY, *(f"{name}: {value}" for name, value in made_with(scene).items())])
    failed = [f"{row.job}: {row.remark}" for row in rows if row.remark]
    if failed:
        raise RunError("; ".join(failed))


@canary.command("write")
def canary_write(output: Output = CANARY) -> None:
    """Write the canary for Abaqus, CalculiX's Abaqus door and MGIS hosts; print the paths."""
    from plyflow.hosts.canary.files import canary_files

    print_paths(write_files(output, canary_files()))


@canary.command("check")
def canary_check(output: Output = CANARY) -> None:
    """Run the canary in the driver, CalculiX and OpenGeoSys: what it says, iterations with each rate of DDSDDE."""
    from plyflow.hosts.canary.trials import HOSTS, RUNS, table, trials
    from plyflow.show.progress import progress

    found = []
    with progress(Console(stderr=True), "runs", RUNS, lines=len(HOSTS)) as advance:
        for trial in trials(output):
            found.append(trial)
            advance(trial.host)
    Console().print(table(found).rich())
