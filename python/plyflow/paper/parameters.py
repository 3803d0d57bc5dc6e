"""Counterparts of Figs. 6a and 7: the log-log diagram of section 3.2, and the parameters over temperature."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from plyflow.case.materials import known_materials
from plyflow.law import Stage
from plyflow.paper.model import LAYUPS, Model
from plyflow.paper.over_time import MATERIAL, TEMPERATURE_6
from plyflow.paper.paper_figure import LAYUP_STYLES, MODEL_ONLY, TEMPERATURE_LABEL, PaperFigure, legend_below
from plyflow.show.figure import BLUE, RED, panels

STAGES = {Stage.SQUEEZE: ("squeeze", RED, "s"), Stage.BLEED: ("bleed", BLUE, "o")}
PARAMETERS = {"k": "$k$ [-]", "a": "$a$ [-]", "b_squeeze": "$b$, squeeze", "b_bleed": "$b$, bleed"}


def figure_6a(model: Model) -> PaperFigure:
    """Log-log diagram of a BP specimen for the k that makes it straight."""
    lines = model.creep_lines(TEMPERATURE_6, "BP")
    figure, (axes,) = panels()
    for stage, line in lines.lines.items():
        name, colour, marker = STAGES[stage]
        ends = np.array([line.rate.min(), line.rate.max()])
        axes.loglog(line.rate, line.ratio, marker, color=colour, markersize=4, alpha=0.7)
        label = f"{name}: $a$ = {line.a:.3f}, $b$ = {line.b:.2f}"
        axes.loglog(ends, np.exp(line.b) * ends**line.a, color=colour, linewidth=1.2, label=label)
    axes.set(xlabel=r"rate $-\dot\varepsilon$ [1/s]", ylabel=r"$p \, / \, (-\dot\varepsilon\,\eta_{ply}\,\eta_{micro})$")
    axes.legend(loc="center right", title=f"$k$ = {lines.k:.4f}", alignment="left")
    worst = min(line.r_squared for line in lines.lines.values())
    law = lines.law
    caption = (
        f"Log-log diagram of section 3.2 for a BP specimen of {MATERIAL}, 15 mm, {TEMPERATURE_6:g} degC. Points: "
        f"increments of the UMAT's ramp-dwell run. k = {lines.k:.4f} makes both stages straight (coefficients of "
        f"determination at least 1 - {1.0 - worst:.0e}); put in were k = {law.k:g}, a = {law.a:g}, b = {law.b_squeeze:g} "
        f"and {law.b_bleed:g}. {MODEL_ONLY}"
    )
    original = "Log-log diagram for BP specimens with adjusted k"
    return PaperFigure("6a", original, caption, lines.table(), figure)


def figure_7(model: Model) -> PaperFigure:
    """k, a, b against temperature: what section 3.2 finds from each layup, on the columns of Table 2."""
    rows: list[dict[str, Any]] = []
    for (temperature, layup), lines in model.lines.items():
        for name in PARAMETERS:
            found, put_in = getattr(lines.found(), name), getattr(lines.law, name)
            entry = {"temperature": temperature, "layup": layup, "parameter": name, "found": found, "put_in": put_in}
            rows.append({"material": MATERIAL} | entry)
    table = pd.DataFrame(rows)
    figure, axes = panels(2, (7.6, 5.4), rows=2, sharex=True)
    for panel, (name, label) in zip(axes, PARAMETERS.items(), strict=True):
        _draw_parameter(panel, table[table["parameter"] == name], name, bool(model.settings))
        panel.set_ylabel(label)
    for panel in axes[2:]:
        panel.set_xlabel(TEMPERATURE_LABEL)
    legend_below(figure, axes[0], 4)
    worst = (table["found"] - table["put_in"]).abs().groupby(table["parameter"]).max()
    caption = (
        f"k, a, b of {MATERIAL} against temperature. Line: Table 2, monotone cubic between its columns; marks: what "
        "section 3.2 finds from UMAT runs of each layup (a from the bleed stage), within "
        f"{worst['k']:.0e} in k, {worst['a']:.0e} in a, {worst['b_squeeze']:.0e} and {worst['b_bleed']:.0e} in b: with "
        "plies merged perfectly, CP, SB and BP give one set of parameters. The scatter of the paper's specimens is not "
        f"in the model. {MODEL_ONLY}"
    )
    return PaperFigure("7", "k, a and b vs. temperature for IM7-8552, CP, SB and BP specimens", caption, table, figure)


def _draw_parameter(panel: Axes, table: pd.DataFrame, name: str, changed: bool) -> None:
    material = known_materials()[MATERIAL]
    if not changed:
        temperatures = np.linspace(material.table.temperature[0], material.table.temperature[-1], 121)
        values = [getattr(material.at(float(temperature)), name) for temperature in temperatures]
        panel.plot(temperatures, values, color="black", linewidth=1.0, label="Table 2, interpolated")
    for layup, size in zip(LAYUPS, (11, 7.5, 4.5), strict=True):
        colour, marker = LAYUP_STYLES[layup]
        rows = table[table["layup"] == layup]
        panel.plot(
            rows["temperature"], rows["found"], marker, color=colour, markersize=size, markerfacecolor="none",
            markeredgewidth=1.3, label=f"found from {layup}",
        )  # fmt: skip
