"""What a result was made with: enough to make it again and to tell two results apart."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass
from importlib import metadata
from typing import Any


@dataclass(frozen=True)
class Provenance:
    """Inputs and tools of one result; see `as_dict` for the plain form. `batches`: how many points in one call are done."""

    plyflow_version: str
    generator_version: str
    scene: dict[str, Any]
    source_sha256: str
    compiler: str
    compiler_flags: str
    batches: str

    def as_dict(self) -> dict[str, Any]:
        """Plain dictionary, ready for JSON."""
        return asdict(self)


def package_version() -> str:
    """Version of the installed plyflow, "not installed" when it runs from a source folder."""
    try:
        return metadata.version("plyflow")
    except metadata.PackageNotFoundError:
        return "not installed"


def source_hash(source: str) -> str:
    """SHA-256 of a generated source, hexadecimal."""
    return hashlib.sha256(source.encode("utf-8")).hexdigest()
