"""Labels of points in a figure: within the axes, over no other label and no point, over no line if there is room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.text import Annotation, Text
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

FONT_SIZE = 7.0
GAP = 2.0  # pixels between two labels
FURTHER = (0.0, 12.0, 24.0, 36.0)  # points away from the nearest place, tried in turn
DIRECTIONS = ((-1, -1), (0, -1), (-1, 0), (1, -1), (1, 1), (-1, 1))  # below and left of a front is free, so it comes first
NEAR = (6.0, 5.0)  # points
ALONG = 24  # places a line is looked at between two of its points
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
    placed: list[Annotation] = []
    taken: list[Bbox] = []
    obstacles = (_drawn(axes, ALONG), _drawn(axes, 1))
    for label in labels:
        found = _place(axes, label, taken, obstacles[0]) or _place(axes, label, taken, obstacles[1])
        if found is not None:
            placed.append(found)
            taken.append(label_box(found).padded(GAP))
    return placed


def label_box(note: Annotation) -> Bbox:
    """Box of the words alone [pixels], without the line to the point."""
    note.get_window_extent()  # moves the words to their place
    return Text.get_window_extent(note)


def _place(axes: Axes, label: Label, taken: Sequence[Bbox], marks: NDArray[np.float64]) -> Annotation | None:
    """The first free place; with a thin line to the point where it is not next to it."""
    for further in FURTHER:
        for across, up in DIRECTIONS[:3] if further else DIRECTIONS:
            offset = (across * (NEAR[0] + further), up * (NEAR[1] + further))
            note = axes.annotate(
                label.text, (label.x, label.y), xytext=offset, textcoords="offset points", fontsize=FONT_SIZE,
                ha=ACROSS[across], va=UP[up], annotation_clip=False,
                arrowprops={"arrowstyle": "-", "linewidth": 0.5, "color": "#808080"} if further else None,
            )  # fmt: skip
            if _is_free(label_box(note), axes.get_window_extent(), taken, marks):
                return note
            note.remove()
    return None


def _is_free(box: Bbox, inside: Bbox, taken: Sequence[Bbox], marks: NDArray[np.float64]) -> bool:
    if box.x0 < inside.x0 or box.x1 > inside.x1 or box.y0 < inside.y0 or box.y1 > inside.y1:
        return False
    return not any(box.overlaps(other) for other in taken) and not box.count_contains(marks)


def _drawn(axes: Axes, along: int) -> NDArray[np.float64]:
    """Places (n, 2) in pixels of the points drawn, and of `along` - 1 on the line between each and the next."""
    paths = [line.get_transform().transform(np.asarray(line.get_xydata(), dtype=float)) for line in axes.lines]
    parts = np.arange(along)[:, None, None] / along
    dense = [(path[:-1] + parts * np.diff(path, axis=0)).reshape(-1, 2) for path in paths if len(path) > 1]
    return np.concatenate([*paths, *dense, np.empty((0, 2))])
