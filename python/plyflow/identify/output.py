"""What `plyflow identify` does with a fit: groups of specimens, files, the table on the screen."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from rich.console import Console

from plyflow.errors import RunError
from plyflow.identify.figure import curves_figure, lines_figure, valley_figure
from plyflow.identify.judged import judge, offset_hint
from plyflow.identify.model import NAMES
from plyflow.identify.refine import Fit, fit
from plyflow.identify.report import curves_table, fit_data, material_text
from plyflow.identify.specimen import Specimen, names_of
from plyflow.identify.suggest import Suggestion
from plyflow.identify.valley import planes, planes_table
from plyflow.show.progress import progress
from plyflow.show.table import Column, Table

MOST_SUGGESTED = 6


def fit_groups(
    specimens: Sequence[Specimen], apart: bool, tie: str, intervals: str, console: Console, offset: bool = False
) -> list[Fit]:
    """Fit the specimens of one temperature together, or each by itself, with a progress bar; see `refine.fit`."""
    if apart:
        groups = [[specimen] for specimen in specimens]
    else:
        temperatures = sorted({one.geometry.temperature for one in specimens})
        groups = [[one for one in specimens if one.geometry.temperature == found] for found in temperatures]
    fits = []
    with progress(console, "fits", len(groups), transient=True) as advance:
        for group in groups:
            fits.append(fit(group, tie, intervals, offset))
            advance()
    return fits


def doubts(fits: Sequence[Fit], tie: str) -> list[str]:
    """What the fits do not know, in words: parameters left open, curves that the law does not follow, what would explain it."""
    told = []
    for one in fits:
        verdict, names = judge(one), names_of(one.specimens)
        told += [f"{name} is not determined by {names}: {reason}" for name, reason in verdict.open.items()]
        told += [f"{names}: {verdict.valley}"] if verdict.valley else []
        told += verdict.misfit
        hint = offset_hint(one, one.specimens, tie) if verdict.misfit else ""
        told += [f"{names}: {hint}"] if hint else []
    return told


def result_files(material: str, fits: Sequence[Fit], apart: bool, sound: bool = True) -> dict[str, str]:
    """Files of the fits by name; those of a single fit lie in the folder itself, else each in its own.

    Without a material where the fits are not `sound`: others would take its numbers as known.
    """
    contents: dict[str, str] = {}
    if sound and (not apart or len(fits) == 1):
        contents["material.toml"] = material_text(material, fits)
    for one, folder in zip(fits, folders(fits, apart), strict=True):
        if sound and folder and apart:
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
        found = [] if judge(one).open else planes(one)
        if not found:
            raise RunError("parameters are not determined")
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
        rows = [
            [name, data[name]["value"], *data[name]["interval"], _by_lines(name, lines)]
            if data[name]["value"] is not None
            else [name, "not determined", None, None, None]
            for name in NAMES
        ]
        console.print(Table(["", *numbers], rows, title=names_of(one.specimens)).rich())
        console.print(f"scatter {one.scatter * 1e3:.2f} um over {data['readings']} readings", highlight=False)
        _print_list(console, data["notes"])
    console.print("Assumptions", style="bold")
    _print_list(console, list(dict.fromkeys(line for data in told for line in data["assumptions"])))


def show_suggestions(found: Sequence[Suggestion], console: Console) -> None:
    """Print the tests that would narrow the intervals most."""
    names = list(found[0].now)
    columns = [Column("next test", wrap=True), Column("intervals", ".2f"), *(Column(f"+- {name}", ".2g") for name in names)]
    rows: list[list[Any]] = [
        [
            f"{one.layup} {one.width:g} mm {one.load} {one.length:g} s at {one.temperature:g} degC",
            one.ratio,
            *(one.then[name] for name in names),
        ]
        for one in found[:MOST_SUGGESTED]
    ]
    console.print(Table(columns, [["as it is", 1.0, *found[0].now.values()], *rows], "what a next test would give").rich())
    said = (
        "intervals: half widths over those of now, geometric mean over the parameters; by Fisher's information at the fitted "
        "values with the scatter found and readings as often as in these tests; a test says nothing of other temperatures"
    )
    console.print(said, highlight=False)


def _print_list(console: Console, lines: Sequence[str]) -> None:
    for line in lines:
        console.print(f"  - {line}", highlight=False, markup=False)


def _by_lines(parameter: str, lines: dict[str, Any]) -> float | None:
    """The parameter by section 3.2; a is that of the bleed stage."""
    stage, name = ("squeeze", "b") if parameter == "b_squeeze" else ("bleed", parameter[0])
    found: float | None = lines.get("k") if parameter == "k" else lines.get(stage, {}).get(name)
    return found
