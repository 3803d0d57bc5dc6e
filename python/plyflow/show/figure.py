"""The one figure style: sizes, palette, and drawings as SVG or PNG that are the same each time."""

from __future__ import annotations

import io
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

P = ParamSpec("P")
T = TypeVar("T")

BLUE, RED, GREEN, PINK, ORANGE, SKY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"
PALETTE = (BLUE, RED, GREEN, PINK, ORANGE, SKY, "#8C564B", "#7F3C8D", "#444444")  # told apart by the colour-blind
GREY = "#A0A0A0"
MARKS = "os^Dv<>PX"
LAW_LINE: dict[str, Any] = {"color": "black", "linestyle": (0, (4, 3)), "linewidth": 0.9}
SMALL, ONE, TWO = (4.4, 3.7), (4.8, 3.6), (8.4, 3.6)  # inches: panel of a gallery, one panel, two panels
STYLE: Any = {
    "font.size": 10.0,
    "axes.titlesize": 10.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "savefig.dpi": 200,
    "svg.fonttype": "path",
    "svg.hashsalt": "plyflow",
}


def styled(draw: Callable[P, T]) -> Callable[P, T]:
    """Let a function draw in the one style."""

    @wraps(draw)
    def inside(*args: P.args, **kwargs: P.kwargs) -> T:
        with matplotlib.rc_context(STYLE):
            return draw(*args, **kwargs)

    return inside


@styled
def panels(columns: int = 1, size: tuple[float, float] = ONE, rows: int = 1, **shared: Any) -> tuple[Figure, list[Axes]]:
    """A new figure of a size [inches] and its panels, row by row; `shared` goes to `Figure.subplots`."""
    figure = Figure(figsize=size, layout="constrained")
    return figure, list(np.atleast_1d(figure.subplots(rows, columns, **shared)).flat)


def svg(figure: Figure) -> str:
    """The drawing as SVG text, undated."""
    return _saved(figure, "svg", {"Date": None}).decode("utf-8")


def png(figure: Figure) -> bytes:
    """The drawing as PNG, 200 points an inch."""
    return _saved(figure, "png", {"Software": None})


@styled
def _saved(figure: Figure, form: str, metadata: dict[str, None]) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format=form, metadata=metadata)
    return stream.getvalue()


def temperature_colour(temperature: float, low: float = 30.0, high: float = 90.0) -> tuple[float, ...]:
    """Colour of a temperature [degC], dark (cold) to bright (hot)."""
    place = 0.5 if high <= low else (temperature - low) / (high - low)
    return tuple(matplotlib.colormaps["plasma"](0.88 * place))
