"""What `plyflow identify` does with a fit: groups of specimens, files, the table on the screen."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.progress import track
from rich.table import Table

from plyflow.errors import RunError
from plyflow.identify.figure import curves_figure, lines_figure, valley_figure
from plyflow.identify.model import NAMES
from plyflow.identify.refine import Fit, fit
from plyflow.identify.report import curves_table, fit_data, material_text
from plyflow.identify.specimen import Specimen
from plyflow.identify.valley import planes, planes_table


def grouped(specimens: Sequence[Specimen], apart: bool) -> list[list[Specimen]]:
    """Specimens to be fitted together: those of one temperature, or each by itself."""
    if apart:
        return [[specimen] for specimen in specimens]
    groups: dict[float, list[Specimen]] = {}
    for specimen in specimens:
        groups.setdefault(specimen.geometry.temperature, []).append(specimen)
    return [groups[temperature] for temperature in sorted(groups)]


def fit_groups(specimens: Sequence[Specimen], apart: bool, tie: str, intervals: str, console: Console) -> list[Fit]:
    """Fit every group of specimens, with a progress bar if the console is a terminal; see `refine.fit`."""
    groups = grouped(specimens, apart)
    shown = track(groups, "fits", console=console, transient=True, disable=not console.is_terminal or len(groups) == 1)
    return [fit(group, tie, intervals) for group in shown]


def result_files(material: str, fits: Sequence[Fit], apart: bool) -> dict[str, str]:
    """Files of the fits by name; those of a single fit lie in the folder itself, else each in its own."""
    contents: dict[str, str] = {}
    if not apart or len(fits) == 1:
        contents["material.toml"] = material_text(material, fits)
    for one, folder in zip(fits, folders(fits, apart), strict=True):
        if folder and apart:
            contents[f"{folder}material.toml"] = material_text(material, [one])
        contents |= {f"{folder}{file}": text for file, text in fit_files(one).items()}
    return contents


def folders(fits: Sequence[Fit], apart: bool) -> list[str]:
    """A folder for each fit, "" for a single one: by the name of the specimen if apart, else by the temperature."""
    if len(fits) == 1:
        return [""]
    found: list[str] = []
    for one in fits:
        first = one.specimens[0]
        name = first.name if apart else f"{first.geometry.temperature:g}degC"
        free = (f"{name}{ending}/" for ending in ("", *(f"-{number}" for number in range(2, len(fits) + 1))))
        found.append(next(folder for folder in free if folder not in found))
    return found


def fit_files(one: Fit) -> dict[str, str]:
    """Data and pictures of one fit by name; no picture of the correlation where the law cannot be followed around it."""
    data = fit_data(one)
    contents = {
        "curves.csv": curves_table(one).to_csv(index=False, lineterminator="\n"),
        "curves.svg": curves_figure(one),
    }
    try:
        found = planes(one)
        contents["correlation.csv"] = planes_table(found).to_csv(index=False, lineterminator="\n")
        contents["correlation.svg"] = valley_figure(one, found)
    except RunError as error:
        data["notes"].append(f"no picture of the correlation: {error}")
    if one.lines is not None:
        contents["lines.svg"] = lines_figure(one.lines)
    return {"fit.json": json.dumps(data, indent=2, allow_nan=False) + "\n"} | contents


def show(fits: Sequence[Fit], console: Console) -> None:
    """Print every fit: parameters, intervals, the start by straight lines, what it rests on."""
    for one in fits:
        data = fit_data(one)
        names = ", ".join(specimen.name for specimen in one.specimens)
        table = Table(title=names, title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1))
        for heading in ("", "value", "95 % joint, from", "to", "straight lines"):
            table.add_column(heading, justify="left" if not heading else "right")
        for parameter in NAMES:
            estimate = one.estimates[parameter]
            cells = (f"{value:.5f}" for value in (estimate.value, estimate.low, estimate.high))
            table.add_row(parameter, *cells, _by_lines(parameter, data["straight_lines"]))
        console.print(table)
        console.print(f"scatter {one.scatter * 1e3:.2f} um over {data['readings']} readings", highlight=False)
        for line in data["notes"]:
            console.print(f"  - {line}", highlight=False, markup=False)
    console.print("Assumptions", style="bold")
    for line in dict.fromkeys(line for one in fits for line in fit_data(one)["assumptions"]):
        console.print(f"  - {line}", highlight=False, markup=False)


def _by_lines(parameter: str, lines: dict[str, Any] | None) -> str:
    if lines is None:
        return ""
    if parameter == "k":
        return f"{lines['k']:.5f}"
    stage = lines.get("squeeze" if parameter == "b_squeeze" else "bleed")
    return "" if stage is None else f"{stage['a' if parameter == 'a' else 'b']:.5f}"
