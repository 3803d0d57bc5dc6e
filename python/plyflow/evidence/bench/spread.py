"""Repeated measurements in three numbers: median and quartiles."""

from __future__ import annotations

import statistics
from collections.abc import Iterable
from typing import NamedTuple


class Spread(NamedTuple):
    """Median and quartiles over the repeats."""

    median: float
    low: float
    high: float

    @property
    def half(self) -> float:
        """Half the interquartile range."""
        return (self.high - self.low) / 2

    @property
    def relative(self) -> float:
        """Half the interquartile range over the median."""
        return self.half / self.median


def spread_of(values: Iterable[float]) -> Spread:
    """Median and quartiles (of few values the outermost ones)."""
    ordered = sorted(values)
    quarter = len(ordered) // 4
    return Spread(statistics.median(ordered), ordered[quarter], ordered[-1 - quarter])
