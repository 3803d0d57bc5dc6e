"""Temperature table of a material: k, a and both b as monotone cubics of temperature (Fritsch and Carlson 1980)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from scipy.interpolate import PchipInterpolator

QUANTITIES = {"k": "k_gap", "a": "a_rate", "b_squeeze": "b_squeeze", "b_bleed": "b_bleed"}


@dataclass(frozen=True)
class Cubics:
    """One quantity over temperature: name in Fortran, and c3, c2, c1, c0 of each piece, in s = temperature - its start."""

    name: str
    coefficients: tuple[tuple[float, float, float, float], ...]


def cubics(table: Mapping[str, Sequence[float]], kept: Sequence[str]) -> list[Cubics]:
    """Cubics of the quantities kept; `table` holds temperature [degC] and the four columns, all (n,), n >= 2."""
    found = []
    for name in kept:
        c3, c2, c1, c0 = PchipInterpolator(table["temperature"], table[name]).c.tolist()
        found.append(Cubics(QUANTITIES[name], tuple(zip(c3, c2, c1, c0, strict=True))))
    return found
