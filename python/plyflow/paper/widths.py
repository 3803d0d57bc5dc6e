"""Counterparts of Figs. 2a and 11: width after compaction against temperature."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes

from plyflow.paper.demo_figures import LAYUP_NAMES, LAYUP_STYLES
from plyflow.paper.model import BASELINE, LAYUPS, SCALE_UP, SIZES, Model
from plyflow.paper.paper_figure import MODEL_ONLY, ONE, TWO, PaperFigure, letter, panels

BLUE = LAYUP_STYLES["CP"][0]
TEMPERATURE_LABEL = "temperature [°C]"
WIDTH_STYLES = {BASELINE: ("o", "white", "-"), SCALE_UP: ("s", BLUE, (0, (5, 2)))}


def locked_words(table: pd.DataFrame) -> str:
    """Why widths do not change with temperature, if so."""
    locked = int(table["lock_time_s"].notna().sum())
    if locked == len(table):
        return (
            "Every case locks within the test, so its width is exp(-eps_lock), which Eq. 6 takes from the geometry "
            "alone: with these assumptions the model has the plateau, but no rise before it."
        )
    return f"{locked} of {len(table)} cases lock; their width is exp(-eps_lock) from the geometry alone (Eq. 6)."


def figure_2a(model: Model) -> PaperFigure:
    """Increase in width against temperature for CP, SB and BP."""
    table = model.smooth
    table = table[table["material"] == "IM7-8552"].assign(increase_percent=100.0 * (table["width_ratio"] - 1.0))
    figure, (axes,) = panels(1, ONE)
    for layup in LAYUPS:
        colour, marker = LAYUP_STYLES[layup]
        for width, dash, size in ((BASELINE, "-", 8.0), (SCALE_UP, (0, (5, 2)), 4.0)):
            rows = table[(table["layup"] == layup) & (table["width"] == width)]
            label = f"{layup}, {LAYUP_NAMES[layup]}, 15 mm" if width == BASELINE else None
            axes.plot(
                rows["temperature"], rows["increase_percent"], color=colour, linestyle=dash, label=label,
                marker=marker, markevery=10, markersize=size, markerfacecolor=colour if width == BASELINE else "white",
                linewidth=1.4,
            )  # fmt: skip
    axes.plot([], [], "o", color="grey", linestyle=(0, (5, 2)), markersize=4, markerfacecolor="white", label="30 mm")
    axes.set(xlabel=TEMPERATURE_LABEL, ylabel="increase in width [%]")
    axes.legend(ncols=2, loc="upper center")
    axes.set_ylim(0.0, 1.45 * float(table["increase_percent"].max()))
    caption = (
        "Increase in width after the ramp-dwell test against temperature, IM7-8552, for separate plies (CP), blocks of 2 "
        "(SB) and of 4 (BP); full lines and marks 15 mm, dashed and open 30 mm; one-dimensional law, parameters "
        f"interpolated between the columns of Table 2. {locked_words(table)} {MODEL_ONLY}"
    )
    columns = ["material", "temperature", "layup", "width", "width_ratio", "increase_percent", "lock_time_s"]
    return PaperFigure("2a", "Increase in width vs. temperature for IM7-8552", caption, table[columns], figure)


def figure_11(model: Model) -> PaperFigure:
    """Normalised width of BP specimens against temperature, both materials."""
    blocked = model.driven[model.driven["layup"] == "BP"]
    figure, axes = panels(2, TWO, sharey=True)
    for panel, (_, rows) in zip(axes, blocked.groupby("material"), strict=True):
        _draw_widths(panel, rows)
    axes[0].set_ylabel("width after compaction $w / w_0$ [-]")
    axes[0].set_ylim(1.0, 1.0 + 1.5 * (float(blocked["width_ratio"].max()) - 1.0))
    axes[0].legend(ncols=1, loc="upper left")
    letter(axes, [str(name) for name, _ in blocked.groupby("material")])
    caption = (
        "Width of blocked (BP) specimens after the ramp-dwell test over their initial width, against temperature: "
        "UMAT (marks) and one-dimensional law (lines), largest difference "
        f"{(blocked['width_ratio'] - blocked['width_ratio_1d']).abs().max():.1e}. {locked_words(blocked)} {MODEL_ONLY}"
    )
    columns = ["material", "temperature", "layup", "width", "width_ratio", "width_ratio_1d", "lock_time_s"]
    return PaperFigure("11", "Normalised width of BP samples vs. temperature", caption, blocked[columns], figure)


def _draw_widths(panel: Axes, table: pd.DataFrame) -> None:
    for width, (marker, face, dash) in WIDTH_STYLES.items():
        rows = table[table["width"] == width]
        panel.plot(rows["temperature"], rows["width_ratio_1d"], color=BLUE, linestyle=dash, linewidth=1.0)
        panel.plot(
            rows["temperature"], rows["width_ratio"], color=BLUE, marker=marker, markerfacecolor=face,
            linestyle="none", label=f"UMAT, {SIZES[width]}",
        )  # fmt: skip
    panel.plot([], [], color=BLUE, linewidth=1.0, label="one-dimensional law")
    panel.set(xlabel=TEMPERATURE_LABEL)
