"""How the verdicts change over gamma_lock, one value for every case, and l0/d: table, words, figure."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from plyflow.paper.claims import CLAIMS, Verdict, judge, programme_table
from plyflow.paper.paper_figure import PaperFigure
from plyflow.show.figure import panels, styled

# Edge shear from small to nearly a right angle; fibre length over width from 15 mm / 7 um to 60 mm / 7 um.
GAMMA_LOCK = (45.0, 60.0, 70.0, 75.0, 80.0, 83.0, 86.0, 88.0)
L0_OVER_D = (2147.0, 3036.0, 4294.0, 6073.0, 8588.0)
COLOURS = {Verdict.HOLDS: "#4C9BD0", Verdict.FAILS: "#E69F00", Verdict.OPEN: "#C8C8C8"}
COLUMNS = 4
MARK: dict[str, Any] = {"color": "black", "marker": "+", "linestyle": "none", "markersize": 7, "markeredgewidth": 1.2}


def verdict_table(settings: Mapping[str, float]) -> pd.DataFrame:
    """Verdict and number of every claim over the grid of gamma_lock [deg] and l0/d [-]; other settings as given."""
    rows = []
    for gamma_lock, l0_over_d in itertools.product(GAMMA_LOCK, L0_OVER_D):
        place = {"gamma_lock": gamma_lock, "l0_over_d": l0_over_d}
        for key, finding in judge(programme_table({**settings, **place})).items():
            rows.append({"claim": key, **place, "verdict": finding.verdict.value, "number": finding.number})
    return pd.DataFrame(rows)


def range_words(table: pd.DataFrame) -> dict[str, str]:
    """How each claim fares over the grid, in words, by key."""
    words = {}
    for claim in CLAIMS:
        rows = table[table["claim"] == claim.key]
        holding = rows[rows["verdict"] == Verdict.HOLDS.value]
        if (rows["verdict"] == Verdict.OPEN.value).all():
            said = "open throughout"
        elif holding.empty:
            said = "holds nowhere"
        elif len(holding) == len(rows):
            said = "holds throughout"
        else:
            said = f"holds at {len(holding)} of {len(rows)} points ({_where(rows, holding)})"
        words[claim.key] = f"{said}, number from {rows['number'].min():.3g} to {rows['number'].max():.3g}"
    return words


def _where(rows: pd.DataFrame, holding: pd.DataFrame) -> str:
    parts = []
    for name, unit in (("gamma_lock", " deg"), ("l0_over_d", "")):
        kept = sorted(holding[name].unique())
        if len(kept) < rows[name].nunique():
            parts.append(f"{name} {kept[0]:g} to {kept[-1]:g}{unit}")
    return ", ".join(parts) if parts else "gamma_lock and l0/d together"


@styled
def verdict_figure(table: pd.DataFrame, gamma_lock: Iterable[float], l0_over_d: float) -> PaperFigure:
    """One small map a claim; a cross for each gamma_lock [deg] that the cases have, at their l0/d."""
    values = sorted(set(gamma_lock))
    figure, axes = panels(COLUMNS, (9.6, 7.4), rows=-(-len(CLAIMS) // COLUMNS), sharex=True, sharey=True)
    for panel, claim in zip(axes, CLAIMS, strict=False):
        _draw(panel, table[table["claim"] == claim.key], values, l0_over_d)
        panel.set_title(claim.key, fontsize=10)
    for panel in axes[::COLUMNS]:
        panel.set_ylabel("$l_0 / d$ [-]")
    for panel in axes[-COLUMNS:]:
        panel.set_xlabel(r"$\gamma_{lock}$ [deg]")
    keys = [Patch(color=colour, label=verdict.value) for verdict, colour in COLOURS.items()]
    mark = Line2D([], [], label="the cases of this report", **MARK)
    figure.legend(handles=[*keys, mark], ncols=4, loc="outside lower center")
    caption = (
        "Verdict on each claim if every case had the same gamma_lock, over gamma_lock and l0/d; the crosses mark the "
        "values that the cases of this report have, gamma_lock by Eq. A.1 from the k of each column unless it is set. "
        "l0/d is not in the paper. Everything else as assumed; one-dimensional law, 84 cases a point."
    )
    return PaperFigure("claims-map", "none", caption, table, figure)


def _draw(panel: Axes, rows: pd.DataFrame, gamma_lock: Sequence[float], l0_over_d: float) -> None:
    order = [verdict.value for verdict in COLOURS]
    numbers = rows.assign(place=rows["verdict"].map(order.index))
    grid = numbers.pivot_table(index="l0_over_d", columns="gamma_lock", values="place")
    steps = BoundaryNorm(np.arange(len(order) + 1) - 0.5, len(order))
    colours = ListedColormap(list(COLOURS.values()))
    panel.pcolormesh(grid.to_numpy(), cmap=colours, norm=steps, edgecolors="white", linewidth=0.8)
    panel.grid(visible=False)
    for set_ticks, values in ((panel.set_xticks, grid.columns), (panel.set_yticks, grid.index)):
        set_ticks(np.arange(len(values)) + 0.5, [f"{value:g}" for value in values], fontsize=8)
    places = ((gamma_lock, grid.columns), (np.full(len(gamma_lock), l0_over_d), grid.index))
    panel.plot(*(np.interp(at, axis, np.arange(len(axis))) + 0.5 for at, axis in places), **MARK)  # a cell is its value
