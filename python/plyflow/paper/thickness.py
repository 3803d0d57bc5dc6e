"""Counterparts of Figs. 9 and 10: thickness after compaction against temperature and geometry."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes

from plyflow.paper.demo_figures import LAYUP_NAMES, LAYUP_STYLES
from plyflow.paper.model import LAYUPS, SIZES, Model
from plyflow.paper.paper_figure import MODEL_ONLY, TWO, PaperFigure, letter, panels


def figure_9(model: Model) -> PaperFigure:
    """Thickness after compaction, IM7-8552."""
    return _final_thickness(model, "9", "IM7-8552")


def figure_10(model: Model) -> PaperFigure:
    """Thickness after compaction, IMA-M21."""
    return _final_thickness(model, "10", "IMA-M21")


def _final_thickness(model: Model, number: str, material: str) -> PaperFigure:
    driven = model.driven[model.driven["material"] == material]
    smooth = model.smooth[model.smooth["material"] == material]
    figure, axes = panels(2, TWO, sharey=True)
    for panel, width in zip(axes, SIZES, strict=True):
        _draw(panel, driven[driven["width"] == width], smooth[smooth["width"] == width])
    axes[0].set_ylabel("thickness after compaction [mm]")
    letter(axes, list(SIZES.values()))
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, ncols=4, loc="outside lower center")
    difference = (driven["thickness_mm"] - driven["thickness_mm_1d"]).abs().max()
    caption = (
        f"Thickness of {material} specimens of 16 plies after the ramp-dwell test against temperature, (a) 15 mm and (b) "
        "30 mm wide: UMAT (marks) and one-dimensional law with parameters interpolated between the columns (lines), "
        f"largest difference {1e3 * difference:.1f} um. At equal pressure the law knows the geometry through w0/h0 "
        "only, so CP and SB of 15 mm repeat as SB and BP of 30 mm. " + MODEL_ONLY
    )
    columns = ["material", "temperature", "layup", "width", "thickness_mm", "thickness_ratio", "thickness_mm_1d"]
    original = f"Thickness after compaction vs. temperature and geometry, {material}"
    return PaperFigure(number, original, caption, driven[columns], figure)


def _draw(panel: Axes, driven: pd.DataFrame, smooth: pd.DataFrame) -> None:
    for layup in LAYUPS:
        colour, marker = LAYUP_STYLES[layup]
        marks, line = driven[driven["layup"] == layup], smooth[smooth["layup"] == layup]
        panel.plot(line["temperature"], line["thickness_mm"], color=colour, linewidth=1.0)
        label = f"{layup}, {LAYUP_NAMES[layup]}"
        panel.plot(marks["temperature"], marks["thickness_mm"], color=colour, marker=marker, ls="none", label=label)
    panel.plot([], [], color="grey", linewidth=1.0, label="one-dimensional law")
    panel.set(xlabel="temperature [°C]")
