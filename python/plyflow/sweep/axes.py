"""Values along one axis of a grid: lists and ranges as people write them, kept as ranges however long they are."""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from plyflow.errors import InputError
from plyflow.wording import did_you_mean

TEXT_NAMES = ("material", "layup", "load", "scene")
NUMBER_NAMES = ("temperature", "width", "refine")
MOST_VALUES = 10_000_000
DIGITS = 12
HOW = "write values 30,50,70, a range FROM:TO:STEP with both ends, or FROM:TO@COUNT"
Value = str | float


@dataclass(frozen=True)
class Spaced:
    """Equally spaced numbers: first + i step, i = 0 ... count - 1, rounded to 12 digits."""

    first: float
    step: float
    count: int

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, place: int) -> float:
        return _rounded(self.first + place * self.step)


class Axis:
    """Values of one name, in order: pieces that are lists or ranges."""

    def __init__(self, name: str, pieces: Sequence[Sequence[Value] | Spaced]) -> None:
        self.name = name
        self._pieces = list(pieces)
        self._starts = [0, *itertools.accumulate(len(piece) for piece in self._pieces)]

    def __len__(self) -> int:
        return self._starts[-1]

    def __getitem__(self, place: int) -> Value:
        if not 0 <= place < len(self):
            raise IndexError(place)
        piece = bisect.bisect_right(self._starts, place) - 1
        return self._pieces[piece][place - self._starts[piece]]


def read_axis(name: str, value: Any) -> Axis:
    """An axis from text ("30:90:10,95"), a number, or a list of these.

    Raises
    ------
    InputError
        No values, not numbers where numbers are wanted, a range that does not end, too many values.
    """
    parts = value if isinstance(value, list | tuple) else [value]
    axis = Axis(name, _joined(_piece(name, word) for word in _words(parts)))
    if not len(axis):
        raise InputError(f"{name}: no values given: {HOW}")
    if len(axis) > MOST_VALUES:
        raise InputError(f"{name}: {len(axis)} values are more than {MOST_VALUES}: take a larger step")
    return axis


def text(name: str, value: Any) -> str:
    """A text out of a table, or an error that names it; a layup may be a whole number of plies."""
    if name == "layup" and isinstance(value, int) and not isinstance(value, bool):
        return str(value)
    if not isinstance(value, str):
        raise InputError(f"{name}: {value} is no text: put it in quotes")
    return value


def number(name: str, value: Any) -> float:
    """A number out of a table, or an error that names it."""
    if isinstance(value, bool):
        raise InputError(f"{name}: {value} is no number")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name}: '{value}' is no number") from None


def _words(parts: Iterable[Any]) -> Iterable[Any]:
    for part in parts:
        words = [word.strip() for word in part.split(",")] if isinstance(part, str) else [part]
        yield from (word for word in words if word != "")


def _joined(pieces: Iterable[list[Value] | Spaced]) -> list[Sequence[Value] | Spaced]:
    """The same pieces, single values one after the other as one list."""
    joined: list[Sequence[Value] | Spaced] = []
    for piece in pieces:
        if isinstance(piece, list) and joined and isinstance(joined[-1], list):
            joined[-1].extend(piece)
        else:
            joined.append(piece)
    return joined


def _piece(name: str, word: Any) -> list[Value] | Spaced:
    if name in TEXT_NAMES:
        return [text(name, word)]
    if not isinstance(word, str) or (":" not in word and "@" not in word):
        return [_checked(name, word)]
    return _range(name, word)


def _checked(name: str, word: Any) -> float:
    try:
        return number(name, word)
    except InputError as error:
        near = did_you_mean(name, TEXT_NAMES)
        raise InputError(f"unknown name '{name}'{near}" if near else f"{error}: {HOW}") from None


def _range(name: str, word: str) -> Spaced:
    ends, at, count_text = word.partition("@")
    limits = [_checked(name, part) for part in ends.split(":")]
    if not all(math.isfinite(limit) for limit in limits) or len(limits) != (2 if at else 3):
        raise InputError(f"{name}: '{word}' is no range: {HOW}")
    first, last = limits[:2]
    if at:
        count = int(count_text) if count_text.strip().isdigit() else 0
        if not 2 <= count <= MOST_VALUES:
            raise InputError(f"{name}: '{word}' needs a whole number from 2 to {MOST_VALUES} after @")
        return Spaced(first, (last - first) / (count - 1), count)
    step = limits[2]
    if step == 0.0 or (last - first) / step < 0.0:
        raise InputError(f"{name}: '{word}' never gets from {first:g} to {last:g}: change the step {step:g}")
    steps = (last - first) / step
    if steps >= MOST_VALUES:
        raise InputError(f"{name}: '{word}' has more than {MOST_VALUES} values: take a larger step")
    return Spaced(first, step, math.floor(steps + 1e-9) + 1)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
