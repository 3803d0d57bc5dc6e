"""Instructions and time of one call: the benchmark program of umat/benchmark, counted by callgrind and timed in turns."""

from __future__ import annotations

import functools
import re
import shutil
import statistics
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from plyflow.errors import ToolError
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


class Workshop:
    """A temporary folder in which benchmark programs are built; use it in a `with` block.

    Raises
    ------
    ToolError
        The compiler is missing or refuses a source.
    """

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory()
        self.path = Path(self._folder.name)
        self._built = 0
        self._empties: dict[tuple[str, ...], Program] = {}
        self._common = [
            self._object(support_source("abaqus_standins.f90"), "-fopenmp", "-std=f2018"),
            self._object(support_source("benchmark/calls.f90"), "-std=f2018"),
        ]

    def __enter__(self) -> Workshop:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._folder.cleanup()

    def program(self, source: str, manifest: Mapping[str, Any], flags: Sequence[str] = ("-ffixed-form", "-std=legacy")) -> Program:
        """Build the benchmark of one UMAT source, with the default values of its PROPS."""
        scene, locked = manifest["scene"], [s["index"] for s in manifest["statev"] if s["name"] == "locked"]
        fibre = "1" if scene["fibre"] == "free" else scene["fibre"]
        stages = {"both": 0, "squeeze": 1, "bleed": 2}[scene["regimes"]]
        counts = [len(manifest["props"]), len(manifest["statev"]), locked[0] if locked else 0, manifest["ntens"]]
        constants = " ".join(repr(p["default"]) for p in manifest["props"]) + "\n"
        text = self.path / f"umat_{self._built}.f"
        text.write_text(source)
        return Program(self._link(self._object(text, *flags)), (*map(str, counts), fibre, str(stages), str(TEMPERATURE)), constants)

    def empty(self, like: Program) -> Program:
        """The same loop around a UMAT that does nothing; one for all programs with the same arguments."""
        if like.arguments not in self._empties:
            target = self._link(self._object(support_source("benchmark/empty.f")))
            self._empties[like.arguments] = Program(target, like.arguments, like.constants)
        return self._empties[like.arguments]

    def _object(self, source: Path, *flags: str) -> str:
        self._built += 1
        target = str(self.path / f"{source.stem}_{self._built}.o")
        _run([compiler(), *FLAGS, *flags, f"-J{self.path}", "-c", str(source), "-o", target])
        return target

    def _link(self, part: str) -> Path:
        self._built += 1
        target = self.path / f"calls_{self._built}"
        _run([compiler(), *self._common, part, "-fopenmp", "-o", str(target)])
        return target


def instructions_per_call(program: Program, empty: Program) -> float | None:
    """Instructions of one call with the empty loop subtracted; None without valgrind.

    Raises
    ------
    ToolError
        The UMAT refuses the benchmark's states, or callgrind gives no count.
    """
    if valgrind() is None:
        return None
    return _slope(program) - _slope(empty)


def seconds_per_call(
    programs: Mapping[str, Program], repeats: int, advance: Callable[[], None] = lambda: None, calls: int = TIMED_CALLS
) -> dict[str, list[float]]:
    """Seconds of one call, `repeats` times for each program, in turns so that a slow moment hits all alike."""
    found: dict[str, list[float]] = {name: [] for name in programs}
    for _ in range(repeats):
        for name, program in programs.items():
            found[name].append(float(_start(program, calls).split()[-1]))
            advance()
    return found


def relative_to(times: Mapping[str, Sequence[float]], base: str) -> dict[str, tuple[float, float]]:
    """Median and half the interquartile range of each program's time over that of `base` in the same turn."""
    found = {}
    for name, mine in times.items():
        ratios = sorted(a / b for a, b in zip(mine, times[base], strict=True))
        quarter = len(ratios) // 4
        found[name] = (statistics.median(ratios), (ratios[-1 - quarter] - ratios[quarter]) / 2)
    return found


@functools.lru_cache
def _slope(program: Program) -> float:
    few, many = (_count(program, number) for number in COUNTED)
    return (many - few) / (COUNTED[1] - COUNTED[0])


def _count(program: Program, calls: int) -> int:
    tool = [str(valgrind()), "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    answer = _run([*tool, str(program.executable), str(calls), *program.arguments], program.constants)
    found = re.search(r"Collected : (\d+)", answer.stderr)
    if found is None:
        raise ToolError(f"callgrind gave no count: {answer.stderr.strip()[-200:]}")
    return int(found.group(1))


def _start(program: Program, calls: int) -> str:
    return _run([str(program.executable), str(calls), *program.arguments], program.constants).stdout


def _run(command: Sequence[str], text: str = "") -> subprocess.CompletedProcess[str]:
    answer = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    if answer.returncode != 0:
        said = " ".join((answer.stdout + answer.stderr).split())
        raise ToolError(f"{Path(command[0]).name} failed: {said[:400]}")
    return answer
