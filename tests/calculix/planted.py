"""Errors to be seen: a native face with a line changed."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from plyflow.hosts.calculix.faces import STANDINS, Face, build_library, own_source

Plant = Callable[[str], str]


def changed(text: str, old: str, new: str) -> str:
    """Text with its only `old` replaced."""
    assert text.count(old) == 1, (old, text.count(old))
    return text.replace(old, new)


def stress(text: str) -> str:
    """The stress a thousandth too large."""
    return changed(text, "      stre = stress\n", "      stre = 1.001d0*stress\n")


def stiffness(text: str) -> str:
    """The stiffness a hundred times too small."""
    return changed(text, "          stiff(n) = ddsdde(i,j)\n", "          stiff(n) = ddsdde(i,j)/100.0d0\n")


def native(text: str, plant: Plant) -> Face:
    """Face of a planted source."""
    path: Path = build_library({STANDINS: own_source(STANDINS), "native.for": plant(text)})
    return Face("@PFDEFAULT_PFMATERIAL", "PFDEFAULT", path)
