"""Table, figures and page of the compaction programme; UMAT as solid lines or marks, one-dimensional law dashed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from plyflow.case.assumptions import default_assumptions
from plyflow.paper.paper_figure import LAYUP_NAMES, LAYUP_STYLES, TEMPERATURE_LABEL, TIME_LABEL, legend_below
from plyflow.run.case_run import RunResult
from plyflow.show.figure import LAW_LINE, SMALL, panels, styled, svg, temperature_colour
from plyflow.show.page import Block, Card, Gallery, Items, Page, Picture, Section
from plyflow.show.table import Column, Table

NAMES = ("material", "temperature", "layup", "width")
COLUMNS = (
    Column("layup"), Column("degC", "g", key="temperature"),
    Column("h/h0", ".4f", key="thickness_ratio"), Column("1D", ".4f", key="thickness_ratio_1d"),
    Column("diff.", "+.1e", key="thickness_difference"),
    Column("w/w0", ".4f", key="width_ratio"), Column("1D", ".4f", key="width_ratio_1d"),
    Column("diff.", "+.1e", key="width_difference"),
    Column("incr.", "d", key="increments"), Column("iter.", "d", key="iterations"), Column("cutb.", "d", key="cutbacks"),
)  # fmt: skip
LEAD = (
    "A generated UMAT, driven at a material point through the compaction tests of Belnoue et al. (2016), beside the "
    "one-dimensional law it was derived from (Eqs. 1 to 6 there), integrated to 1e-12."
)
TABLE_WORDS = "h/h0 and w/w0 at the end of the load, by the UMAT and by the one-dimensional law (1D); difference = UMAT minus law."
LIMITS = (
    "One material point: uniform deformation, no friction at the plates, no interaction between blocks.",
    "The one-dimensional law is what the UMAT must reproduce; it is not a measurement, and no measured points are shown.",
    "gamma_lock is that of Eq. A.1 read with arctan; l0/d and the bulk lock strain are not in the paper: what is used "
    "moves both the UMAT and the law.",
    "The parameters come from cross-ply specimens of 15 mm between 30 and 90 degC; blocked plies and 30 mm specimens use "
    "the same parameters.",
    "Isothermal, no cure; the fibre is held inextensible, so the fibre modulus does not enter.",
)


def results_table(results: Sequence[RunResult]) -> pd.DataFrame:
    """One row a case: case, final ratios of UMAT and law, differences, counts, run time [s]."""
    rows = []
    for summary in (result.summary() for result in results):
        row = {name: summary[name] for name in (*NAMES, "load")}
        for quantity in ("thickness", "width"):
            umat, law = summary[f"{quantity}_ratio_final"], summary[f"{quantity}_ratio_1d"]
            ratio = f"{quantity}_ratio"
            row |= {ratio: umat, f"{ratio}_1d": law, f"{quantity}_difference": umat - law}
        rows.append(row | {name: summary[name] for name in ("increments", "iterations", "cutbacks", "run_time_s")})
    return pd.DataFrame(rows)


def shown_tables(table: pd.DataFrame) -> list[Table]:
    """The results, a table for each material and width, 80 columns at most on the terminal."""
    blocks = table.groupby(["material", "width"], sort=False)
    return [
        Table(COLUMNS, rows.to_dict("records"), f"{material}, {width:g} mm", once="layup", padding=0)
        for (material, width), rows in blocks
    ]


def largest_difference(table: pd.DataFrame, quantity: str) -> tuple[str, str]:
    """Largest |UMAT - law| of "thickness" or "width" [-] and the case it belongs to."""
    column = table[f"{quantity}_difference"].abs()
    row = table.loc[column.idxmax()]
    return f"{column.max():.1e}", f"{row['material']} {row['temperature']:g} degC {row['layup']} {row['width']:g} mm"


def demo_files(
    results: Sequence[RunResult], table: pd.DataFrame, failures: Mapping[str, str], timing: Mapping[str, Any]
) -> dict[str, Any]:
    """Every file of the demo by name, the report first; timing: lines to print (what) with how long."""
    galleries = all_pictures(results)
    histories = pd.concat(
        [one.history_table().assign(**{name: getattr(one.case, name) for name in NAMES}) for one in results],
        ignore_index=True,
    )
    return {
        "report.html": report_page(results, table, galleries, failures, timing),
        "results.csv": table,
        "histories.csv": histories,
    } | {f"figures/{name}.svg": picture.svg for pictures in galleries.values() for name, picture in pictures.items()}


def report_page(
    results: Sequence[RunResult],
    table: pd.DataFrame,
    galleries: Mapping[str, Mapping[str, Picture]],
    failures: Mapping[str, str],
    timing: Mapping[str, Any],
) -> str:
    """The report as HTML text."""
    totals = " / ".join(str(table[name].sum()) for name in ("increments", "iterations", "cutbacks"))
    finished = Card(f"{len(results)} of {len(results) + len(failures)}", "cases finished", "bad" if failures else "good")
    found = {quantity: largest_difference(table, quantity) for quantity in ("thickness", "width")}
    largest = [Card(value, f"largest {name} difference to the 1D law: {case}") for name, (value, case) in found.items()]
    reasons = Items([f"{case}: {reason}" for case, reason in failures.items()])
    sections: list[Block] = [Section("Cases that did not finish", [reasons])] if failures else []
    sections += [Section(title, [Gallery(list(pictures.values()))]) for title, pictures in galleries.items()]
    shared = set.intersection(*(set(result.assumptions) for result in results))
    return Page(
        f"The compaction programme, {len(table)} cases",
        LEAD,
        [*sections, Section("All cases", [TABLE_WORDS, *shown_tables(table)])],
        [finished, *largest, Card(totals, "increments / iterations / cutbacks, all cases")],
        [
            f"{default_assumptions()['gamma_lock']}",
            *(line for line in results[0].assumptions if line in shared),
            lock_strain_line(results),
        ],
        [*LIMITS, *width_notes(results)],
        {name: value for name, value in results[0].provenance.items() if name != "inputs"} | dict(timing),
    ).html()


def lock_strain_line(results: Sequence[RunResult]) -> str:
    """Range of eps_lock [-] over the cases."""
    strains = [result.values["eps_lock"] for result in results]
    return f"eps_lock, by Eq. 6 for each block's geometry: {max(strains):.4f} to {min(strains):.4f}"


def width_notes(results: Sequence[RunResult]) -> list[str]:
    """What to know about the final widths when every case has locked."""
    if any(result.lock_time is None for result in results):
        return []
    return [
        "Every case reaches the lock, so its final width is exp(-eps_lock) and depends on geometry alone; "
        "the paper reports widths of blocked plies that rise with temperature to a plateau near 70 degC."
    ]


def all_pictures(results: Sequence[RunResult]) -> dict[str, dict[str, Picture]]:
    """Every figure by group and file name: final thickness and width over temperature, thickness over time."""
    galleries: dict[str, dict[str, Picture]] = {}
    for quantity in ("thickness", "width"):
        values = [getattr(result, f"{quantity}_ratio")[-1] for result in results]
        margin = 0.06 * (max(values) - min(values)) + 1e-3
        pictures = galleries[f"Final {quantity} over temperature"] = {}
        for group in _groups(results, "material", "width"):
            case = group[0].case
            caption = (
                f"{case.material}, {case.width:g} mm, {case.load}: final {quantity} over temperature, "
                "UMAT (marks) and one-dimensional law (dashed)."
            )
            figure = final_figure(group, quantity, (min(values) - margin, max(values) + margin))
            pictures[f"{quantity}-final-{case.material.lower()}-{case.width:g}"] = Picture(svg(figure), caption)
    bottom = min(float(result.thickness_ratio[-1]) for result in results) - 0.02
    pictures = galleries["Thickness over time"] = {}
    for group in _groups(results, "material", "width", "layup"):
        case = group[0].case
        caption = (
            f"{case.material}, {LAYUP_NAMES[case.layup]} ({case.layup}), {case.width:g} mm, {case.load}: "
            "thickness over time, UMAT (colour) and one-dimensional law (dashed)."
        )
        name = f"thickness-time-{case.material.lower()}-{case.layup.lower()}-{case.width:g}"
        pictures[name] = Picture(svg(time_figure(group, bottom)), caption)
    return galleries


def _groups(results: Sequence[RunResult], *names: str) -> list[list[RunResult]]:
    groups: dict[tuple[Any, ...], list[RunResult]] = {}
    for one in results:
        groups.setdefault(tuple(getattr(one.case, name) for name in names), []).append(one)
    return list(groups.values())


@styled
def time_figure(group: Sequence[RunResult], bottom: float) -> Figure:
    """Thickness over time of the cases of one stack, from `bottom` [-] up; the legend stands below the axes."""
    case = group[0].case
    figure, (axes,) = panels(size=SMALL)
    temperatures = [result.case.temperature for result in group]
    for result in group:
        colour = temperature_colour(result.case.temperature, min(temperatures), max(temperatures))
        label = f"{result.case.temperature:g} °C"
        axes.plot(result.history.time, result.thickness_ratio, color=colour, linewidth=3.0, alpha=0.65, label=label)
        axes.plot(result.law.time, result.law.thickness_ratio, **LAW_LINE)
    axes.set(xlabel=TIME_LABEL, ylabel=r"thickness $h / h_0$ [-]", ylim=(bottom, 1.005))
    axes.set(xlim=(0.0, case.load_programme.end), title=f"{case.material}, {case.layup}, {case.width:g} mm")
    handles = [*axes.get_legend_handles_labels()[0], Line2D([], [], label="1D law", **LAW_LINE)]
    figure.legend(handles=handles, ncols=4, loc="outside lower center")
    return figure


@styled
def final_figure(group: Sequence[RunResult], quantity: str, limits: tuple[float, float]) -> Figure:
    """Final thickness or width over temperature of the cases of one material and width."""
    case = group[0].case
    figure, (axes,) = panels(size=SMALL)
    for layup in _groups(group, "layup"):
        name = layup[0].case.layup
        colour, marker = LAYUP_STYLES[name]
        temperatures = [result.case.temperature for result in layup]
        umat, law = ([getattr(one, f"{quantity}_ratio")[-1] for one in ones] for ones in (layup, [r.law for r in layup]))
        axes.plot(temperatures, umat, color=colour, marker=marker, linestyle="none", label=f"{name} UMAT")
        axes.plot(temperatures, law, color=colour, linestyle=(0, (4, 3)), linewidth=1.2, label=f"{name} 1D law")
    ratio = "$h / h_0$" if quantity == "thickness" else "$w / w_0$"
    axes.set(xlabel=TEMPERATURE_LABEL, ylabel=f"final {quantity} {ratio} [-]", ylim=limits)
    axes.set_title(f"{case.material}, {case.width:g} mm")
    legend_below(figure, axes, 3)
    return figure
