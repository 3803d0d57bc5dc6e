"""LLVM flang on this machine: the second compiler that the emitted source is tried with."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

OLDEST = 18  # before it flang links programs only when told that it is an experiment
_NAME = re.compile(r"flang(?:-new)?(?:-(\d+))?$")


def find_flang() -> Path | None:
    """The newest LLVM flang on the PATH, whatever its name (flang, flang-new, flang-19, flang-new-19), or None."""
    found: list[tuple[int, str]] = []
    for folder in os.environ.get("PATH", "").split(os.pathsep):
        for path in Path(folder).glob("flang*") if folder else ():
            match = _NAME.match(path.name)
            version = int(match[1]) if match and match[1] else 0
            if match and (version == 0 or version >= OLDEST) and shutil.which(str(path)):
                found.append((version, str(path)))
    return Path(max(found)[1]) if found else None
