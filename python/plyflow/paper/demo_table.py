"""The result table: for the terminal, as CSV, and its largest differences."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

import pandas as pd
from rich import box
from rich.table import Table

from plyflow.run.case_run import RunResult


def results_table(results: Sequence[RunResult]) -> pd.DataFrame:
    """One row a case: case, final ratios of UMAT and law, differences, counts, run time [s]."""
    rows = []
    for result in results:
        summary = result.summary()
        row = {name: summary[name] for name in ("material", "temperature", "layup", "width", "load")}
        for quantity in ("thickness", "width"):
            umat, law = summary[f"{quantity}_ratio_final"], summary[f"{quantity}_ratio_1d"]
            row |= {
                f"{quantity}_ratio": umat,
                f"{quantity}_ratio_1d": law,
                f"{quantity}_difference": umat - law,
            }
        row |= {name: summary[name] for name in ("increments", "iterations", "cutbacks", "run_time_s")}
        rows.append(row)
    return pd.DataFrame(rows)


def largest_difference(table: pd.DataFrame, quantity: str) -> tuple[float, str]:
    """Largest |UMAT - law| of "thickness" or "width" [-] and the case it belongs to."""
    column = table[f"{quantity}_difference"].abs()
    row = table.loc[column.idxmax()]
    case = f"{row['material']} {row['temperature']:g} degC {row['layup']} {row['width']:g} mm"
    return float(column.max()), case


def rich_tables(table: pd.DataFrame) -> list[Table]:
    """Lay out the results for the terminal, a table for each material and width, 80 columns at most."""
    blocks = table.groupby(["material", "width"], sort=False)
    return [_rich_block(f"{material}, {width:g} mm", rows) for (material, width), rows in blocks]


def _rich_block(title: str, rows: pd.DataFrame) -> Table:
    shown = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 0))
    shown.add_column("layup", no_wrap=True)
    headings = ("degC", "h/h0", "1D", "diff.", "w/w0", "1D", "diff.", "incr.", "iter.", "cutb.")
    for heading in headings:
        shown.add_column(heading, justify="right", no_wrap=True)
    previous = None
    for row in rows.to_dict("records"):
        if previous not in (None, row["layup"]):
            shown.add_section()
        shown.add_row("" if row["layup"] == previous else row["layup"], *_cells(row))
        previous = row["layup"]
    return shown


def _cells(row: Mapping[Hashable, Any]) -> list[str]:
    cells = [f"{row['temperature']:g}"]
    for quantity in ("thickness", "width"):
        cells += [f"{row[f'{quantity}_ratio']:.4f}", f"{row[f'{quantity}_ratio_1d']:.4f}"]
        cells.append(f"{row[f'{quantity}_difference']:+.1e}")
    return cells + [str(row[name]) for name in ("increments", "iterations", "cutbacks")]
