"""Writing texts and images of one call: all or none."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from plyflow.errors import OutputError
from plyflow.files import require_writable


def write_all(folder: Path, texts: Mapping[str, str], images: Mapping[str, bytes]) -> list[Path]:
    """Write into a folder, made if missing: first into a hidden folder within it, then each renamed into place.

    Raises
    ------
    OutputError
        The folder cannot be made or written.
    """
    require_writable(folder)
    contents = {name: text.encode("utf-8") for name, text in texts.items()} | dict(images)
    staged = Path(tempfile.mkdtemp(dir=folder, prefix=".figures-"))
    try:
        for name, content in contents.items():
            if (folder / name).is_dir():
                raise IsADirectoryError(0, f"{folder / name} is a folder")
            (staged / name).write_bytes(content)
        for name in contents:
            os.replace(staged / name, folder / name)
    except OSError as error:
        raise OutputError(f"cannot write into {folder}: {error.strerror or error}; choose another with -o") from error
    finally:
        shutil.rmtree(staged, ignore_errors=True)
    return [folder / name for name in contents]
