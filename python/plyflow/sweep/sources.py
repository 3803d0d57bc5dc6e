"""Where the cases of a sweep come from: a grid, or a list in a TOML or CSV file; produced as they are needed."""

from __future__ import annotations

import csv
import hashlib
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import islice
from pathlib import Path
from typing import Protocol

from plyflow.errors import InputError
from plyflow.sweep.axes import TEXT_NAMES, Axis, Value, number, text

Row = dict[str, Value]


class Source(Protocol):
    """Cases in a fixed order."""

    @property
    def columns(self) -> tuple[str, ...]:
        """Names that the cases give, in order."""

    @property
    def digest(self) -> str:
        """SHA-256 of all cases."""

    def __len__(self) -> int: ...

    def texts(self, name: str) -> set[str]:
        """Different texts of a column."""

    def chunks(self, size: int) -> Iterator[list[Row]]:
        """All cases in order, so many at a time."""


class Grid:
    """Every combination of the axes, the last one running fastest."""

    def __init__(self, axes: Sequence[Axis]) -> None:
        self._axes = list(axes)
        self.columns = tuple(axis.name for axis in axes)

    def __len__(self) -> int:
        return math.prod(len(axis) for axis in self._axes)

    @cached_property
    def digest(self) -> str:
        """See `Source`: of the axes, which say it all."""
        values = (repr((axis.name, axis[place])) for axis in self._axes for place in range(len(axis)))
        return _sha256(values)

    def texts(self, name: str) -> set[str]:
        """See `Source`."""
        axis = next((one for one in self._axes if one.name == name), None)
        return set() if axis is None else {str(axis[place]) for place in range(len(axis))}

    def chunks(self, size: int) -> Iterator[list[Row]]:
        """See `Source`."""
        for start in range(0, len(self), size):
            yield [self._case(place) for place in range(start, min(start + size, len(self)))]

    def _case(self, place: int) -> Row:
        values: list[Value] = []
        for axis in reversed(self._axes):
            place, own = divmod(place, len(axis))
            values.append(axis[own])
        return dict(zip(self.columns, reversed(values), strict=True))


class Listed:
    """Cases one by one, as the [[case]] tables of a TOML file; names missing in a case take the fixed values."""

    def __init__(self, rows: Iterable[Mapping[str, object]], fixed: Mapping[str, Value]) -> None:
        self._rows = [dict(row) for row in rows]
        self._fixed = dict(fixed)
        named = dict.fromkeys(name for row in self._rows for name in row)
        self.columns = (*named, *(name for name in fixed if name not in named))
        self._size = sum(1 for _ in self._cases())  # a first pass, to find what is wrong before anything runs

    def __len__(self) -> int:
        return self._size

    @cached_property
    def digest(self) -> str:
        """See `Source`."""
        return _sha256(repr(tuple(row.items())) for row in self._cases())

    def texts(self, name: str) -> set[str]:
        """See `Source`."""
        return {str(row[name]) for row in self._cases() if name in row}

    def chunks(self, size: int) -> Iterator[list[Row]]:
        """See `Source`."""
        cases = self._cases()
        while chunk := list(islice(cases, size)):
            yield chunk

    def _cases(self) -> Iterator[Row]:
        for place, row in enumerate(self._rows, start=1):
            yield self._fixed | _typed(row, f"case {place}")


class CsvList(Listed):
    """Cases of a CSV file, a row each, read again for each pass; empty cells take the fixed or default value.

    The header names the columns, a unit in brackets is left out; lines that start with # are comments; columns are
    separated by commas, or by semicolons if the header has some.

    Raises
    ------
    InputError
        The file cannot be read or is empty; a cell is no number or too many: the message names the line.
    """

    def __init__(self, path: Path, fixed: Mapping[str, Value]) -> None:
        self._path = path
        header = next(self._lines(), None)
        if header is None:
            raise InputError(f"{path} is empty: the first line names the columns, each further one is a case")
        names = tuple(name.partition("[")[0].strip() for name in header[1])
        twice = sorted({name for name in names if names.count(name) > 1 or not name})
        if twice:
            raise InputError(f"{path}, line {header[0]}: column name '{twice[0]}' is empty or given twice")
        self._names = names
        self._fixed = dict(fixed)
        self.columns = (*names, *(name for name in fixed if name not in names))
        self._size = sum(1 for _ in self._cases())

    def _cases(self) -> Iterator[Row]:
        for line, cells in islice(self._lines(), 1, None):
            if len(cells) != len(self._names):
                raise InputError(
                    f"{self._path}, line {line}: {len(cells)} cells for {len(self._names)} columns: "
                    "write a point in decimals, and quotes around a text with commas"
                )
            given = {name: cell.strip() for name, cell in zip(self._names, cells, strict=True) if cell.strip()}
            yield self._fixed | _typed(given, f"{self._path}, line {line}")

    def _lines(self) -> Iterator[tuple[int, list[str]]]:
        try:
            with self._path.open(encoding="utf-8-sig", newline="") as stream:
                kept = ((at, words) for at, words in enumerate(stream, start=1) if words.strip() and words[0] != "#")
                delimiter = ""
                for line, words in kept:
                    delimiter = delimiter or (";" if ";" in words else ",")
                    yield line, next(csv.reader([words], delimiter=delimiter))
        except OSError as error:
            raise InputError(f"{self._path} cannot be read: {error.strerror}") from error
        except (UnicodeDecodeError, csv.Error) as error:
            raise InputError(f"{self._path} is no CSV file: {error}") from error


def _typed(row: Mapping[str, object], where: str) -> Row:
    """Texts as texts, everything else as numbers."""
    try:
        return {name: (text if name in TEXT_NAMES else number)(name, value) for name, value in row.items()}
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _sha256(entries: Iterable[str]) -> str:
    digest = hashlib.sha256()
    for entry in entries:
        digest.update(entry.encode())
        digest.update(b"\0")
    return digest.hexdigest()
