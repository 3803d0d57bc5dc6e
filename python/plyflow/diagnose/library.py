"""A UMAT from a Fortran source or a shared library."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from plyflow.errors import InputError
from plyflow.umat import compile as compiling
from plyflow.umat.library import UmatLibrary

FIXED_FORM, FREE_FORM = (".f", ".for", ".ftn", ".f77"), (".f90", ".f95", ".f03", ".f08")
LIBRARIES = (".so", ".dylib")
_FORM = {**dict.fromkeys(FIXED_FORM, "-ffixed-form"), **dict.fromkeys(FREE_FORM, "-ffree-form")}
_FREE_FORM_LINE = "-ffree-line-length-none"


def load_umat(path: Path) -> UmatLibrary:
    """Compile (if it is a source) and load a UMAT.

    A source is compiled as Abaqus would: ABA_PARAM.INC and files beside the source are found, and XIT, STDB_ABQERR
    are there.

    Raises
    ------
    InputError
        There is no such file, or its ending is none of those known.
    ToolError
        The compiler is missing or refuses it, or it has no UMAT.
    """
    if not path.is_file():
        raise InputError(f"{path} is no file; give a Fortran source or a shared library with a UMAT")
    ending = path.suffix.lower()
    if ending in LIBRARIES:
        return UmatLibrary(path.resolve())
    if ending not in _FORM:
        known = ", ".join((*FIXED_FORM, *FREE_FORM, *LIBRARIES))
        raise InputError(f"{path}: the ending '{path.suffix}' is not known; use one of {known}")
    folders = (compiling.support_source("ABA_PARAM.INC").parent, path.resolve().parent)
    include = [f"-I{folder}" for folder in folders]
    source = path.read_text(encoding="utf-8", errors="replace")
    return UmatLibrary(compiling.compile_umat(source, (*flags_of(path), *include)))


def find_manifest(path: Path) -> tuple[Path, dict[str, Any]] | None:
    """The manifest NAME.json that `plyflow generate` has written beside a source or library, and its path; else None."""
    beside = path.with_suffix(".json")
    try:
        found = json.loads(beside.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return (beside, found) if isinstance(found, dict) and {"props", "statev", "scene"} <= set(found) else None


def flags_of(path: Path) -> tuple[str, ...]:
    """Flags of the compiler for a source, by its ending."""
    ending = path.suffix.lower()
    common = [flag for flag in compiling.FLAGS if flag != "-ffixed-form"]
    return (*common, _FORM[ending], *([_FREE_FORM_LINE] if ending in FREE_FORM else []))
