"""One CalculiX job: a deck and its libraries in a folder, run, and what came out."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from plyflow.errors import RunError, ToolError
from plyflow.hosts.calculix.build import require_ccx
from plyflow.hosts.calculix.faces import Face
from plyflow.hosts.calculix.output import Table, read_increments, read_tables

_LAST_LINES = 6


@dataclass(frozen=True)
class JobResult:
    """What a job left.

    Parameters
    ----------
    name, folder : of the job's files.
    completed : whether CalculiX reached the end.
    tables : printed tables by (quantity, set); see `read_tables`.
    increments : see `read_increments`.
    errors : its error messages.
    """

    name: str
    folder: Path
    completed: bool
    tables: dict[tuple[str, str], Table]
    increments: pd.DataFrame
    errors: tuple[str, ...]

    @property
    def most_iterations(self) -> int:
        """Largest number of iterations of an increment that was accepted."""
        return max(self.increments["iterations"][~self.increments["failed"]], default=0)

    @property
    def most_iterations_later(self) -> int:
        """`most_iterations` without the first increment of each step."""
        later = ~self.increments["failed"] & (self.increments["increment"] > 1)
        return max(self.increments["iterations"][later], default=0)

    @property
    def cutbacks(self) -> int:
        """Attempts that failed."""
        return int(self.increments["failed"].sum())


def run_job(
    name: str, deck: str, faces: Iterable[Face], folder: Path, *, threads: int = 1, timeout: float = 600.0
) -> JobResult:
    """Write NAME.inp and the libraries into a folder and run CalculiX on it.

    Parameters
    ----------
    name
        Of the job and its files.
    deck
        Text of the input file.
    faces
        Materials from outside that the deck names.
    folder
        Made if missing.
    threads
        OMP_NUM_THREADS.
    timeout
        In s; a longer run is stopped.

    Raises
    ------
    ToolError
        There is no CalculiX with external materials.
    RunError
        It did not finish; the message quotes its errors and names the log.
    """
    result = try_job(name, deck, faces, folder, threads=threads, timeout=timeout)
    if not result.completed:
        said = " | ".join(result.errors) or "no message"
        raise RunError(f"CalculiX job {name} did not finish: {said}; its log is {folder / name}.log")
    return result


def try_job(
    name: str, deck: str, faces: Iterable[Face], folder: Path, *, threads: int = 1, timeout: float = 600.0
) -> JobResult:
    """`run_job` without the error when CalculiX gives up: see `JobResult.completed`."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.inp").write_text(deck, encoding="ascii")
    for suffix in ("dat", "sta"):
        (folder / f"{name}.{suffix}").unlink(missing_ok=True)
    for face in faces:
        face.put_into(folder)
    log = _execute(name, folder, threads, timeout)
    errors = _errors(log)
    completed = "Job finished" in log and not errors
    if not (folder / f"{name}.sta").is_file():
        raise RunError(f"CalculiX job {name} did not start: {' | '.join(errors) or _tail(log)}")
    return JobResult(
        name,
        folder,
        completed,
        read_tables(folder / f"{name}.dat"),
        read_increments(folder / f"{name}.sta"),
        errors,
    )


def _execute(name: str, folder: Path, threads: int, timeout: float) -> str:
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads), "CCX_NPROC_STIFFNESS": str(threads)}
    environment["LD_LIBRARY_PATH"] = os.pathsep.join(
        text for text in (str(folder.resolve()), os.environ.get("LD_LIBRARY_PATH", "")) if text
    )
    log = folder / f"{name}.log"
    try:
        with log.open("w") as stream:
            subprocess.run(
                [str(require_ccx()), "-i", name],
                cwd=folder,
                env=environment,
                stdout=stream,
                stderr=subprocess.STDOUT,
                timeout=timeout,
                check=False,
            )
    except subprocess.TimeoutExpired as error:
        raise RunError(f"CalculiX job {name} took more than {timeout:g} s and was stopped; its log is {log}") from error
    except OSError as error:
        raise ToolError(f"CalculiX could not be started: {error.strerror}") from error
    return log.read_text(errors="replace")


def _errors(log: str) -> tuple[str, ...]:
    return tuple(line.strip() for line in log.splitlines() if line.lstrip().startswith("*ERROR"))


def _tail(log: str) -> str:
    lines = [line.strip() for line in log.splitlines() if line.strip()]
    return " | ".join(lines[-_LAST_LINES:])
