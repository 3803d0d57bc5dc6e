"""One figure: drawing, caption, data; and what several of them have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from plyflow.show.figure import BLUE, GREEN, RED, png, svg, temperature_colour

TEMPERATURES = (30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0)
LAYUP_STYLES = {"CP": (BLUE, "o"), "SB": (RED, "s"), "BP": (GREEN, "^")}
LAYUP_NAMES = {"CP": "cross-ply", "SB": "semi-blocked", "BP": "blocked"}
TIME_LABEL, TEMPERATURE_LABEL = "time [s]", "temperature [°C]"
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

    def files(self) -> dict[str, Any]:
        """Drawing as PNG and SVG, the data drawn, by file name."""
        return {f"{self.name}.svg": svg(self.figure), f"{self.name}.csv": self.table, f"{self.name}.png": png(self.figure)}


def temperature_bar(figure: Figure, axes: list[Axes], temperatures: tuple[float, ...] = TEMPERATURES) -> None:
    """A key of the colours of temperatures at the right."""
    half = 0.5 * (temperatures[1] - temperatures[0])
    edges = [temperatures[0] - half, *(temperature + half for temperature in temperatures)]
    colours = ListedColormap([temperature_colour(temperature) for temperature in temperatures])
    mappable = ScalarMappable(BoundaryNorm(edges, len(temperatures)), colours)
    bar = figure.colorbar(mappable, ax=axes, ticks=temperatures, label=TEMPERATURE_LABEL, aspect=28, pad=0.02)
    bar.ax.tick_params(length=0)
    bar.outline.set_visible(False)


def letter(axes: list[Axes], titles: list[str]) -> None:
    """Titles (a), (b), ..."""
    for place, (panel, title) in enumerate(zip(axes, titles, strict=True)):
        panel.set_title(f"({'abcdefgh'[place]}) {title}", loc="left")


def legend_below(figure: Figure, axes: Axes, columns: int) -> None:
    """The legend of one panel, below them all."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, ncols=columns, loc="outside lower center")
