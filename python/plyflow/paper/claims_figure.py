"""The map of verdicts as a figure: one small map a claim, over gamma_lock and l0/d."""

from __future__ import annotations

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from plyflow.paper.claims import CLAIMS, Verdict
from plyflow.paper.paper_figure import STYLE, PaperFigure

COLOURS = {Verdict.HOLDS: "#4C9BD0", Verdict.FAILS: "#E69F00", Verdict.OPEN: "#C8C8C8"}
COLUMNS = 4
MAP_COLOURS = ListedColormap(list(COLOURS.values()))
MAP_STEPS = BoundaryNorm(np.arange(len(COLOURS) + 1) - 0.5, len(COLOURS))


def verdict_figure(table: pd.DataFrame, gamma_lock: float, l0_over_d: float) -> PaperFigure:
    """Map of all claims; the assumptions of the call are marked."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(9.6, 7.4), layout="constrained")
        axes = figure.subplots(-(-len(CLAIMS) // COLUMNS), COLUMNS, sharex=True, sharey=True)
        for panel, claim in zip(axes.flat, CLAIMS, strict=False):
            _draw(panel, table[table["claim"] == claim.key], gamma_lock, l0_over_d)
            panel.set_title(claim.key, fontsize=10)
        for panel in axes[:, 0]:
            panel.set_ylabel("$l_0 / d$ [-]")
        for panel in axes[-1]:
            panel.set_xlabel(r"$\gamma_{lock}$ [deg]")
        keys = [Patch(color=colour, label=verdict.value) for verdict, colour in COLOURS.items()]
        mark = axes.flat[0].plot([], [], "k+", markersize=9, markeredgewidth=1.6, label="assumed here")
        figure.legend(handles=[*keys, *mark], ncols=4, loc="outside lower center")
    caption = (
        "Verdict on each claim over gamma_lock and l0/d, which the paper does not give; the cross marks the values "
        "assumed here. Everything else as assumed; one-dimensional law, 84 cases a point."
    )
    return PaperFigure("claims-map", "none: the paper fixes neither quantity", caption, table, figure)


def _draw(panel: Axes, rows: pd.DataFrame, gamma_lock: float, l0_over_d: float) -> None:
    order = [verdict.value for verdict in COLOURS]
    numbers = rows.assign(place=rows["verdict"].map(order.index))
    grid = numbers.pivot_table(index="l0_over_d", columns="gamma_lock", values="place")
    panel.pcolormesh(grid.to_numpy(), cmap=MAP_COLOURS, norm=MAP_STEPS, edgecolors="white", linewidth=0.8)
    panel.grid(visible=False)
    for set_ticks, values in ((panel.set_xticks, grid.columns), (panel.set_yticks, grid.index)):
        set_ticks(np.arange(len(values)) + 0.5, [f"{value:g}" for value in values], fontsize=8)
    inside = [_place(grid.columns.to_numpy(), gamma_lock), _place(grid.index.to_numpy(), l0_over_d)]
    panel.plot(*inside, "k+", markersize=9, markeredgewidth=1.6)


def _place(values: np.ndarray[tuple[int], np.dtype[np.float64]], wanted: float) -> float:
    """Place of a value on an axis whose cells stand for the values given."""
    return float(np.interp(wanted, values, np.arange(values.size))) + 0.5
