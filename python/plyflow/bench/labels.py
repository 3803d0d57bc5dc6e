"""Labels of points in a figure, each where it covers no other label, no point and leaves the axes nowhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.text import Annotation
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

FONT_SIZE = 7.0
GAP = 2.0  # pixels between two labels
FURTHER = (0.0, 14.0, 28.0, 42.0)  # points away from the nearest place, tried in turn
DIRECTIONS = ((-1, -1), (0, -1), (-1, 0), (1, -1), (1, 1), (-1, 1))  # below and left of a front is free, so it comes first
NEAR = (6.0, 5.0)
ACROSS = {-1: "right", 0: "center", 1: "left"}
UP = {-1: "top", 0: "center", 1: "bottom"}


@dataclass(frozen=True)
class Label:
    """Text and the point it belongs to, in data coordinates."""

    text: str
    x: float
    y: float


def place_labels(axes: Axes, labels: Sequence[Label]) -> list[Annotation]:
    """Place labels in the order given; one for which there is no room is left out.

    The figure's layout and limits must be final: lay it out before, and change nothing after.

    Returns
    -------
    list of Annotation
        The labels that stand.
    """
    marks, taken, placed = _marks(axes), [], []
    for label in labels:
        found = _place(axes, label, taken, marks)
        if found is not None:
            placed.append(found)
            taken.append(found.get_window_extent().padded(GAP))
    return placed


def _place(axes: Axes, label: Label, taken: Sequence[Bbox], marks: NDArray[np.float64]) -> Annotation | None:
    """The first free place; with a thin line to the point where it is not next to it."""
    for further in FURTHER:
        for across, up in DIRECTIONS:
            offset = (across * (NEAR[0] + further), up * (NEAR[1] + further))
            note = axes.annotate(
                label.text, (label.x, label.y), xytext=offset, textcoords="offset points", fontsize=FONT_SIZE,
                ha=ACROSS[across], va=UP[up], annotation_clip=False,
                arrowprops={"arrowstyle": "-", "linewidth": 0.5, "color": "#808080"} if further else None,
            )  # fmt: skip
            if _is_free(_text_box(note), axes.get_window_extent(), taken, marks):
                return note
            note.remove()
    return None


def _text_box(note: Annotation) -> Bbox:
    """Box of the words alone, without the line to the point."""
    note.update_positions(note.figure.canvas.get_renderer())
    return Text.get_window_extent(note)


def _is_free(box: Bbox, inside: Bbox, taken: Sequence[Bbox], marks: NDArray[np.float64]) -> bool:
    if box.x0 < inside.x0 or box.x1 > inside.x1 or box.y0 < inside.y0 or box.y1 > inside.y1:
        return False
    return not any(box.overlaps(other) for other in taken) and not box.count_contains(marks)


def _marks(axes: Axes) -> NDArray[np.float64]:
    """Places of all points drawn (n, 2) in pixels."""
    paths = [line.get_transform().transform(np.asarray(line.get_xydata(), dtype=float)) for line in axes.lines]
    return np.concatenate(paths) if paths else np.empty((0, 2))
