"""Instructions and time of one call: the benchmark program of umat/benchmark, counted by callgrind and timed in turns."""

from __future__ import annotations

import functools
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from plyflow.errors import ToolError
from plyflow.evidence.bench.spread import Spread, spread_of
from plyflow.show.progress import Advance
from plyflow.umat.compile import compiler, support_source

FLAGS = ("-O2",)
FIXED = ("-ffixed-form", "-std=legacy")
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


class Workshop:
    """A folder in which benchmark programs are built; see `workshop`."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._built = folder, 0
        standins, calls = support_source("abaqus_standins.f90"), support_source("benchmark/calls.f90")
        self._common = [self._object(standins, "-fopenmp", "-std=f2018"), self._object(calls, "-std=f2018")]
        self._empty = self._link(support_source("benchmark/empty.f"))

    def program(self, source: str, manifest: Mapping[str, Any], flags: Sequence[str] = FIXED) -> Program:
        """Build the benchmark of one UMAT source, with the default values of its PROPS."""
        scene, locked = manifest["scene"], [s["index"] for s in manifest["statev"] if s["name"] == "locked"]
        fibre = "1" if scene["fibre"] == "free" else scene["fibre"]
        stages = {"both": 0, "squeeze": 1, "bleed": 2}[scene["regimes"]]
        counts = [len(manifest["props"]), len(manifest["statev"]), *(locked or [0]), manifest["ntens"]]
        constants = " ".join(repr(p["default"]) for p in manifest["props"]) + "\n"
        text = self._folder / f"umat_{self._built}.f"
        text.write_text(source)
        return Program(self._link(text, *flags), (*map(str, counts), fibre, str(stages), str(TEMPERATURE)), constants)

    def empty(self, like: Program) -> Program:
        """The same loop around a UMAT that does nothing."""
        return replace(like, executable=self._empty)

    def _object(self, source: Path, *flags: str) -> str:
        self._built += 1
        target = str(self._folder / f"{source.stem}_{self._built}.o")
        _run([compiler(), *FLAGS, *flags, f"-J{self._folder}", "-c", str(source), "-o", target])
        return target

    def _link(self, source: Path, *flags: str) -> Path:
        part = self._object(source, *flags)
        target = Path(part).with_suffix("")
        _run([compiler(), *self._common, part, "-fopenmp", "-o", str(target)])
        return target


@contextmanager
def workshop() -> Iterator[Workshop]:
    """A workshop in a temporary folder.

    Raises
    ------
    ToolError
        The compiler is missing or refuses a source.
    """
    with tempfile.TemporaryDirectory() as folder:
        yield Workshop(Path(folder))


def instructions_per_call(program: Program, empty: Program) -> float | None:
    """Instructions of one call with the empty loop subtracted; None without valgrind.

    Raises
    ------
    ToolError
        The UMAT refuses the benchmark's states, or callgrind gives no count.
    """
    return None if valgrind() is None else _slope(program) - _slope(empty)


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


@functools.lru_cache
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
