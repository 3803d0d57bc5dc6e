"""The one table: columns and rows, shown on the terminal (Rich), on a page (HTML) and written as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any, ClassVar, Literal

from rich import box
from rich.table import Table as RichTable
from rich.text import Text

# Colour by meaning: on the terminal a style of Rich, on the page the class of the style sheet with the same name.
TONES = {"good": "green", "info": "cyan", "warn": "yellow", "bad": "bold red", "soft": "dim", "strong": "bold"}
WORDS = 12  # characters that a column of words keeps at least on a narrow terminal


@dataclass(frozen=True)
class Column:
    """One column.

    Parameters
    ----------
    heading, unit : str
        Shown as "heading [unit]".
    format : str or callable
        Format specification such as ".4f" for the numbers of the column, or a function of any value; words and None
        ("") pass a specification by.
    key : str
        Name in rows that are mappings, and in the CSV file; the heading if empty.
    align : str
        "left" or "right"; if empty right where the format is a specification.
    wrap : bool
        Whether long words may break into lines.
    over : str
        Heading above this column and its neighbours of the same `over` (on the page).
    """

    heading: str
    format: str | Callable[[Any], str] = ""
    unit: str = ""
    key: str = ""
    align: Literal["", "left", "right"] = ""
    wrap: bool = False
    over: str = ""

    @property
    def name(self) -> str:
        """Key of the column in mappings and CSV."""
        return self.key or self.heading

    @property
    def title(self) -> str:
        """Heading with unit."""
        return f"{self.heading} [{self.unit}]" if self.unit else self.heading

    @property
    def side(self) -> Literal["left", "right"]:
        """Alignment."""
        return self.align or ("right" if self.format and isinstance(self.format, str) else "left")

    def text(self, value: Any) -> str:
        """A value as it is shown; HTML that is marked safe stays so."""
        if callable(self.format):
            return self.format(value)
        if value is None:
            return ""
        return value if isinstance(value, str) else format(value, self.format)


@dataclass(frozen=True)
class Cell:
    """A cell that is more than its value: tone (see `TONES`), a small line below, columns spanned, link."""

    value: Any = ""
    tone: str = ""
    small: str = ""
    span: int = 1
    link: str = ""


class Table:
    """Columns and rows.

    Parameters
    ----------
    columns : sequence of Column or str
        A heading alone is a column of words.
    rows : iterable
        Sequences in the order of the columns or mappings by their names; an entry is a value or a `Cell`.
    title : str
        Above the table.
    once : str
        Name of a column whose value is shown only where it changes, with a line between (on the terminal).
    padding : int
        Blanks beside each cell (on the terminal).
    """

    kind: ClassVar[str] = "table"

    def __init__(
        self,
        columns: Sequence[Column | str],
        rows: Iterable[Sequence[Any] | Mapping[Any, Any]],
        title: str = "",
        once: str = "",
        padding: int = 1,
    ) -> None:
        self.columns = [Column(one) if isinstance(one, str) else one for one in columns]
        self.rows = [
            [row.get(column.name) for column in self.columns] if isinstance(row, Mapping) else list(row) for row in rows
        ]
        self.title, self.once, self.padding = title, once, padding

    @property
    def cells(self) -> list[list[tuple[Column, Cell]]]:
        """Rows of cells, each with its column and its value as shown."""
        return [list(_placed(self.columns, row)) for row in self.rows]

    @property
    def over(self) -> list[tuple[str, int]]:
        """Headings above the columns and how many each spans; empty if there are none."""
        spans = [(name, len(list(own))) for name, own in groupby(self.columns, lambda column: column.over)]
        return spans if any(name for name, _ in spans) else []

    def rich(self) -> RichTable:
        """The table for the terminal."""
        shown = RichTable(title=self.title or None, title_justify="left", box=box.SIMPLE_HEAD, padding=(0, self.padding))
        for column in self.columns:
            number = column.side == "right"  # its heading may wrap, its values never
            longest = max((len(cell.value) for row in self.cells for own, cell in row if own is column), default=0)
            least = longest if number else min(WORDS, longest) if column.wrap else None
            shown.add_column(column.title, justify=column.side, no_wrap=not (number or column.wrap), min_width=least)
        place = [column.name for column in self.columns].index(self.once) if self.once else -1
        previous = None
        for row in self.cells:
            texts = [_rich_text(cell) for _, cell in row]
            if self.once and previous == (previous := row[place][1].value):
                texts[place] = Text()
            elif self.once and shown.rows:
                shown.add_section()
            shown.add_row(*texts)
        return shown

    def csv(self) -> str:
        """Names and values as comma separated text, numbers in full."""
        stream = io.StringIO()
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(column.name for column in self.columns)
        writer.writerows([entry.value if isinstance(entry, Cell) else entry for entry in row] for row in self.rows)
        return stream.getvalue()


def _placed(columns: Sequence[Column], row: Sequence[Any]) -> Iterable[tuple[Column, Cell]]:
    place = 0
    for entry in row:
        cell = entry if isinstance(entry, Cell) else Cell(entry)
        yield columns[place], replace(cell, value=columns[place].text(cell.value))
        place += cell.span


def _rich_text(cell: Cell) -> Text:
    text = Text(cell.value, TONES.get(cell.tone, ""))
    return text.append(f"\n{cell.small}", "dim") if cell.small else text
