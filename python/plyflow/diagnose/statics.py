"""SAVE and COMMON in a shared library: what it keeps between calls outside STATEV, and whether calls change it."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from plyflow.umat.library import UmatLibrary

_OBJECT = re.compile(r"^\s*\d+: (?P<value>[0-9a-f]+)\s+(?P<size>\d+) OBJECT\s+(?P<bind>\w+)\s+\w+\s+(?P<section>\d+) (?P<name>\S+)")
_FUNCTION = re.compile(r"^\s*\d+: (?P<value>[0-9a-f]+)\s+\d+ FUNC\s+\w+\s+\w+\s+\d+ umat_$", re.MULTILINE)
_SECTION = re.compile(r"^\s*\[\s*(\d+)\] (\.bss|\.data)\s", re.MULTILINE)
_NOT_THE_UMATS = re.compile(r"^(_|completed\.)|plyflow_abaqus_standins|^options\.\d+")


@dataclass(frozen=True)
class Static:
    """A variable that lives as long as the library: name as in the source, whether a COMMON, place, bytes."""

    name: str
    common: bool
    value: int
    size: int


class Statics:
    """The variables of a library that calls could change; `known` is False where readelf is missing or finds no symbols."""

    def __init__(self, library: UmatLibrary) -> None:
        self.found: list[Static] = []
        program = shutil.which("readelf")
        text = _symbols(program, library.path) if program else ""
        entry = _FUNCTION.search(text)
        self.known = entry is not None
        self._base = library.address - int(entry["value"], 16) if entry else 0
        sections = set(_SECTION.findall(text))
        writable = {number for number, _ in sections}
        for match in map(_OBJECT.match, text.partition("Symbol table '.symtab'")[2].splitlines()):
            if match and match["section"] in writable and int(match["size"]) and not _NOT_THE_UMATS.search(match["name"]):
                common = match["bind"] == "GLOBAL"
                name = match["name"].rstrip("_") if common else match["name"].rpartition(".")[0] or match["name"]
                self.found.append(Static(name.upper(), common, int(match["value"], 16), int(match["size"])))

    def contents(self) -> list[bytes]:
        """Bytes of all variables now."""
        return [ctypes.string_at(self._base + one.value, one.size) for one in self.found]


def _symbols(program: str, path: Path) -> str:
    answer = subprocess.run([program, "-S", "-s", "-W", str(path)], capture_output=True, text=True, check=False)
    return answer.stdout
