"""Thickness over time: counterparts of Figs. 2b, 6b and 8, and the figure of `plyflow law1d`."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import pandas as pd

from plyflow.case.programme import load_programme
from plyflow.law import integrate
from plyflow.paper.model import BASELINE, SCALE_UP, SIZES, Model
from plyflow.paper.paper_figure import MODEL_ONLY, TEMPERATURES, TIME_LABEL, PaperFigure, letter, temperature_bar
from plyflow.run.law_run import COMPARISON, CaseHistory
from plyflow.show.figure import LAW_LINE, panels, styled, svg, temperature_colour

MATERIAL, TEMPERATURE_6 = "IM7-8552", 70.0
THICKNESS_LABEL = "thickness [mm]"
DRAWN_IN_8 = (30.0, 50.0, 70.0, 90.0)
DASHES = {"CP": (0, (4, 2)), "BP": "-"}
MOST_LINES = 12
COMPARISON_DASHES = {"rogers": (0, (1, 2)), "wang_gutowski": (0, (4, 3))}


def figure_2b(model: Model) -> PaperFigure:
    """Thickness over time for BP and CP at all temperatures."""
    figure, (axes,) = panels(size=(5.6, 3.8))
    tables = []
    for layup, temperature in itertools.product(DASHES, TEMPERATURES):
        history = model.law_history(MATERIAL, temperature, layup, BASELINE)
        colour = temperature_colour(temperature)
        axes.plot(history["time_s"], history["thickness_mm"], color=colour, linestyle=DASHES[layup], linewidth=1.4)
        tables.append(history.assign(material=MATERIAL, temperature=temperature, layup=layup, width=BASELINE))
    for layup, dash in DASHES.items():
        axes.plot([], [], color="black", linestyle=dash, label=layup)
    axes.set(xlabel=TIME_LABEL, ylabel=THICKNESS_LABEL, xlim=(0.0, 1200.0))
    axes.legend(ncols=2, loc="upper right")
    temperature_bar(figure, [axes])
    caption = (
        "Thickness of 15 mm specimens of 16 plies of IM7-8552 over the ramp-dwell test, CP dashed, BP full, from 30 to "
        f"90 degC; one-dimensional law with Table 2. {MODEL_ONLY}"
    )
    return PaperFigure("2b", "Thickness vs. time for BP and CP, IM7-8552", caption, pd.concat(tables), figure)


def figure_6b(model: Model) -> PaperFigure:
    """Thickness over time of a BP specimen against the law with the parameters that section 3.2 finds."""
    found = model.creep_lines(TEMPERATURE_6, "BP").found()
    history = model.umat_history(MATERIAL, TEMPERATURE_6, "BP", BASELINE)
    load = load_programme("ramp-dwell", BASELINE)
    times = np.minimum(history["time_s"].to_numpy(), load.end)
    stack = history["thickness_mm"] / history["thickness_ratio"]
    fitted = stack * integrate(found, load, times).thickness_ratio
    table = history.assign(thickness_mm_found=fitted)
    figure, (axes,) = panels()
    colour = temperature_colour(TEMPERATURE_6)
    axes.plot(table["time_s"], table["thickness_mm"], "o", color=colour, markersize=3.5, label="UMAT, increments")
    axes.plot(table["time_s"], fitted, color="black", linewidth=1.0, label="law with the parameters found")
    axes.set(xlabel=TIME_LABEL, ylabel=THICKNESS_LABEL, xlim=(-15.0, 1200.0))
    axes.legend(loc="upper right")
    apart = 1e3 * (fitted - table["thickness_mm"])
    caption = (
        f"Thickness over time of a BP specimen of {MATERIAL}, 15 mm, {TEMPERATURE_6:g} degC: the UMAT in the place of "
        "the test, and the one-dimensional law with the k, a and b that section 3.2 finds from it (Fig. 6a). Largest "
        f"difference {apart.abs().max():.1f} um, at {table['time_s'][apart.abs().idxmax()]:.2g} s, and "
        f"{apart.iloc[-1]:+.2f} um at the end. {MODEL_ONLY}"
    )
    return PaperFigure("6b", "Thickness vs. time of a BP specimen, test and model", caption, table, figure)


def figure_8(model: Model) -> PaperFigure:
    """Predicted thickness over time: temperature, stacking sequence and size."""
    figure, axes = panels(2, (7.6, 5.8), rows=2, sharex=True, sharey=True)
    choices = list(itertools.product(("BP", "CP"), (BASELINE, SCALE_UP)))
    tables = []
    for (panel, (layup, width)), temperature in itertools.product(zip(axes, choices, strict=True), DRAWN_IN_8):
        history = model.umat_history(MATERIAL, temperature, layup, width)
        colour = temperature_colour(temperature)
        panel.plot(history["time_s"], history["thickness_mm"], color=colour, linewidth=3.0, alpha=0.65)
        panel.plot(history["time_s"], history["thickness_mm_1d"], **LAW_LINE)
        tables.append(history.assign(material=MATERIAL, temperature=temperature, layup=layup, width=width))
    letter(axes, [f"{layup}, {SIZES[width]}" for layup, width in choices])
    for panel in axes[::2]:
        panel.set_ylabel(THICKNESS_LABEL)
    for panel in axes[2:]:
        panel.set(xlabel=TIME_LABEL, xlim=(0.0, 1200.0))
    axes[0].plot([], [], color="grey", linewidth=3.0, alpha=0.65, label=model.marks)
    axes[0].plot([], [], label="one-dimensional law", **LAW_LINE)
    axes[0].legend(loc="upper right")
    temperature_bar(figure, axes, DRAWN_IN_8)
    table = pd.concat(tables)
    caption = (
        f"Predicted thickness of {MATERIAL} specimens over the ramp-dwell test, {model.marks} in colour, one-dimensional law "
        f"dashed, for blocked (BP) and cross-ply (CP) specimens of 15 and 30 mm. {model.words} Largest difference "
        f"{(table['thickness_ratio'] - table['thickness_ratio_1d']).abs().max():.1e} of h0. {MODEL_ONLY}"
    )
    return PaperFigure("8", "Simulation under ramp-dwell: temperature and sample size", caption, table, figure)


@styled
def history_figure(histories: Sequence[CaseHistory]) -> str:
    """SVG text: the law as solid lines, the comparison laws of each case dashed in its colour."""
    figure, (axes,) = panels(size=(6.4, 4.2))
    for place, history in enumerate(histories[:MOST_LINES]):
        table, colour = history.table(), f"C{place % 10}"
        axes.plot(table["time_s"], table["thickness_ratio"], color=colour, label=history.case.specimen)
        for name in history.comparison:
            values = table[f"thickness_ratio_{name}"]
            axes.plot(table["time_s"], values, color=colour, linestyle=COMPARISON_DASHES[name], linewidth=1.0)
    for name, dash in COMPARISON_DASHES.items():
        axes.plot([], [], color="black", linestyle=dash, linewidth=1.0, label=COMPARISON[name])
    axes.set(xlabel=TIME_LABEL, ylabel=r"thickness $h / h_0$ [-]")
    axes.legend()
    return svg(figure)
