"""`plyflow audit`, `drive`: from the printed page to the machine code; anybody's UMAT examined."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from plyflow.cli.shared import AsJson, print_lines, print_paths
from plyflow.errors import InputError, OutputError, RunError
from plyflow.files import require_writable, write_files

STANDARD_OUTPUT = Path("-")
SOMETHING_BAD = 1
BUILT_IN = "for the built-in programmes; default what NAME.json beside the source says."


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
    from plyflow.audit.report import run_audit
    from plyflow.audit.shown import page, show
    from plyflow.show.progress import progress
    from umataudit import PAPER

    quiet = json_file == STANDARD_OUTPUT
    files = {"--json": None if quiet else json_file, "--html": html}
    wanted = {option: path for option, path in files.items() if path is not None}
    _require_places(wanted)
    with progress(Console(stderr=True), "audit", len(PAPER) + 1, transient=True) as advance:
        result = run_audit(scene, lambda what: advance(f"done: {what}"))
    entries = json.dumps(result.entries(), indent=2, ensure_ascii=False) + "\n"
    if quiet:
        print(entries, end="")
    else:
        show(result, Console())
    texts = {"--json": lambda: entries, "--html": lambda: page(result).html()}
    write_files(Path.cwd(), {str(path.absolute()): texts[option]() for option, path in wanted.items()})
    if not quiet:
        print_paths(wanted.values())
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


def drive(
    umat: Annotated[Path, typer.Argument(metavar="SOURCE_OR_LIBRARY", help="Fortran source or shared library.")],
    case: Annotated[
        str, typer.Argument(metavar="CASE", help="Case file, or uniaxial, shear, volumetric, general, rotation.")
    ],
    *,
    props: Annotated[str, typer.Option(help=f"Constants, separated by commas; {BUILT_IN}")] = "",
    n_statev: Annotated[int | None, typer.Option(help=f"State variables; {BUILT_IN}")] = None,
    temperature: Annotated[float, typer.Option(help="Temperature in degC; for the built-in programmes.")] = 0.0,
    as_json: AsJson = False,
    html: Annotated[Path | None, typer.Option(metavar="FILE", help="Write a page with the verdicts.")] = None,
) -> None:
    """Drive a UMAT and examine it: DDSDDE and what hosts take for granted; exit status 1 if something is bad.

    Constants and the number of state variables that are not given are those of the manifest NAME.json beside the source.
    """
    from plyflow.diagnose.case import programme, read_case, with_manifest
    from plyflow.diagnose.check import diagnose
    from plyflow.diagnose.examine import examine
    from plyflow.diagnose.library import find_manifest, load_umat
    from plyflow.diagnose.report import made_with, numbers, page, report_data, report_lines, verdict_data, verdict_table

    _require_places({} if html is None else {"--html": html})
    chosen = read_case(Path(case)) if Path(case).is_file() else programme(case, numbers(props), n_statev, temperature)
    if (beside := find_manifest(umat)) is not None:
        chosen = with_manifest(chosen, beside[1], str(beside[0]))
    library = load_umat(umat)
    diagnosis = diagnose(library, chosen)
    verdicts = examine(library, chosen, diagnosis)
    inputs = {"umat": str(umat), "case": case, "props": chosen.setting("props"), "temperature": temperature}
    inputs |= {"manifest": None if beside is None else str(beside[0])} | made_with(umat)
    if html is not None:
        write_files(Path.cwd(), {str(html.absolute()): page(umat.name, diagnosis, verdicts, inputs).html()})
    if as_json:
        print(json.dumps(inputs | report_data(diagnosis) | {"verdicts": verdict_data(verdicts)}, indent=2))
    else:
        print_lines(Console(), report_lines(diagnosis))
        Console().print(verdict_table(verdicts).rich())
        print_paths([] if html is None else [html])
    if any(verdict.outcome == "bad" for verdict in verdicts):
        raise typer.Exit(SOMETHING_BAD)
