"""State after compaction against temperature: counterparts of Figs. 2a and 11 (width), 9 and 10 (thickness)."""

from __future__ import annotations

import itertools

import pandas as pd
from matplotlib.axes import Axes

from plyflow.paper.model import BASELINE, LAYUPS, SCALE_UP, SIZES, Model
from plyflow.paper.paper_figure import (
    LAYUP_NAMES,
    LAYUP_STYLES,
    MODEL_ONLY,
    TEMPERATURE_LABEL,
    PaperFigure,
    legend_below,
    letter,
)
from plyflow.show.figure import BLUE, TWO, panels

KEYS = ["material", "temperature", "layup", "width"]
INNER = "Marks are the mean of all blocks, bars reach from the outer blocks to the inner ones."
LONG_DASH = (0, (5, 2))
WIDTH_STYLES = {BASELINE: ("o", "white", "-"), SCALE_UP: ("s", BLUE, LONG_DASH)}


def locked_words(table: pd.DataFrame) -> str:
    """Why widths do not change with temperature, if so."""
    locked = int(table["lock_time_s"].notna().sum())
    if locked == len(table):
        return (
            "Every case locks within the test, so its width is exp(-eps_lock), which Eq. 6 takes from the geometry "
            "alone: with these assumptions the model has the plateau, but no rise before it."
        )
    return f"{locked} of {len(table)} cases lock; their width is exp(-eps_lock) from the geometry alone (Eq. 6)."


def measured_words(model: Model) -> str:
    """What a caption says of measured points."""
    return MODEL_ONLY if model.measured.empty else "Crosses: measured points, from the file given."


def draw_measured(panel: Axes, points: pd.DataFrame, quantity: str, colour: str) -> None:
    """Measured points as crosses."""
    panel.plot(points["temperature"], points[quantity], color=colour, marker="x", markersize=8, ls="none")


def figure_2a(model: Model) -> PaperFigure:
    """Increase in width against temperature for CP, SB and BP."""
    table = model.smooth
    table = table[table["material"] == "IM7-8552"].assign(increase_percent=100.0 * (table["width_ratio"] - 1.0))
    figure, (axes,) = panels()
    for layup, (width, dash, size) in itertools.product(LAYUPS, ((BASELINE, "-", 8.0), (SCALE_UP, LONG_DASH, 4.0))):
        colour, marker = LAYUP_STYLES[layup]
        rows = table[(table["layup"] == layup) & (table["width"] == width)]
        axes.plot(
            rows["temperature"], rows["increase_percent"], color=colour, linestyle=dash, linewidth=1.4, marker=marker,
            markevery=10, markersize=size, markerfacecolor=colour if width == BASELINE else "white",
            label=f"{layup}, {LAYUP_NAMES[layup]}, 15 mm" if width == BASELINE else None,
        )  # fmt: skip
    axes.plot([], [], "o", color="grey", linestyle=LONG_DASH, markersize=4, markerfacecolor="white", label="30 mm")
    axes.set(xlabel=TEMPERATURE_LABEL, ylabel="increase in width [%]")
    axes.legend(ncols=2, loc="upper center")
    axes.set_ylim(0.0, 1.45 * float(table["increase_percent"].max()))
    caption = (
        "Increase in width after the ramp-dwell test against temperature, IM7-8552, for separate plies (CP), blocks of 2 "
        "(SB) and of 4 (BP); full lines and marks 15 mm, dashed and open 30 mm; one-dimensional law, parameters "
        f"interpolated between the columns of Table 2. {locked_words(table)} {MODEL_ONLY}"
    )
    columns = [*KEYS, "width_ratio", "increase_percent", "lock_time_s"]
    return PaperFigure("2a", "Increase in width vs. temperature for IM7-8552", caption, table[columns], figure)


def figure_11(model: Model) -> PaperFigure:
    """Normalised width of BP specimens against temperature, both materials."""
    blocked = model.driven[model.driven["layup"] == "BP"]
    inner = [name for name in ("width_ratio_inner", "width_ratio_outer") if name in blocked]
    figure, axes = panels(2, TWO, sharey=True)
    for panel, (name, table) in zip(axes, blocked.groupby("material"), strict=True):
        for width, (marker, face, dash) in WIDTH_STYLES.items():
            rows = table[table["width"] == width]
            panel.plot(rows["temperature"], rows["width_ratio_1d"], color=BLUE, linestyle=dash, linewidth=1.0)
            panel.plot(
                rows["temperature"], rows["width_ratio"], color=BLUE, marker=marker, markerfacecolor=face, ls="none",
                label=f"{model.marks}, {SIZES[width]}",
            )  # fmt: skip
            if "width_ratio_inner" in rows:
                panel.vlines(rows["temperature"], rows["width_ratio_outer"], rows["width_ratio_inner"], color=BLUE, linewidth=1.0)
            points = model.measured[(model.measured["material"] == name) & (model.measured["width"] == width)]
            draw_measured(panel, points[points["layup"] == "BP"], "width_ratio", BLUE)
        panel.plot([], [], color=BLUE, linewidth=1.0, label="one-dimensional law")
        panel.set_xlabel(TEMPERATURE_LABEL)
    axes[0].set(
        ylabel="width after compaction $w / w_0$ [-]", ylim=(1.0, 1.0 + 1.5 * (float(blocked["width_ratio"].max()) - 1.0))
    )
    axes[0].legend(ncols=1, loc="upper left")
    letter(axes, [str(name) for name, _ in blocked.groupby("material")])
    caption = (
        "Width of blocked (BP) specimens after the ramp-dwell test over their initial width, against temperature: "
        f"{model.marks} (marks) and one-dimensional law (lines), largest difference "
        f"{(blocked['width_ratio'] - blocked['width_ratio_1d']).abs().max():.1e}. "
        f"{INNER if inner else locked_words(blocked)} {model.words} {measured_words(model)}"
    )
    columns = [*KEYS, "width_ratio", "width_ratio_1d", "lock_time_s", *inner]
    return PaperFigure("11", "Normalised width of BP samples vs. temperature", caption, blocked[columns], figure)


def final_thickness(model: Model, number: str, material: str) -> PaperFigure:
    """Thickness after compaction of one material, a panel a size."""
    driven, smooth = (table[table["material"] == material] for table in (model.driven, model.smooth))
    figure, axes = panels(2, TWO, sharey=True)
    for panel, width in zip(axes, SIZES, strict=True):
        for layup in LAYUPS:
            colour, marker = LAYUP_STYLES[layup]
            marks, line = (t[(t["width"] == width) & (t["layup"] == layup)] for t in (driven, smooth))
            panel.plot(line["temperature"], line["thickness_mm"], color=colour, linewidth=1.0)
            label = f"{layup}, {LAYUP_NAMES[layup]}"
            panel.plot(marks["temperature"], marks["thickness_mm"], color=colour, marker=marker, ls="none", label=label)
            points = model.measured[(model.measured["material"] == material) & (model.measured["width"] == width)]
            draw_measured(panel, points[points["layup"] == layup], "thickness_mm", colour)
        panel.plot([], [], color="grey", linewidth=1.0, label="one-dimensional law")
        panel.set_xlabel(TEMPERATURE_LABEL)
    axes[0].set_ylabel("thickness after compaction [mm]")
    letter(axes, list(SIZES.values()))
    legend_below(figure, axes[0], 4)
    caption = (
        f"Thickness of {material} specimens of 16 plies after the ramp-dwell test against temperature, (a) 15 mm and (b) "
        f"30 mm wide: {model.marks} (marks) and one-dimensional law with parameters interpolated between the columns (lines), "
        f"largest difference {1e3 * (driven['thickness_mm'] - driven['thickness_mm_1d']).abs().max():.1f} um. At equal "
        "pressure the law knows the geometry through w0/h0 only, so CP and SB of 15 mm repeat as SB and BP of 30 mm. "
        f"{model.words} {measured_words(model)}"
    )
    columns = [*KEYS, "thickness_mm", "thickness_ratio", "thickness_mm_1d"]
    original = f"Thickness after compaction vs. temperature and geometry, {material}"
    return PaperFigure(number, original, caption, driven[columns], figure)
