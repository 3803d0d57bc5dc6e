"""Writing results: all files of one call, or none."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from plyflow.errors import OutputError


def write_files(folder: Path, contents: Mapping[str, str] | Mapping[str, str | bytes]) -> list[Path]:
    """Write files into a folder, made if missing; on failure nothing is left half written.

    Each file is first written under a temporary name beside its place, then all are renamed.

    Parameters
    ----------
    folder : Path
        Where to write.
    contents : mapping
        File name (may hold subfolders) to text or bytes.

    Returns
    -------
    list of Path
        The files written, in the given order.

    Raises
    ------
    OutputError
        The folder cannot be made or written.
    """
    staged: list[tuple[Path, Path]] = []
    try:
        for name, content in contents.items():
            target = folder / name
            if target.is_dir():
                raise IsADirectoryError(0, f"{target} is a folder")
            target.parent.mkdir(parents=True, exist_ok=True)
            staged.append((_stage(target, content), target))
        for temporary, target in staged:
            os.replace(temporary, target)
    except OSError as error:
        for temporary, _ in staged:
            temporary.unlink(missing_ok=True)
        raise _cannot_write(folder, error) from error
    return [target for _, target in staged]


def require_writable(folder: Path) -> None:
    """Make a folder if it is missing and see that a file can be written into it.

    Raises
    ------
    OutputError
        It cannot be made or written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        _stage(folder / "probe", "").unlink()
    except OSError as error:
        raise _cannot_write(folder, error) from error


def _cannot_write(folder: Path, error: OSError) -> OutputError:
    in_the_way = next((place for place in (folder, *folder.parents) if place.is_file()), None)
    reason = f"{in_the_way} is a file, not a folder" if in_the_way else error.strerror or str(error)
    return OutputError(f"cannot write into {folder}: {reason}; choose another place")


def _stage(target: Path, content: str | bytes) -> Path:
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content.encode("utf-8") if isinstance(content, str) else content)
        temporary.chmod(0o666 & ~_umask())
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    return temporary


def _umask() -> int:
    current = os.umask(0)
    os.umask(current)
    return current
