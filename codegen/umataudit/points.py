"""Random admissible points: exact rational numbers in a stated range for each symbol, the same on every run."""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping

import sympy as sp

DIGITS = 30
Range = tuple[float, float]
RANGES: Mapping[str, Range] = {
    "k_gap": (0.80, 0.95),
    "chi_f": (1.6, 2.0),
    "chi_l": (1.1, 1.3),
    "eps": (-0.05, -0.01),
    "eps_lock": (-0.10, -0.06),
    "a_rate": (-0.95, -0.75),
    "b_log": (-18.0, -13.0),
    "b_bar": (-6.0, -2.0),
    "eta_res": (1e-5, 1e-3),
    "eta_micro": (5.0, 50.0),
    "w0": (10.0, 30.0),
    "h0": (0.1, 0.7),
    "l0": (10.0, 40.0),
    "d": (0.005, 0.009),
    "i1": (3.2, 3.6),
    "I3": (0.9, 1.1),
    "det_f": (0.85, 1.15),
    "x_min": (0.80, 0.95),
    "I1b": (0.80, 0.95),
    "C11": (0.70, 0.90),
    "lam": (0.80, 0.95),
    "V0": (0.45, 0.55),
    "Vf": (0.60, 0.75),
    "alpha": (0.2, 1.4),
    "alpha_f": (0.1, 0.6),
    "A0": (1.0, 1.2),
    "Af": (0.8, 1.0),
    "n": (0.1, 0.9),
    "gamma_lock": (1.0, 1.45),
    "eps_bulk": (-0.2, -0.1),
    "delta": (0.01, 0.10),
}
DIAGONAL, OFF_DIAGONAL = (0.8, 1.2), (-0.2, 0.2)


def range_of(symbol: sp.Symbol) -> Range:
    """Admissible range of a symbol."""
    if symbol.name in RANGES:
        return RANGES[symbol.name]
    base, _, indices = symbol.name.rpartition("_")
    if base in {"F", "C"} and indices.isdigit():
        return DIAGONAL if indices[0] == indices[1] else OFF_DIAGONAL
    if symbol.is_negative:
        return (-1.5, -0.5)
    return (0.5, 1.5)


def admissible_points(symbols: Iterable[sp.Symbol], seed: str, count: int = 3) -> list[dict[sp.Symbol, sp.Rational]]:
    """`count` points; the same seed gives the same points on every machine."""
    source = random.Random(seed)
    ordered = sorted(set(symbols), key=str)
    return [{symbol: _draw(source, range_of(symbol)) for symbol in ordered} for _ in range(count)]


def _draw(source: random.Random, bounds: Range) -> sp.Rational:
    """A rational number with few digits, inside the bounds."""
    low, high = bounds
    return sp.Rational(f"{low + (high - low) * source.randrange(1, 10000) / 10000:.9g}")
