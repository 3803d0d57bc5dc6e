"""Writing results, the one way for all commands: plain data as JSON, tables as CSV, text as it is; all files or none."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from plyflow.errors import OutputError

RECORD = "plyflow-job.json"


def json_text(data: Any) -> str:
    """Plain data as JSON text, without the line end; a number that is not finite is refused."""
    return json.dumps(data, indent=2, allow_nan=False)


def file_text(content: Any) -> str | bytes:
    """Content of a file: text and bytes as they are, a pandas table as CSV, any other data as JSON."""
    if isinstance(content, str | bytes):
        return content
    if hasattr(content, "to_csv"):
        return str(content.to_csv(index=False, lineterminator="\n"))
    return json_text(content) + "\n"


def write_files(folder: Path, contents: Mapping[str, Any]) -> list[Path]:
    """Write files into a folder, made if missing; on failure nothing is left half written.

    Each file is first written under a temporary name beside its place, then all are renamed.

    Parameters
    ----------
    folder : Path
        Where to write.
    contents : mapping
        File name (may hold subfolders) to what it holds, see `file_text`: text, bytes, a table, plain data. What a result was
        made with (`plyflow.provenance`) is part of its data.

    Returns
    -------
    list of Path
        The files written, in the given order.

    Raises
    ------
    OutputError
        The folder cannot be made or written.
    """
    texts = {name: file_text(content) for name, content in contents.items()}
    staged: list[tuple[Path, Path]] = []
    try:
        for name, text in texts.items():
            target = folder / name
            if target.is_dir():
                raise IsADirectoryError(0, f"{target} is a folder")
            target.parent.mkdir(parents=True, exist_ok=True)
            staged.append((_stage(target, text), target))
        for temporary, target in staged:
            os.replace(temporary, target)
    except OSError as error:
        for temporary, _ in staged:
            temporary.unlink(missing_ok=True)
        raise _cannot_write(folder, error) from error
    return [target for _, target in staged]


def replace_files(folder: Path, contents: Mapping[str, Any], made_from: Mapping[str, Any], force: bool = False) -> list[Path]:
    """Write files as `write_files` does, in place of those of an earlier call; nothing of these stays beside the new ones.

    The folder keeps a record of its files and of what they were made from.

    Parameters
    ----------
    folder, contents
        As of `write_files`.
    made_from : mapping
        Plain data that tell one job from another.
    force : bool
        Whether files of another job, or of nobody known, may be replaced.

    Raises
    ------
    OutputError
        The folder holds another job or files of these names that no record knows; or it cannot be written.
    """
    wanted = json.loads(json.dumps(made_from))
    try:
        record = json.loads((folder / RECORD).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        record = {}
    old = [str(name) for name in record.get("files", ())]
    strange = [name for name in contents if (folder / name).exists() and name not in old]
    if not force and (strange or (old and record.get("made_from") != wanted)):
        what = f"has a {strange[0]} of its own" if strange else f"holds another job ({_described(record.get('made_from'))})"
        raise OutputError(f"{folder} {what}: choose another folder with -o, or replace it with --force")
    written = write_files(folder, {**contents, RECORD: {"made_from": wanted, "files": list(contents)}})
    for name in old:
        if name not in contents and Path(name).name == name:
            (folder / name).unlink(missing_ok=True)
    return written


def _described(made_from: Any) -> str:
    entries = made_from.items() if isinstance(made_from, dict) else ()
    return ", ".join(f"{key} {' '.join(map(str, value)) if isinstance(value, list) else value}" for key, value in entries if value)


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
