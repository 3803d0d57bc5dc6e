"""Instructions and time of one call: the benchmark program of umat/benchmark, counted by callgrind and timed in turns."""

from __future__ import annotations

import functools
import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from plyflow.errors import ToolError
from plyflow.evidence.bench.spread import Spread, spread_of
from plyflow.provenance import source_hash
from plyflow.show.progress import Advance
from plyflow.umat.compile import compiler, support_source

FLAGS = ("-O2",)
TEMPERATURE = 70  # degC, a whole number
COUNTED = (500, 1500)
TIMED_CALLS = 100_000


def valgrind() -> str | None:
    """Path of valgrind, None where it is not installed."""
    return shutil.which("valgrind")


@dataclass(frozen=True)
class Program:
    """One built benchmark: executable, its arguments after the number of calls, and what it reads."""

    executable: Path
    arguments: tuple[str, ...]
    constants: str

    def run(self, calls: int, *tool: str) -> subprocess.CompletedProcess[str]:
        """Let it call the UMAT so many times, under a tool if one is given."""
        return _run([*tool, str(self.executable), str(calls), *self.arguments], self.constants)


def build(folder: Path, source: str, manifest: Mapping[str, Any], suffix: str = ".f") -> Program:
    """Build the benchmark of one UMAT source in a folder, with the default values of its PROPS; `suffix` tells the form.

    Raises
    ------
    ToolError
        The compiler is missing or refuses a source.
    """
    scene, locked = manifest["scene"], [s["index"] for s in manifest["statev"] if s["name"] == "locked"]
    fibre = "1" if scene["fibre"] == "free" else scene["fibre"]
    stages = {"both": 0, "squeeze": 1, "bleed": 2}[scene["regimes"]]
    counts = [len(manifest["props"]), len(manifest["statev"]), *(locked or [0]), manifest["ntens"]]
    constants = " ".join(repr(p["default"]) for p in manifest["props"]) + "\n"
    return Program(_compile(folder, source, suffix), (*map(str, counts), fibre, str(stages), str(TEMPERATURE)), constants)


@functools.cache
def _compile(folder: Path, source: str, suffix: str) -> Path:
    text = folder / f"umat_{source_hash(source)[:16]}{suffix}"
    text.write_text(source)
    parts = [support_source("abaqus_standins.f90"), support_source("benchmark/calls.f90"), text]
    _run([compiler(), *FLAGS, "-fopenmp", f"-J{folder}", *map(str, parts), "-o", str(text.with_suffix(""))])
    return text.with_suffix("")


def instructions_per_call(program: Program) -> float | None:
    """Instructions of one call, those of the same loop around a UMAT that does nothing subtracted; None without valgrind.

    Raises
    ------
    ToolError
        The UMAT refuses the benchmark's states, or callgrind gives no count.
    """
    if valgrind() is None:
        return None
    nothing = _compile(program.executable.parent, support_source("benchmark/empty.f").read_text(), ".f")
    return _slope(program) - _slope(replace(program, executable=nothing))


def seconds_per_call(
    programs: Mapping[str, Program], repeats: int, advance: Advance, calls: int = TIMED_CALLS
) -> dict[str, list[float]]:
    """Processor time of one call in s, `repeats` times for each program, in turns so that a slow moment hits all alike."""
    found: dict[str, list[float]] = {name: [] for name in programs}
    for _ in range(repeats):
        for name, program in programs.items():
            found[name].append(float(program.run(calls).stdout.split()[-1]))
            advance(name)
    return found


def relative_to(times: Mapping[str, Sequence[float]], base: str) -> dict[str, Spread]:
    """Each program's time over that of `base` in the same turn."""
    return {name: spread_of(a / b for a, b in zip(mine, times[base], strict=True)) for name, mine in times.items()}


@functools.cache
def _slope(program: Program) -> float:
    few, many = (_count(program, number) for number in COUNTED)
    return (many - few) / (COUNTED[1] - COUNTED[0])


def _count(program: Program, calls: int) -> int:
    answer = program.run(calls, str(valgrind()), "--tool=callgrind", "--callgrind-out-file=/dev/null")
    found = re.search(r"Collected : (\d+)", answer.stderr)
    if found is None:
        raise ToolError(f"callgrind gave no count: {answer.stderr.strip()[-200:]}")
    return int(found.group(1))


def _run(command: Sequence[str], text: str = "") -> subprocess.CompletedProcess[str]:
    answer = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    if answer.returncode != 0:
        said = " ".join((answer.stdout + answer.stderr).split())
        raise ToolError(f"{Path(command[0]).name} failed: {said[:400]}")
    return answer
