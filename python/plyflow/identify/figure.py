"""Pictures of a fit: the straight lines (Fig. 6a), the curves (Fig. 6b), how k, a and b are tied."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from plyflow.identify.lines import LineFit
from plyflow.identify.model import predicted
from plyflow.identify.refine import Fit
from plyflow.identify.valley import TIED, Plane, refined, region_level
from plyflow.law import Stage
from plyflow.show.figure import BLUE, RED, SKY, panels, styled, svg

SIZE, WIDE = (5.2, 4.0), (10.5, 3.6)
COLOURS = {Stage.SQUEEZE: RED, Stage.BLEED: BLUE}
SYMBOLS = {"k": "$k$", "a": "$a$", "b_bleed": "$b$ (bleed)"}
LEVELS_UM = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0)


@styled
def lines_figure(lines: LineFit) -> str:
    """SVG of the log-log diagram of section 3.2 with the points and the line of each stage."""
    figure, (axes,) = panels(size=SIZE)
    for stage, points in lines.points.items():
        line, colour = lines.lines[stage], COLOURS[stage]
        rate = np.exp(np.array([points.log_rate.min(), points.log_rate.max()]))
        axes.loglog(np.exp(points.log_rate), np.exp(points.log_ratio), "o", color=colour, markersize=4)
        label = f"{stage.name.lower()}: a = {line.a:.3f}, b = {line.b:.2f}"
        axes.loglog(rate, np.exp(line.b) * rate**line.a, color=colour, linewidth=1.0, label=label)
    axes.set(xlabel=r"rate $-\dot\varepsilon$ [1/s]", ylabel=r"$p\,/\,(\dot\varepsilon\,\eta_{ply}\,\eta_{micro})$")
    axes.set_title(f"k = {lines.k:.4f}")
    axes.legend()
    return svg(figure)


@styled
def curves_figure(fit: Fit) -> str:
    """SVG of the readings as dots and the fitted curves over time."""
    figure, (axes,) = panels(size=SIZE)
    for place, specimen in enumerate(fit.specimens):
        colour = f"C{place % 10}"
        axes.plot(specimen.time, specimen.thickness, ".", color=colour, markersize=2, alpha=0.4, rasterized=True)
        axes.plot(specimen.time, predicted(specimen, fit.values[None])[0], color="black", linewidth=1.0)
        axes.plot([], [], ".", color=colour, label=specimen.name)
    axes.plot([], [], color="black", linewidth=1.0, label="law, fitted")
    axes.set(xlabel="time [s]", ylabel="thickness [mm]")
    axes.legend()
    return svg(figure)


@styled
def valley_figure(fit: Fit, planes: Sequence[Plane]) -> str:
    """SVG of the misfit over each pair of k, a, b, the third at its best; filled: both with 95 % confidence."""
    figure, axes = panels(len(planes), WIDE)
    for place, plane in zip(axes, map(refined, planes), strict=True):
        _draw_plane(place, fit, plane)
    # The layout keeps no room for half a tick label right of the last axes.
    figure.set_layout_engine("constrained", rect=(0.0, 0.0, 0.975, 1.0))
    words = "lines: misfit (root mean square) with the third parameter at its best; filled: joint 95 % region"
    figure.supxlabel(words, fontsize=8)
    return svg(figure)


def _draw_plane(axes: Axes, fit: Fit, plane: Plane) -> None:
    names, values = (plane.first, plane.second), (plane.first_values, plane.second_values)
    misfit, region = 1e3 * plane.misfit, 1e3 * region_level(fit)
    axes.contourf(*values, misfit, levels=[0.0, region], colors=[SKY], alpha=0.7)
    levels = [level for level in LEVELS_UM if region < level < misfit.max()]
    if levels:
        drawn = axes.contour(*values, misfit, levels=levels, colors="black", linewidths=0.7)
        axes.clabel(drawn, fmt="%g µm", fontsize=7)
    axes.plot(*(fit.estimates[name].value for name in names), "+", color=RED, markersize=9)
    axes.set(xlabel=SYMBOLS[plane.first], ylabel=SYMBOLS[plane.second])
    axes.locator_params(nbins=5)
    axes.set_title(f"correlation {fit.correlation[TIED.index(names[0]), TIED.index(names[1])]:+.3f}", fontsize=9)
