"""What `plyflow identify` does with a fit: groups of specimens, files, the table on the screen."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from rich.console import Console

from plyflow.errors import RunError
from plyflow.identify.figure import curves_figure, lines_figure, valley_figure
from plyflow.identify.model import NAMES
from plyflow.identify.refine import Fit, fit
from plyflow.identify.report import curves_table, fit_data, material_text
from plyflow.identify.specimen import Specimen, names_of
from plyflow.identify.valley import planes, planes_table
from plyflow.show.progress import progress
from plyflow.show.table import Column, Table


def fit_groups(specimens: Sequence[Specimen], apart: bool, tie: str, intervals: str, console: Console) -> list[Fit]:
    """Fit the specimens of one temperature together, or each by itself, with a progress bar; see `refine.fit`."""
    if apart:
        groups = [[specimen] for specimen in specimens]
    else:
        temperatures = sorted({one.geometry.temperature for one in specimens})
        groups = [[one for one in specimens if one.geometry.temperature == found] for found in temperatures]
    fits = []
    with progress(console, "fits", len(groups), transient=True) as advance:
        for group in groups:
            fits.append(fit(group, tie, intervals))
            advance()
    return fits


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
    told = [fit_data(one) for one in fits]
    numbers = [Column(heading, ".5f") for heading in ("value", "95 % joint, from", "to", "straight lines")]
    for one, data in zip(fits, told, strict=True):
        lines = data["straight_lines"] or {}
        rows = [[name, data[name]["value"], *data[name]["interval"], _by_lines(name, lines)] for name in NAMES]
        console.print(Table(["", *numbers], rows, title=names_of(one.specimens)).rich())
        console.print(f"scatter {one.scatter * 1e3:.2f} um over {data['readings']} readings", highlight=False)
        _print_list(console, data["notes"])
    console.print("Assumptions", style="bold")
    _print_list(console, list(dict.fromkeys(line for data in told for line in data["assumptions"])))


def _print_list(console: Console, lines: Sequence[str]) -> None:
    for line in lines:
        console.print(f"  - {line}", highlight=False, markup=False)


def _by_lines(parameter: str, lines: dict[str, Any]) -> float | None:
    """The parameter by section 3.2; a is that of the bleed stage."""
    stage, name = ("squeeze", "b") if parameter == "b_squeeze" else ("bleed", parameter[0])
    found: float | None = lines.get("k") if parameter == "k" else lines.get(stage, {}).get(name)
    return found
