"""`plyflow doctor`: which compilers and hosts are here, what each gives, and how to get those that are missing."""

from __future__ import annotations

import json
import shutil
import subprocess
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Annotated

import typer
from rich.console import Console

from plyflow.errors import PlyflowError

ABAQUS = ("abaqus", "abq")
NEEDED_MISSING = 1
SHORTEST_LINE = 30


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command(name="doctor")(doctor)


def doctor(
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON array and nothing else.")] = False,
) -> None:
    """Say what was found; exit status 1 if something needed is missing."""
    findings = examine()
    if as_json:
        print(json.dumps([finding.as_dict() for finding in findings], indent=2))
    else:
        _print(findings)
    if any(finding.needed and not finding.found for finding in findings):
        raise typer.Exit(NEEDED_MISSING)


def _print(findings: Sequence[Finding]) -> None:
    console = Console()
    margin = max(len(finding.name) for finding in findings) + len("yes  ") + 2
    for finding in findings:
        mark = "yes" if finding.found else ("NO" if finding.needed else "no")
        first, *others = _lines(finding, max(console.width - margin, SHORTEST_LINE))
        _say(console, f"{mark:<5}{finding.name}".ljust(margin) + first)
        for line in others:
            _say(console, " " * margin + line)
    lost = [finding.name for finding in findings if finding.needed and not finding.found]
    _say(console, f"nothing runs without: {', '.join(lost)}" if lost else "needed by plyflow itself: all here")


def _lines(finding: Finding, width: int) -> list[str]:
    """What was found, whole, so that its path can be copied; what it gives and how to get it, wrapped."""
    found = [finding.found] if finding.found else textwrap.wrap(f"missing: {finding.remedy}", width)
    return found + textwrap.wrap(f"gives {finding.gives}", width)


def _say(console: Console, line: str) -> None:
    console.print(line, highlight=False, markup=False, soft_wrap=True)


@dataclass(frozen=True)
class Finding:
    """One tool: its version or place, None if missing; what it gives; how to get it; whether nothing goes without."""

    name: str
    found: str | None
    gives: str
    remedy: str
    needed: bool

    def as_dict(self) -> dict[str, object]:
        """Plain data."""
        return asdict(self)


def examine() -> list[Finding]:
    """Look for every tool; none is run beyond asking its version."""
    from plyflow.hosts.calculix.build import find_ccx
    from plyflow.umat.compile import compiler, compiler_version

    return [
        Finding(
            "gfortran",
            _attempt(lambda: f"{compiler()}: {compiler_version()}"),
            "compiled UMATs: run, demo, audit, drive, the libraries for CalculiX",
            "apt-get install gfortran, or name one in FC",
            True,
        ),
        Finding(
            "driver",
            _attempt(_driver),
            "material-point runs from Python: run, demo, drive",
            "install plyflow with pip, which compiles it",
            True,
        ),
        Finding(
            "LLVM flang",
            _flang(),
            "the emitted source under a second compiler, to the same numbers: part of ./run test",
            "apt-get install flang-19 (about 90 MB)",
            False,
        ),
        Finding(
            "CalculiX",
            _attempt(lambda: str(find_ccx() or "")),
            "finite-element runs with contact and friction, without a licence: calculix check, part of ./run test",
            "plyflow calculix build (Debian or Ubuntu, some minutes, once), or set PLYFLOW_CCX to a ccx with external "
            "materials",
            False,
        ),
        Finding(
            "apt-get",
            shutil.which("apt-get"),
            "the automatic build of CalculiX",
            "build CalculiX by hand with CALCULIX_EXTERNAL_BEHAVIOURS_SUPPORT and set PLYFLOW_CCX",
            False,
        ),
        Finding(
            "valgrind",
            _first(("valgrind",)),
            "counted instructions of a call: scenes --measure, bench",
            "apt-get install valgrind",
            False,
        ),
        Finding(
            "Abaqus",
            _first(ABAQUS),
            "runs of what 'plyflow abaqus' writes; writing and checking it does not need Abaqus",
            "a licensed installation that has a Fortran compiler set up; plyflow itself does not need it",
            False,
        ),
    ]


def _attempt(look: Callable[[], str]) -> str | None:
    """What `look` finds, None if it finds nothing or says why not."""
    try:
        return look() or None
    except PlyflowError:
        return None


def _driver() -> str:
    try:
        from plyflow.driver_library import driver_binding
    except ImportError:
        return ""
    return str(driver_binding.__name__)


def _flang() -> str | None:
    from plyflow.diagnose.compilers import find_flang

    path = find_flang()
    return None if path is None else f"{path}{_version(str(path))}"


def _first(names: tuple[str, ...]) -> str | None:
    """Path and version of the first program of some names."""
    for name in names:
        path = shutil.which(name)
        if path:
            return f"{path}{_version(path)}"
    return None


def _version(path: str) -> str:
    try:
        answer = subprocess.run([path, "--version"], capture_output=True, text=True, check=False, timeout=20)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    lines = answer.stdout.splitlines()
    return f": {lines[0].strip()}" if lines and answer.returncode == 0 else ""
