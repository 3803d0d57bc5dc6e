"""`plyflow doctor`: which compilers and hosts are here, what each gives, and how to get those that are missing."""

from __future__ import annotations

import shutil
import subprocess
import textwrap
from collections.abc import Callable
from dataclasses import asdict, dataclass

import typer
from rich.console import Console

from plyflow.cli.shared import AsJson, print_lines
from plyflow.errors import PlyflowError
from plyflow.files import json_text

NEEDED_MISSING = 1
SHORTEST_LINE = 30


@dataclass(frozen=True)
class Finding:
    """One tool: its version or place, None if missing; what it gives; how to get it; whether nothing goes without."""

    name: str
    found: str | None
    gives: str
    remedy: str
    needed: bool


def doctor(as_json: AsJson = False) -> None:
    """Say what was found; exit status 1 if something needed is missing."""
    findings = examine()
    lost = [finding.name for finding in findings if finding.needed and not finding.found]
    if as_json:
        print(json_text([asdict(finding) for finding in findings]))
    else:
        console = Console()
        margin = max(len(finding.name) for finding in findings) + len("yes  ") + 2
        for finding in findings:
            mark = "yes" if finding.found else ("NO" if finding.needed else "no")
            first, *others = _lines(finding, max(console.width - margin, SHORTEST_LINE))
            print_lines(console, [f"{mark:<5}{finding.name}".ljust(margin) + first, *(" " * margin + line for line in others)])
        print_lines(console, [f"nothing runs without: {', '.join(lost)}" if lost else "needed by plyflow itself: all here"])
    if lost:
        raise typer.Exit(NEEDED_MISSING)


def _lines(finding: Finding, width: int) -> list[str]:
    """What was found, whole, so that its path can be copied; what it gives and how to get it, wrapped."""
    found = [finding.found] if finding.found else textwrap.wrap(f"missing: {finding.remedy}", width)
    return found + textwrap.wrap(f"gives {finding.gives}", width)


def examine() -> list[Finding]:
    """Look for every tool; none is run beyond asking its version."""
    from plyflow.diagnose.compilers import find_flang
    from plyflow.hosts.calculix.build import find_ccx
    from plyflow.hosts.mgis.opengeosys import PIP, find_ogs
    from plyflow.umat.compile import compiler, compiler_version

    flang = find_flang()
    looked: list[tuple[str, str | None, str, str, bool]] = [
        ("gfortran", _attempt(lambda: f"{compiler()}: {compiler_version()}"),
         "compiled UMATs: run, demo, audit, drive, the libraries for CalculiX",
         "apt-get install gfortran, or name one in FC", True),
        ("driver", _attempt(_driver),
         "material-point runs from Python: run, demo, drive",
         "install plyflow with pip, which compiles it", True),
        ("LLVM flang", None if flang is None else f"{flang}{_version(str(flang))}",
         "the emitted source under a second compiler, to the same numbers: part of ./run test",
         "apt-get install flang-19 (about 90 MB)", False),
        ("CalculiX", _attempt(lambda: str(find_ccx() or "")),
         "finite-element runs with contact and friction, without a licence: calculix check, part of ./run test",
         "plyflow calculix build (Debian or Ubuntu, some minutes, once), or set PLYFLOW_CCX to a ccx with external materials",
         False),
        ("OpenGeoSys", _attempt(lambda: str(find_ogs() or "")),
         "finite-element runs of MGIS behaviours: mgis check, part of ./run test",
         PIP, False),
        ("apt-get", shutil.which("apt-get"),
         "the automatic build of CalculiX",
         "build CalculiX by hand with CALCULIX_EXTERNAL_BEHAVIOURS_SUPPORT and set PLYFLOW_CCX", False),
        ("valgrind", _first("valgrind"),
         "counted instructions of a call: scenes --measure, bench",
         "apt-get install valgrind", False),
        ("Abaqus", _first("abaqus", "abq"),
         "runs of what 'plyflow abaqus' writes; writing and checking it does not need Abaqus",
         "a licensed installation that has a Fortran compiler set up; plyflow itself does not need it", False),
    ]  # fmt: skip
    return [Finding(*entry) for entry in looked]


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


def _first(*names: str) -> str | None:
    """Path and version of the first program of some names."""
    path = next(filter(None, map(shutil.which, names)), None)
    return path and f"{path}{_version(path)}"


def _version(path: str) -> str:
    try:
        answer = subprocess.run([path, "--version"], capture_output=True, text=True, check=False, timeout=20)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    lines = answer.stdout.splitlines()
    return f": {lines[0].strip()}" if lines and answer.returncode == 0 else ""
