"""Repeating the one increment that an analysis failed in, from the file it left behind."""

from __future__ import annotations

import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from plyflow.diagnose.library import load_umat
from plyflow.driver.drive import DriverError, History, run_case_file
from plyflow.errors import InputError
from plyflow.umat.prepare import prepare_umat
from umatgen.scene import SCENES

_LIBRARY = re.compile(r"^(\s*library\s*=\s*)([^!\n]*?)(\s*(?:!.*)?)$", re.MULTILINE)


@dataclass(frozen=True)
class Replay:
    """The repeated increment.

    why: what the file says of its origin; library: the UMAT called; history: of the one increment.
    """

    why: str
    library: Path
    history: History

    def lines(self) -> list[str]:
        """Report, a line each: origin, UMAT, start, attempts, outcome and what the UMAT said."""
        history = self.history
        return [
            self.why,
            f"UMAT {self.library}",
            f"start at total time {history.time[0]:.6g} s with F11, F22, F33 = {_stretches(history, 0)}",
            *(
                f"attempt {row['attempt']}: {row['increment_size']:.6g} s, {row['iterations']} iterations: {row['note']}"
                for row in history.increment_table.to_dict("records")
            ),
            f"it goes through here: F11, F22, F33 = {_stretches(history, -1)} at its end"
            if history.completed
            else f"it fails again: {history.message}",
            *history.warnings.splitlines(),
        ]


def replay_file(path: Path, umat: str | None = None) -> Replay:
    """Run a replay file.

    Parameters
    ----------
    path : Path
        The file, as `plyflow run` and the driver leave it.
    umat : str, optional
        What to call in place of the one that failed: a scene (with the same constants), a Fortran source or a library.

    Raises
    ------
    InputError
        The file or its UMAT is not there, or it is not a case file.
    """
    if not path.is_file():
        raise InputError(f"{path} is no file; give the replay file that the failed run named")
    text = path.read_text(encoding="utf-8", errors="replace")
    named = _LIBRARY.search(text)
    if named is None:
        raise InputError(f"{path} has no line 'library = ...'; give a replay file or a case file of the driver")
    library = _chosen(umat) if umat is not None else _beside(path, Path(named.group(2).strip()))
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "replay.txt"
        copy.write_text(_LIBRARY.sub(lambda found: f"{found.group(1)}{library}", text, count=1), encoding="utf-8")
        try:
            history = run_case_file(copy)
        except DriverError as error:
            raise InputError(str(error).replace(str(copy), str(path))) from error
    first = text.lstrip().splitlines()[0]
    return Replay(first.lstrip("! ") if first.startswith("!") else f"Case {path}", Path(library), history)


def _chosen(umat: str) -> Path:
    """Library of a scene by name or of a file NAME.toml, of a source, or the library itself."""
    if umat in SCENES or umat.endswith(".toml"):
        return prepare_umat(umat).library.path
    return load_umat(Path(umat)).path


def _beside(path: Path, library: Path) -> Path:
    """The library a case names, found from where we are or from where the case is; else the source kept beside the case."""
    for place in (library, path.parent / library):
        if place.is_file():
            return place.resolve()
    for source in (path.with_suffix(ending) for ending in (".for", ".f90")):
        if source.is_file():
            return load_umat(source).path
    raise InputError(f"{path} names the UMAT {library}, which is not there; name another with --umat: a scene, a source or a library")


def _stretches(history: History, row: int) -> str:
    return ", ".join(f"{x:.9g}" for x in np.diag(history.deformation_gradient[row]))
