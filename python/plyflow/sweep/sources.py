"""Where the cases of a sweep come from: a grid, or a list in a TOML or CSV file."""

from __future__ import annotations

import csv
import hashlib
import math
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from plyflow.case.quantities import QUANTITIES, split_heading
from plyflow.errors import InputError
from plyflow.sweep.axes import TEXT_NAMES, Axis, Value, number, read_axis, text

Row = dict[str, Value]
Convert = Callable[[str], object]
OWN_UNITS = ("-", "mm", "degc", "mpa", "deg", "1/s", "s")


class Grid:
    """Every combination of the axes, the last one running fastest; only the axes are kept."""

    def __init__(self, axes: Mapping[str, Axis]) -> None:
        self._axes = dict(axes)
        self.columns = tuple(axes)

    def __len__(self) -> int:
        return math.prod(axis.size for axis in self._axes.values())

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the axes, which say it all."""
        return _sha256(repr((name, value)) for name, axis in self._axes.items() for value in axis.tolist())

    def texts(self, name: str) -> set[str]:
        """Different texts of a column."""
        return set(map(str, self._axes[name])) if name in self._axes else set()

    def rows(self, start: int, stop: int) -> list[Row]:
        """Cases from `start` up to `stop`."""
        places = np.unravel_index(np.arange(start, min(stop, len(self))), [axis.size for axis in self._axes.values()])
        columns = [axis[at].tolist() for axis, at in zip(self._axes.values(), places, strict=True)]
        return [dict(zip(self.columns, values, strict=True)) for values in zip(*columns, strict=True)]


class Listed:
    """Cases one by one, each with the place that complaints name; names missing in a case take the fixed values."""

    def __init__(
        self, names: Iterable[str], cases: Iterable[tuple[str, Mapping[str, object]]], fixed: Mapping[str, Value]
    ) -> None:
        self._rows = [{**fixed, **_typed(case, where)} for where, case in cases]
        self.columns = tuple(dict.fromkeys([*names, *fixed]))

    def __len__(self) -> int:
        return len(self._rows)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all cases."""
        return _sha256(repr(tuple(row.items())) for row in self._rows)

    def texts(self, name: str) -> set[str]:
        """Different texts of a column."""
        return {str(row[name]) for row in self._rows if name in row}

    def rows(self, start: int, stop: int) -> list[Row]:
        """Cases from `start` up to `stop`."""
        return self._rows[start:stop]


Source = Grid | Listed


def read_source(file: Path | None, grid: Sequence[str], fixed: Mapping[str, Value]) -> tuple[Source, dict[str, Any]]:
    """Cases from a file or from NAME=VALUES entries, and what the file says besides (model).

    A CSV file has a case a row. Its header names the columns; temperature, width, w0 and h0 may have a unit in brackets, other
    names those of this project only; empty cells take the fixed
    or default value; lines that start with # are comments; columns are separated by commas, or by semicolons if the
    header has some.

    Raises
    ------
    InputError
        Neither or both given, a file that does not describe a sweep, a value that cannot be read.
    """
    if (file is None) == (not grid):
        raise InputError("give either a FILE (.toml or .csv) of cases or --grid NAME=VALUES, for each name that varies")
    if file is None:
        return _grid([_entry(entry) for entry in grid], fixed), {}
    if file.suffix.lower() not in (".toml", ".csv"):
        raise InputError(f"{file}: cases are read from a .toml or a .csv file")
    try:
        content = file.read_text(encoding="utf-8-sig")
        return (_from_csv(file, content, fixed), {}) if file.suffix.lower() == ".csv" else _from_toml(file, content, fixed)
    except OSError as error:
        raise InputError(f"{file} cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error, tomllib.TOMLDecodeError) as error:
        kind = "no CSV file" if file.suffix.lower() == ".csv" else "not TOML"
        raise InputError(f"{file} is {kind}: {error}") from error


def read_fixed(entries: Sequence[str]) -> dict[str, Value]:
    """NAME=VALUE entries that hold for every case.

    Raises
    ------
    InputError
        An entry is not of that form, or has several values.
    """
    fixed: dict[str, Value] = {}
    for entry in entries:
        name, values = _entry(entry, "--set")
        axis = read_axis(name, values)
        if axis.size != 1 or name in fixed:
            raise InputError(f"--set {entry}: {name} takes one value for all cases; vary it with --grid {name}=VALUES")
        fixed[name] = axis.tolist()[0]
    return fixed


def _entry(entry: str, option: str = "--grid") -> tuple[str, str]:
    name, separator, values = entry.partition("=")
    if not separator or not name.strip():
        raise InputError(f"{option} {entry}: write NAME=VALUES, for example {option} temperature=70")
    return name.strip(), values


def _grid(entries: Sequence[tuple[str, Any]], fixed: Mapping[str, Value]) -> Grid:
    names = [*fixed, *(name for name, _ in entries)]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice:
        raise InputError(f"{twice} is given twice: give all its values in one place")
    return Grid({name: read_axis(name, values) for name, values in [*fixed.items(), *entries]})


def _from_toml(file: Path, content: str, fixed: Mapping[str, Value]) -> tuple[Source, dict[str, Any]]:
    data = tomllib.loads(content)
    grid, rows = data.pop("grid", None), data.pop("case", None)
    unknown = sorted(set(data) - {"model"})
    if unknown:
        raise InputError(f"{file}: unknown key '{unknown[0]}'; known are model, [grid] and [[case]]")
    if isinstance(grid, dict) and rows is None:
        return _grid(list(grid.items()), fixed), data
    if grid is None and isinstance(rows, list) and all(isinstance(row, dict) for row in rows):
        names = [name for row in rows for name in row]
        return Listed(names, ((f"case {place}", row) for place, row in enumerate(rows, start=1)), fixed), data
    raise InputError(f"{file}: give either one [grid] table or [[case]] tables")


def _from_csv(file: Path, content: str, fixed: Mapping[str, Value]) -> Listed:
    lines = [(at, line) for at, line in enumerate(content.splitlines(), start=1) if line.strip() and line[0] != "#"]
    if not lines:
        raise InputError(f"{file} is empty: the first line names the columns, each further one is a case")
    delimiter = ";" if ";" in lines[0][1] else ","
    (_, header), *body = [(at, next(csv.reader([line], delimiter=delimiter))) for at, line in lines]
    names = [name.partition("[")[0].strip() for name in header]
    units = [_unit(file, lines[0][0], name, heading) for name, heading in zip(names, header, strict=True)]
    twice = sorted({name for name in names if names.count(name) > 1 or not name})
    if twice:
        raise InputError(f"{file}, line {lines[0][0]}: column name '{twice[0]}' is empty or given twice")
    return Listed(names, _csv_cases(file, names, units, body), fixed)


def _unit(file: Path, line: int, name: str, heading: str) -> Convert:
    """How a cell becomes a value in the unit of its name; a unit that would be left out in silence is refused."""
    unit, quantity = split_heading(heading)[1], QUANTITIES.get({"w0": "width", "h0": "width"}.get(name, name))
    if unit is None or name in TEXT_NAMES:
        return str
    if quantity is None:
        if unit.lower() in OWN_UNITS:
            return str
        raise InputError(f"{file}, line {line}: unit '{unit}' of {name}: use {', '.join(OWN_UNITS)}, or leave it out")
    factor, shift = quantity.factor(unit), quantity.shift(unit)
    if factor is None:
        raise InputError(f"{file}, line {line}: unknown unit '{unit}' of {name}: use one of {', '.join(quantity.factors)}")
    return lambda cell: number(name, cell) * factor + shift if (factor, shift) != (1.0, 0.0) else cell


def _csv_cases(
    file: Path, names: Sequence[str], units: Sequence[Convert], body: Iterable[tuple[int, list[str]]]
) -> Iterator[tuple[str, dict[str, object]]]:
    for line, cells in body:
        if len(cells) != len(names):
            raise InputError(
                f"{file}, line {line}: {len(cells)} cells for {len(names)} columns: "
                "write a point in decimals, and quotes around a text with commas"
            )
        given = [(name, unit, cell.strip()) for name, unit, cell in zip(names, units, cells, strict=True) if cell.strip()]
        yield f"{file}, line {line}", {name: unit(cell) for name, unit, cell in given}


def _typed(row: Mapping[str, object], where: str) -> Row:
    """Texts as texts, everything else as numbers."""
    try:
        return {name: (text if name in TEXT_NAMES else number)(name, value) for name, value in row.items()}
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _sha256(entries: Iterable[str]) -> str:
    digest = hashlib.sha256()
    for entry in entries:
        digest.update(entry.encode() + b"\0")
    return digest.hexdigest()
