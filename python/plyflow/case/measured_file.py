"""Reading files that instruments and people write: comments, units, any separator, decimal commas.

Every complaint names the file and the line; faulty rows are told all at once. A column that nobody uses is refused, unless a
comment "# not used: NAME, NAME" says that it is meant to be there.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from plyflow.case.quantities import QUANTITIES, Quantity, find_quantity, split_heading
from plyflow.errors import InputError
from plyflow.wording import count_text

FloatArray = NDArray[np.float64]
COMMENTS = ("#", "%", "//")
NOT_USED = "not_used"
MOST_TOLD, LARGEST_SKIPPED = 5, 0.1
Row = tuple[int, str]  # line number, text


@dataclass(frozen=True)
class MeasuredFile:
    """Columns by quantity, arrays (n,) in s, N, MPa, mm; line (n,) of each row; entries of the comments; notes."""

    path: Path
    columns: dict[str, FloatArray]
    lines: NDArray[np.intp]
    entries: dict[str, tuple[str, int]]
    notes: list[str]

    def error(self, row: int, message: str) -> InputError:
        """Complain about a row (from 0)."""
        return _error(self.path, int(self.lines[row]), message)


@dataclass(frozen=True)
class _Column:
    """A column to be read: its place in the line, its quantity and the unit it is given in."""

    place: int
    quantity: Quantity
    unit: str | None

    def text(self, fields: Sequence[str]) -> str:
        return fields[self.place] if self.place < len(fields) else ""

    def check(self, path: Path, number: int) -> None:
        if self.unit is not None and self.quantity.factor(self.unit) is None:
            known = ", ".join(self.quantity.factors)
            raise _error(path, number, f"unknown unit '{self.unit}' of {self.quantity.name}: use one of {known}")

    def converted(self, number: float) -> float:
        if self.unit is None:
            return number
        return number * (self.quantity.factor(self.unit) or 1.0) + self.quantity.shift(self.unit)


def read_measured(
    path: Path, needed: Sequence[str], optional: Sequence[str] = (), skip_bad_rows: bool | None = None
) -> MeasuredFile:
    """Read columns from a text file.

    Parameters
    ----------
    path : Path
        The file: a heading line, one row a reading, columns divided by comma, semicolon, tab or blanks; lines that
        start with #, % or // are comments, of which "name: value" and "name = value" are kept.
    needed, optional : sequence of str
        Names of `QUANTITIES`. Other columns are refused, unless a comment "# not used: NAME" names them.
    skip_bad_rows : bool, optional
        Leave faulty rows out and note how many; None where the caller has no such option, which messages then do not offer.

    Raises
    ------
    InputError
        The file cannot be read, a column is missing, named twice or not used, a unit is unknown, a value is missing or not a
        finite number, times do not increase; with the lines, all of them.
    """
    entries, (heading, *body) = _lines(path)
    separator = next((mark for mark in (";", "\t", ",") if mark in re.sub(r'"[^"]*"', "", heading[1])), None)
    unused = [name.strip() for name in entries.get(NOT_USED, ("", 0))[0].split(",") if name.strip()]
    columns, count = _headings(path, heading, separator, needed, optional, unused)
    units = [column.text(_fields(body[0][1], separator)).strip("[]() ") for column in columns]
    if all(column.quantity.factor(unit) is not None for column, unit in zip(columns, units, strict=True)):
        columns = [replace(column, unit=column.unit or unit) for column, unit in zip(columns, units, strict=True)]
        if len(body) == 1:
            raise _error(path, body[0][0], "no numbers follow the heading")
        body = body[1:]
    notes = [f"{one.quantity.name} without a unit in {path} read as {one.quantity.unit}" for one in columns if one.unit is None]
    notes += [f"not used in {path}, as it says: {', '.join(unused)}"] if unused else []
    numbers, faults = _numbers(body, separator, columns, count)
    kept = np.array([row not in faults for row in range(len(body))])
    if faults:
        notes.append(_told(path, body, faults, skip_bad_rows))
    lines = np.array([number for number, _ in body])[kept]
    return MeasuredFile(path, {name: values[kept] for name, values in numbers.items()}, lines, entries, notes)


def _told(path: Path, body: Sequence[Row], faults: Mapping[int, str], skip: bool | None) -> str:
    """What was skipped, or the complaint about every faulty row."""
    words = [f"line {body[row][0]}: {fault}" for row, fault in list(faults.items())[:MOST_TOLD]]
    words += [f"and {len(faults) - MOST_TOLD} more"] if len(faults) > MOST_TOLD else []
    if skip and len(faults) <= LARGEST_SKIPPED * len(body):
        return f"{path}: {len(faults)} of {count_text(len(body), 'row', 'rows')} skipped as asked: {'; '.join(words)}"
    if skip:
        words.append(f"of {len(body)} rows: --skip-bad-rows leaves at most a tenth out")
    elif skip is not None:
        words.append("correct them, or leave them out with --skip-bad-rows")
    if len(faults) == 1:
        raise InputError(f"{path}, {'; '.join(words)}")
    raise InputError(f"{path}: {len(faults)} faulty rows: {'; '.join(words)}")


def _error(path: Path, number: int, message: str) -> InputError:
    return InputError(f"{path}, line {number}: {message}")


def _lines(path: Path) -> tuple[dict[str, tuple[str, int]], list[Row]]:
    """Entries of the comments, and the lines that are none: a heading and at least one row."""
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("cp1252", errors="replace")
    entries: dict[str, tuple[str, int]] = {}
    rows: list[Row] = []
    for number, line in enumerate(text.splitlines(), start=1):
        if line.strip().startswith(COMMENTS):
            found = re.fullmatch(r"(?:#|%|//)+\s*([A-Za-z][\w \-]*?)\s*[:=]\s*(.+?)\s*", line.strip())
            if found:
                entries[re.sub(r"[\s\-]+", "_", found[1].lower())] = found[2], number
        elif line.strip().strip(",;\t "):
            rows.append((number, line))
    if len(rows) < 2:
        raise InputError(
            f"{path}: needs a heading line and rows of numbers; found {count_text(len(rows), 'line', 'lines')} besides comments"
        )
    return entries, rows


def _fields(line: str, separator: str | None) -> list[str]:
    """The fields of a line; without a separator they are divided by blanks."""
    if separator is None:
        return line.split()
    return [field.strip() for field in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]


def _headings(
    path: Path, row: Row, separator: str | None, needed: Sequence[str], optional: Sequence[str], unused: Sequence[str]
) -> tuple[list[_Column], int]:
    """The wanted columns, and the number of all."""
    number, line = row
    headings = _fields(re.sub(r"\s+(?=[\[(])", "", line) if separator is None else line, separator)
    chosen: dict[str, _Column] = {}
    left: list[str] = []
    for place, heading in enumerate(headings):
        name, unit = split_heading(heading)
        if not heading or heading in unused or name in unused:
            continue
        quantity = find_quantity(name, unit)
        if quantity is None or quantity.name not in (*needed, *optional):
            left.append(heading)
            continue
        if quantity.name in chosen:
            raise _error(path, number, f"two columns hold the {quantity.name}: leave one out, or write '# not used: {name}'")
        chosen[quantity.name] = _Column(place, quantity, unit)
        chosen[quantity.name].check(path, number)
    _check_headings(path, number, headings, needed, chosen, left, [*needed, *optional])
    return list(chosen.values()), len(headings)


def _check_headings(
    path: Path, number: int, headings: Sequence[str], needed: Sequence[str], chosen: Mapping[str, _Column],
    left: Sequence[str], known: Sequence[str],
) -> None:  # fmt: skip
    """Refuse a heading with a column missing, or one that nobody uses."""
    missing = [f"'{name} [{QUANTITIES[name].unit}]'" for name in needed if name not in chosen]
    if missing:
        listed = ", ".join(f"'{heading}'" for heading in headings)
        raise _error(path, number, f"no column {' and '.join(missing)}; the heading has {listed}")
    if left:
        listed, names = ", ".join(f"'{heading}'" for heading in left), ", ".join(split_heading(one)[0] for one in left)
        raise _error(
            path, number, f"column {listed} is not used here, {', '.join(known)} are: take it out, or write '# not used: {names}' "
            "into the file",
        )  # fmt: skip


def _numbers(
    body: Sequence[Row], separator: str | None, columns: Sequence[_Column], count: int
) -> tuple[dict[str, FloatArray], dict[int, str]]:
    """Columns (n,) by quantity, and what is wrong with each faulty row."""
    table = np.full((len(columns), len(body)), np.nan)
    faults: dict[int, str] = {}
    names = [column.quantity.name for column in columns]
    last = -math.inf
    for row, (_, line) in enumerate(body):
        try:
            fields = _fields(line, separator)
            if len(fields) > count and any(fields[count:]):
                hint = ": with decimal commas divide the columns by semicolons" if separator == "," else ""
                raise ValueError(f"{len(fields)} values for {count} columns{hint}")
            table[:, row] = [one.converted(_number(one.quantity.name, one.text(fields))) for one in columns]
            time = float(table[names.index("time"), row]) if "time" in names else math.inf
            if time <= last and "time" in names:
                raise ValueError(f"time {time:g} s does not follow {last:g} s: times must increase")
            last = time
        except ValueError as error:
            faults[row] = str(error)
    return dict(zip(names, table, strict=True)), faults


def _number(name: str, text: str) -> float:
    if not text:
        raise ValueError(f"no value of {name}: fill it in or leave the line out")
    plain = text.replace("\N{MINUS SIGN}", "-")
    try:
        value = float(plain.replace(",", ".") if plain.count(",") == 1 and "." not in plain else plain)
    except ValueError:
        raise ValueError(f"{name} '{text}' is not a number") from None
    if not math.isfinite(value):
        raise ValueError(f"{name} '{text}' is not a finite number")
    return value
