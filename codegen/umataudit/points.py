"""Random admissible points: exact rational numbers in a stated range for each symbol, the same on every run."""

from __future__ import annotations

import random
from collections.abc import Iterable

import sympy as sp

from umataudit.printed.letters import BY_SYMBOL

DIGITS = 30
Range = tuple[float, float]
DIAGONAL, OFF_DIAGONAL = (0.8, 1.2), (-0.2, 0.2)


def range_of(symbol: sp.Symbol) -> Range:
    """Admissible range of a symbol."""
    letter = BY_SYMBOL.get(symbol.name)
    if letter is not None and letter.range is not None:
        low, high = letter.range
        return low, high
    base, _, indices = symbol.name.rpartition("_")
    if base in {"F", "C"} and indices.isdigit():
        return DIAGONAL if indices[0] == indices[1] else OFF_DIAGONAL
    return (-1.5, -0.5) if symbol.is_negative else (0.5, 1.5)


def admissible_points(symbols: Iterable[sp.Symbol], seed: str, count: int = 3) -> list[dict[sp.Symbol, sp.Rational]]:
    """`count` points; the same seed gives the same points on every machine."""
    source = random.Random(seed)
    ordered = sorted(set(symbols), key=str)
    return [{symbol: _draw(source, range_of(symbol)) for symbol in ordered} for _ in range(count)]


def _draw(source: random.Random, bounds: Range) -> sp.Rational:
    """A rational number with few digits, inside the bounds."""
    low, high = bounds
    return sp.Rational(f"{low + (high - low) * source.randrange(1, 10000) / 10000:.9g}")
