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
    completed : whether CalculiX reached the end.
    tables : printed tables by (quantity, set); see `read_tables`.
    increments : see `read_increments`.
    """

    completed: bool
    tables: dict[tuple[str, str], Table]
    increments: pd.DataFrame

    @property
    def most_iterations(self) -> int:
        """Largest number of iterations of an increment that was accepted."""
        return max(self.increments["iterations"][~self.increments["failed"]], default=0)

    @property
    def cutbacks(self) -> int:
        """Attempts that failed."""
        return int(self.increments["failed"].sum())


def run_job(
    name: str, deck: str, faces: Iterable[Face], folder: Path, *, timeout: float = 600.0, must_finish: bool = True
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
    timeout
        In s; a longer run is stopped.
    must_finish
        Whether it is an error when CalculiX gives up; else see `JobResult.completed`.

    Raises
    ------
    ToolError
        There is no CalculiX with external materials.
    RunError
        It did not start or not finish; the message quotes its errors and names the log.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.inp").write_text(deck, encoding="ascii")
    for suffix in ("dat", "sta"):
        (folder / f"{name}.{suffix}").unlink(missing_ok=True)
    for face in faces:
        face.put_into(folder)
    log = _execute(name, folder, timeout)
    lines = [line.strip() for line in log.splitlines() if line.strip()]
    errors = tuple(line for line in lines if line.startswith("*ERROR"))
    completed = "Job finished" in log and not errors
    if not (folder / f"{name}.sta").is_file():
        raise RunError(f"CalculiX job {name} did not start: {' | '.join(errors or lines[-_LAST_LINES:])}")
    if must_finish and not completed:
        said = " | ".join(errors) or "no message"
        raise RunError(f"CalculiX job {name} did not finish: {said}; its log is {folder / name}.log")
    return JobResult(completed, read_tables(folder / f"{name}.dat"), read_increments(folder / f"{name}.sta"))


def _execute(name: str, folder: Path, timeout: float) -> str:
    paths = filter(None, (str(folder.resolve()), os.environ.get("LD_LIBRARY_PATH")))
    environment = os.environ | {
        "OMP_NUM_THREADS": "1", "CCX_NPROC_STIFFNESS": "1", "LD_LIBRARY_PATH": os.pathsep.join(paths),
    }  # fmt: skip
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
