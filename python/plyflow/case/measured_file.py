"""Reading files that instruments and people write: comments, units, any separator, decimal commas.

Every complaint names the file and the line.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from plyflow.case.quantities import QUANTITIES, Quantity, find_quantity, split_heading
from plyflow.errors import InputError
from plyflow.wording import count_text

FloatArray = NDArray[np.float64]
COMMENTS = ("#", "%", "//")


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
        return InputError(f"{self.path}, line {self.lines[row]}: {message}")


def read_measured(path: Path, needed: Sequence[str], optional: Sequence[str] = ()) -> MeasuredFile:
    """Read columns from a text file.

    Parameters
    ----------
    path : Path
        The file: a heading line, one row a reading, columns divided by comma, semicolon, tab or blanks; lines that
        start with #, % or // are comments, of which "name: value" and "name = value" are kept.
    needed, optional : sequence of str
        Names of quantities; see `quantities.QUANTITIES`. Other columns are left out.

    Raises
    ------
    InputError
        The file cannot be read, a column is missing or named twice, a unit is unknown, a value is missing or not a
        finite number, times do not increase; with the line.
    """
    entries: dict[str, tuple[str, int]] = {}
    rows: list[tuple[int, str]] = []
    for number, line in enumerate(_text(path).splitlines(), start=1):
        text = line.strip()
        if text.startswith(COMMENTS):
            _note_entry(text, number, entries)
        elif text.strip(",;\t "):
            rows.append((number, line))
    if len(rows) < 2:
        raise InputError(
            f"{path}: needs a heading line and rows of numbers; found {count_text(len(rows), 'line', 'lines')} besides comments"
        )
    separator = _separator(rows[0][1])
    chosen, count, notes = _headings(path, rows[0], separator, needed, optional)
    body = rows[1:]
    units = _unit_row(_fields(body[0][1], separator), chosen)
    if units is not None:
        chosen, body = units, body[1:]
    if not body:
        raise InputError(f"{path}, line {rows[-1][0]}: no numbers follow the heading")
    notes += [
        f"{quantity.name} without a unit in {path} read as {quantity.unit}" for _, quantity, unit in chosen if unit is None
    ]
    columns = _numbers(path, body, separator, chosen, count)
    measured = MeasuredFile(path, columns, np.array([number for number, _ in body]), entries, notes)
    _check_times(measured)
    return measured


def _text(path: Path) -> str:
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", errors="replace")


def _note_entry(text: str, number: int, entries: dict[str, tuple[str, int]]) -> None:
    found = re.fullmatch(r"(?:#|%|//)+\s*([A-Za-z][\w \-]*?)\s*[:=]\s*(.+?)\s*", text)
    if found:
        entries[re.sub(r"[\s\-]+", "_", found[1].lower())] = found[2], number


def _separator(heading: str) -> str | None:
    """The separator of a file by its heading line; None stands for blanks."""
    outside = re.sub(r'"[^"]*"', "", heading)
    return next((mark for mark in (";", "\t", ",") if mark in outside), None)


def _fields(line: str, separator: str | None) -> list[str]:
    if separator is None:
        return line.split()
    return [field.strip() for field in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]


Chosen = list[tuple[int, Quantity, str | None]]


def _headings(
    path: Path, row: tuple[int, str], separator: str | None, needed: Sequence[str], optional: Sequence[str]
) -> tuple[Chosen, int, list[str]]:
    """Places, quantities and units of the wanted columns; the number of columns; notes."""
    number, line = row
    if separator is None:
        line = re.sub(r"\s+(?=[\[(])", "", line)
    headings = _fields(line, separator)
    chosen: Chosen = []
    for place, heading in enumerate(headings):
        name, unit = split_heading(heading)
        quantity = find_quantity(name)
        if quantity is None or quantity.name not in (*needed, *optional):
            continue
        if any(quantity is other for _, other, _ in chosen):
            raise InputError(f"{path}, line {number}: two columns hold the {quantity.name}: leave one out")
        _factor(path, number, quantity, unit)
        chosen.append((place, quantity, unit))
    missing = [name for name in needed if name not in {quantity.name for _, quantity, _ in chosen}]
    if missing:
        listed = ", ".join(f"'{heading}'" for heading in headings)
        wanted = " and ".join(f"'{name} [{QUANTITIES[name].unit}]'" for name in missing)
        raise InputError(f"{path}, line {number}: no column {wanted}; the heading has {listed}")
    return chosen, len(headings), []


def _factor(path: Path, number: int, quantity: Quantity, unit: str | None) -> float:
    if unit is None:
        return 1.0
    factor = quantity.factor(unit)
    if factor is None:
        known = ", ".join(quantity.factors)
        raise InputError(f"{path}, line {number}: unknown unit '{unit}' of {quantity.name}: use one of {known}")
    return factor


def _unit_row(fields: list[str], chosen: Chosen) -> Chosen | None:
    """The columns with the units of a row of units below the heading, None if that row is not one."""
    found: Chosen = []
    for place, quantity, unit in chosen:
        text = fields[place].strip("[]() ") if place < len(fields) else ""
        if quantity.factor(text) is None:
            return None
        found.append((place, quantity, unit or text))
    return found


def _numbers(
    path: Path, body: list[tuple[int, str]], separator: str | None, chosen: Chosen, count: int
) -> dict[str, FloatArray]:
    table = np.empty((len(chosen), len(body)))
    for row, (number, line) in enumerate(body):
        fields = _fields(line, separator)
        if len(fields) > count and any(fields[count:]):
            hint = ": with decimal commas divide the columns by semicolons" if separator == "," else ""
            raise InputError(f"{path}, line {number}: {len(fields)} values for {count} columns{hint}")
        for column, (place, quantity, unit) in enumerate(chosen):
            text = fields[place] if place < len(fields) else ""
            table[column, row] = _number(path, number, quantity, text) * _factor(path, number, quantity, unit)
    return {quantity.name: table[column] for column, (_, quantity, _) in enumerate(chosen)}


def _number(path: Path, number: int, quantity: Quantity, text: str) -> float:
    if not text:
        raise InputError(f"{path}, line {number}: no value of {quantity.name}: fill it in or leave the line out")
    plain = text.replace("\N{MINUS SIGN}", "-")
    try:
        value = float(plain.replace(",", ".") if plain.count(",") == 1 and "." not in plain else plain)
    except ValueError:
        raise InputError(f"{path}, line {number}: {quantity.name} '{text}' is not a number") from None
    if not math.isfinite(value):
        raise InputError(f"{path}, line {number}: {quantity.name} '{text}' is not a finite number")
    return value


def _check_times(measured: MeasuredFile) -> None:
    times = measured.columns.get("time")
    if times is None:
        return
    back = np.flatnonzero(np.diff(times) <= 0.0)
    if back.size:
        row = int(back[0]) + 1
        raise measured.error(row, f"time {times[row]:g} s does not follow {times[row - 1]:g} s: times must increase")
