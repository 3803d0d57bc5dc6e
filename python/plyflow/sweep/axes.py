"""Values along one axis of a grid: lists and ranges as people write them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from plyflow.errors import InputError
from plyflow.wording import did_you_mean

TEXT_NAMES = ("material", "layup", "load", "scene")
NUMBER_NAMES = ("temperature", "width", "refine")
MOST_VALUES = 10_000_000
DIGITS = 12
HOW = "write values 30,50,70, a range FROM:TO:STEP with both ends, or FROM:TO@COUNT"
Value = str | float
Axis = NDArray[Any]  # (n,) of texts or numbers


def read_axis(name: str, value: Any) -> Axis:
    """An axis from text ("30:90:10,95"), a number, or a list of these; numbers of a range rounded to 12 digits.

    Raises
    ------
    InputError
        No values, not numbers where numbers are wanted, a range that does not end, too many values.
    """
    words = list(_words(value if isinstance(value, list | tuple) else [value]))
    if not words:
        raise InputError(f"{name}: no values given: {HOW}")
    if name in TEXT_NAMES:
        return np.array([text(name, word) for word in words], dtype=object)
    axis = np.concatenate([_numbers(name, word) for word in words])
    if axis.size > MOST_VALUES:
        raise InputError(f"{name}: {axis.size} values are more than {MOST_VALUES}: take a larger step")
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


def _numbers(name: str, word: Any) -> NDArray[np.float64]:
    """The numbers of one entry: a single one, or those of a range."""
    if not isinstance(word, str) or (":" not in word and "@" not in word):
        return np.array([_checked(name, word)])
    first, step, count = _range(name, word)
    return np.fromiter((float(f"{first + place * step:.{DIGITS}g}") for place in range(count)), float, count)


def _checked(name: str, word: Any) -> float:
    try:
        return number(name, word)
    except InputError as error:
        near = did_you_mean(name, TEXT_NAMES)
        raise InputError(f"unknown name '{name}'{near}" if near else f"{error}: {HOW}") from None


def _range(name: str, word: str) -> tuple[float, float, int]:
    """First number, step and count of a range."""
    ends, at, count_text = word.partition("@")
    limits = [_checked(name, part) for part in ends.split(":")]
    if not all(math.isfinite(limit) for limit in limits) or len(limits) != (2 if at else 3):
        raise InputError(f"{name}: '{word}' is no range: {HOW}")
    first, last = limits[:2]
    if at:
        count = int(count_text) if count_text.strip().isdigit() else 0
        if not 2 <= count <= MOST_VALUES:
            raise InputError(f"{name}: '{word}' needs a whole number from 2 to {MOST_VALUES} after @")
        return first, (last - first) / (count - 1), count
    step = limits[2]
    if step == 0.0 or (last - first) / step < 0.0:
        raise InputError(f"{name}: '{word}' never gets from {first:g} to {last:g}: change the step {step:g}")
    steps = (last - first) / step
    if steps >= MOST_VALUES:
        raise InputError(f"{name}: '{word}' has more than {MOST_VALUES} values: take a larger step")
    return first, step, math.floor(steps + 1e-9) + 1
