"""Reading files that instruments and people write: comments, units, any separator, decimal commas.

Every complaint names the file and the line.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from plyflow.errors import InputError
from plyflow.wording import count_text

FloatArray = NDArray[np.float64]
COMMENTS = ("#", "%", "//")
Row = tuple[int, str]  # line number, text


@dataclass(frozen=True)
class Quantity:
    """One kind of column: name, unit it is turned into, other names, factor to that unit by unit (lower case).

    Of units that differ in case only, those in `exact` are taken as written.
    """

    name: str
    unit: str
    aliases: tuple[str, ...]
    factors: Mapping[str, float]
    exact: Mapping[str, float] = field(default_factory=dict)

    def factor(self, unit: str) -> float | None:
        """Factor from a unit to this quantity's, None for an unknown unit."""
        return self.exact.get(unit, self.factors.get(unit.lower()))


_TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0}
_FORCES = {"n": 1.0, "kn": 1e3, "kgf": 9.80665, "lbf": 4.4482216}
_PRESSURES = {"mpa": 1.0, "kpa": 1e-3, "pa": 1e-6, "bar": 0.1, "mbar": 1e-4, "psi": 6.894757e-3, "n/mm2": 1.0, "n/mm²": 1.0}
_LENGTHS = {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "μm": 1e-3, "micron": 1e-3, "cm": 10.0, "m": 1e3, "in": 25.4}
QUANTITIES: dict[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        Quantity("time", "s", ("t", "zeit", "temps", "tiempo", "tempo"), _TIMES),
        Quantity("force", "N", ("f", "load", "kraft", "effort"), _FORCES, {"mN": 1e-3, "MN": 1e6}),
        Quantity("pressure", "MPa", ("p", "stress", "druck"), _PRESSURES, {"mPa": 1e-9}),
        Quantity("thickness", "mm", ("h", "height", "gap", "dicke", "epaisseur", "épaisseur"), _LENGTHS),
        Quantity("width", "mm", ("w", "breite", "largeur"), _LENGTHS),
    )
}


def split_heading(heading: str) -> tuple[str, str | None]:
    """Name and unit of a heading: "Force [N]", "thickness (µm)", "time / s", "force_kN" or a bare name."""
    text = heading.strip().strip('"')
    bracketed = re.fullmatch(r"(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]", text)
    if bracketed:
        return bracketed[1].strip(), bracketed[2].strip() or None
    divided = re.fullmatch(r"(.+?)\s*/\s*(\S+)", text)
    if divided:
        return divided[1], divided[2]
    name, separator, last = text.rpartition("_")
    if separator and any(last.lower() in quantity.factors for quantity in QUANTITIES.values()):
        return name, last
    return text, None


def find_quantity(name: str) -> Quantity | None:
    """The quantity a column name stands for, None for a column of another kind."""
    plain = re.sub(r"[\s_-]+", " ", name).strip().lower()
    named = [quantity for quantity in QUANTITIES.values() if plain in (quantity.name, *quantity.aliases)]
    held = [quantity for quantity in QUANTITIES.values() if quantity.name in plain.split()]
    return next(iter(named + held), None)


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

    def factor(self, path: Path, number: int) -> float:
        factor = 1.0 if self.unit is None else self.quantity.factor(self.unit)
        if factor is None:
            known = ", ".join(self.quantity.factors)
            raise _error(path, number, f"unknown unit '{self.unit}' of {self.quantity.name}: use one of {known}")
        return factor


def read_measured(path: Path, needed: Sequence[str], optional: Sequence[str] = ()) -> MeasuredFile:
    """Read columns from a text file.

    Parameters
    ----------
    path : Path
        The file: a heading line, one row a reading, columns divided by comma, semicolon, tab or blanks; lines that
        start with #, % or // are comments, of which "name: value" and "name = value" are kept.
    needed, optional : sequence of str
        Names of `QUANTITIES`. Other columns are left out.

    Raises
    ------
    InputError
        The file cannot be read, a column is missing or named twice, a unit is unknown, a value is missing or not a
        finite number, times do not increase; with the line.
    """
    entries, (heading, *body) = _lines(path)
    separator = next((mark for mark in (";", "\t", ",") if mark in re.sub(r'"[^"]*"', "", heading[1])), None)
    columns, count = _headings(path, heading, separator, needed, optional)
    units = [column.text(_fields(body[0][1], separator)).strip("[]() ") for column in columns]
    if all(column.quantity.factor(unit) is not None for column, unit in zip(columns, units, strict=True)):
        columns = [replace(column, unit=column.unit or unit) for column, unit in zip(columns, units, strict=True)]
        if len(body) == 1:
            raise _error(path, body[0][0], "no numbers follow the heading")
        body = body[1:]
    notes = [f"{one.quantity.name} without a unit in {path} read as {one.quantity.unit}" for one in columns if one.unit is None]
    numbers = _numbers(path, body, separator, columns, count)
    measured = MeasuredFile(path, numbers, np.array([number for number, _ in body]), entries, notes)
    times = numbers.get("time", np.zeros(0))
    for row in np.flatnonzero(np.diff(times) <= 0.0)[:1] + 1:
        raise measured.error(row, f"time {times[row]:g} s does not follow {times[row - 1]:g} s: times must increase")
    return measured


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
    path: Path, row: Row, separator: str | None, needed: Sequence[str], optional: Sequence[str]
) -> tuple[list[_Column], int]:
    """The wanted columns, and the number of all."""
    number, line = row
    headings = _fields(re.sub(r"\s+(?=[\[(])", "", line) if separator is None else line, separator)
    chosen: dict[str, _Column] = {}
    for place, heading in enumerate(headings):
        name, unit = split_heading(heading)
        quantity = find_quantity(name)
        if quantity is None or quantity.name not in (*needed, *optional):
            continue
        if quantity.name in chosen:
            raise _error(path, number, f"two columns hold the {quantity.name}: leave one out")
        chosen[quantity.name] = _Column(place, quantity, unit)
        chosen[quantity.name].factor(path, number)
    missing = [f"'{name} [{QUANTITIES[name].unit}]'" for name in needed if name not in chosen]
    if missing:
        listed = ", ".join(f"'{heading}'" for heading in headings)
        raise _error(path, number, f"no column {' and '.join(missing)}; the heading has {listed}")
    return list(chosen.values()), len(headings)


def _numbers(
    path: Path, body: Sequence[Row], separator: str | None, columns: Sequence[_Column], count: int
) -> dict[str, FloatArray]:
    table = np.empty((len(columns), len(body)))
    factors = [column.factor(path, body[0][0]) for column in columns]
    for row, (number, line) in enumerate(body):
        fields = _fields(line, separator)
        if len(fields) > count and any(fields[count:]):
            hint = ": with decimal commas divide the columns by semicolons" if separator == "," else ""
            raise _error(path, number, f"{len(fields)} values for {count} columns{hint}")
        for place, (column, factor) in enumerate(zip(columns, factors, strict=True)):
            table[place, row] = _number(path, number, column.quantity.name, column.text(fields)) * factor
    return {column.quantity.name: table[place] for place, column in enumerate(columns)}


def _number(path: Path, number: int, name: str, text: str) -> float:
    if not text:
        raise _error(path, number, f"no value of {name}: fill it in or leave the line out")
    plain = text.replace("\N{MINUS SIGN}", "-")
    try:
        value = float(plain.replace(",", ".") if plain.count(",") == 1 and "." not in plain else plain)
    except ValueError:
        raise _error(path, number, f"{name} '{text}' is not a number") from None
    if not math.isfinite(value):
        raise _error(path, number, f"{name} '{text}' is not a finite number")
    return value
