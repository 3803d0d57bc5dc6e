"""Pictures of a fit: the straight lines (Fig. 6a), the curves (Fig. 6b), how k, a and b are tied."""

from __future__ import annotations

import io
from collections.abc import Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from plyflow.identify.lines import LineFit
from plyflow.identify.model import predicted
from plyflow.identify.refine import Fit
from plyflow.identify.valley import Plane, refined, region_level
from plyflow.law import Stage
from plyflow.show.figure import STYLE as RC

STAGE_COLOURS = {Stage.SQUEEZE: "#D55E00", Stage.BLEED: "#0072B2"}
STAGE_NAMES = {Stage.SQUEEZE: "squeeze", Stage.BLEED: "bleed"}
SYMBOLS = {"k": "$k$", "a": "$a$", "b_bleed": "$b$ (bleed)"}
LEVELS_UM = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0)


def svg_of(figure: Figure) -> str:
    """The figure as SVG text, the same each time."""
    stream = io.StringIO()
    figure.savefig(stream, format="svg", metadata={"Date": None})
    return stream.getvalue()


def lines_figure(lines: LineFit) -> str:
    """SVG of the log-log diagram of section 3.2 with the points and the line of each stage."""
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(5.2, 4.0), layout="constrained")
        draw_lines(figure.add_subplot(), lines)
        return svg_of(figure)


def draw_lines(axes: Axes, lines: LineFit) -> None:
    """Draw points and lines of section 3.2."""
    for stage, points in lines.points.items():
        line = lines.lines[stage]
        rate = np.exp(np.array([points.log_rate.min(), points.log_rate.max()]))
        colour = STAGE_COLOURS[stage]
        axes.loglog(np.exp(points.log_rate), np.exp(points.log_ratio), "o", color=colour, markersize=4)
        label = f"{STAGE_NAMES[stage]}: a = {line.a:.3f}, b = {line.b:.2f}"
        axes.loglog(rate, np.exp(line.b) * rate**line.a, color=colour, linewidth=1.0, label=label)
    axes.set(xlabel=r"rate $-\dot\varepsilon$ [1/s]", ylabel=r"$p\,/\,(\dot\varepsilon\,\eta_{ply}\,\eta_{micro})$")
    axes.set_title(f"k = {lines.k:.4f}")
    axes.legend(fontsize=8, frameon=False)


def curves_figure(fit: Fit) -> str:
    """SVG of the readings and the fitted curves over time."""
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(5.2, 4.0), layout="constrained")
        draw_curves(figure.add_subplot(), fit)
        return svg_of(figure)


def draw_curves(axes: Axes, fit: Fit) -> None:
    """Draw readings as dots and fitted curves as lines."""
    for place, specimen in enumerate(fit.specimens):
        colour = f"C{place % 10}"
        axes.plot(specimen.time, specimen.thickness, ".", color=colour, markersize=2, alpha=0.4, rasterized=True)
        thickness = predicted(specimen, fit.values[None])[0]
        axes.plot(specimen.time, thickness, color="black", linewidth=1.0)
        axes.plot([], [], ".", color=colour, label=specimen.name)
    axes.plot([], [], color="black", linewidth=1.0, label="law, fitted")
    axes.set(xlabel="time [s]", ylabel="thickness [mm]")
    axes.legend(fontsize=8, frameon=False)


def valley_figure(fit: Fit, planes: Sequence[Plane]) -> str:
    """SVG of the misfit over each pair of k, a, b, the third at its best; filled: both with 95 % confidence."""
    with matplotlib.rc_context(RC):
        # The layout keeps no room for half a tick label right of the last axes.
        figure = Figure(figsize=(10.5, 3.6), layout=ConstrainedLayoutEngine(rect=(0.0, 0.0, 0.975, 1.0)))
        for axes, plane in zip(figure.subplots(1, len(planes)), map(refined, planes), strict=True):
            misfit = 1e3 * plane.misfit
            region = 1e3 * region_level(fit)
            axes.contourf(
                plane.first_values, plane.second_values, misfit, levels=[0.0, region], colors=["#56B4E9"], alpha=0.7
            )
            levels = [level for level in LEVELS_UM if level > region and level < misfit.max()]
            if levels:
                drawn = axes.contour(
                    plane.first_values, plane.second_values, misfit, levels=levels, colors="black", linewidths=0.7
                )
                axes.clabel(drawn, fmt="%g µm", fontsize=7)
            values = [fit.estimates[name].value for name in (plane.first, plane.second)]
            axes.plot(*values, "+", color="#D55E00", markersize=9)
            axes.set(xlabel=SYMBOLS[plane.first], ylabel=SYMBOLS[plane.second])
            axes.locator_params(nbins=5)
            first, second = (list(SYMBOLS).index(name) for name in (plane.first, plane.second))
            axes.set_title(f"correlation {fit.correlation[first, second]:+.3f}", fontsize=9)
        figure.supxlabel(
            "lines: misfit (root mean square) with the third parameter at its best; filled: joint 95 % region",
            fontsize=8,
        )
        return svg_of(figure)
