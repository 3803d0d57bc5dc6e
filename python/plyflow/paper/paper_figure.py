"""One figure: drawing, caption, data; and how they look."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from plyflow.paper.demo_figures import RC, temperature_colour

DPI = 200
STYLE: Any = {**RC, "axes.titlesize": 10.5, "legend.frameon": False, "legend.fontsize": 8.5, "savefig.dpi": DPI}
LAW_LINE: dict[str, Any] = {"color": "black", "linestyle": (0, (4, 3)), "linewidth": 0.9}
TEMPERATURES = (30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0)
ONE, TWO = (4.8, 3.6), (8.4, 3.6)
MODEL_ONLY = "Model only: no measured points are drawn."


@dataclass(frozen=True)
class PaperFigure:
    """Counterpart of a figure of the paper: its number, what the original shows, caption, data, drawing."""

    number: str
    original: str
    caption: str
    table: pd.DataFrame
    figure: Figure

    @property
    def name(self) -> str:
        """File name without ending."""
        return f"fig{self.number}" if self.number[0].isdigit() else self.number

    @property
    def command(self) -> str:
        """Command that makes it."""
        return f"plyflow figures --only {self.number}" if self.number[0].isdigit() else "plyflow figures"

    def png(self) -> bytes:
        """The drawing as PNG."""
        stream = io.BytesIO()
        with matplotlib.rc_context(STYLE):
            self.figure.savefig(stream, format="png", dpi=DPI, metadata={"Software": None})
        return stream.getvalue()

    def svg(self) -> str:
        """The drawing as SVG text, the same each time."""
        stream = io.StringIO()
        with matplotlib.rc_context(STYLE):
            self.figure.savefig(stream, format="svg", metadata={"Date": None})
        return stream.getvalue()

    def csv(self) -> str:
        """The data drawn."""
        return str(self.table.to_csv(index=False, lineterminator="\n"))


def panels(columns: int, size: tuple[float, float], rows: int = 1, **shared: Any) -> tuple[Figure, list[Axes]]:
    """A new figure and its panels, row by row."""
    figure = Figure(figsize=size, layout="constrained")
    return figure, list(np.atleast_1d(figure.subplots(rows, columns, **shared)).flat)


def temperature_bar(figure: Figure, axes: list[Axes], temperatures: tuple[float, ...] = TEMPERATURES) -> None:
    """A key of the colours of temperatures at the right."""
    colours = [temperature_colour(temperature) for temperature in temperatures]
    half = 0.5 * (temperatures[1] - temperatures[0])
    edges = [temperatures[0] - half, *(temperature + half for temperature in temperatures)]
    mappable = ScalarMappable(BoundaryNorm(edges, len(colours)), ListedColormap(colours))
    bar = figure.colorbar(mappable, ax=axes, ticks=temperatures, label="temperature [°C]", aspect=28, pad=0.02)
    bar.ax.tick_params(length=0)
    bar.outline.set_visible(False)


def letter(axes: list[Axes], titles: list[str]) -> None:
    """Titles (a), (b), ..."""
    for place, (panel, title) in enumerate(zip(axes, titles, strict=True)):
        panel.set_title(f"({'abcdefgh'[place]}) {title}", loc="left")
