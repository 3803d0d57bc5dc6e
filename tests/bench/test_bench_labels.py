"""Labels of the front: none over another, none over a point, none outside the axes."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Annotation
from plyflow.evidence.bench.labels import Label, label_box, place_labels

from plyflow.evidence.bench.figures import draw, scheme_colours
from plyflow.evidence.bench.measure import Point
from plyflow.evidence.bench.problems import problems

NAMES = ["default", "bdf2log"]


def crowded() -> list[Point]:
    """Two schemes whose points lie close together along the front."""
    return [
        Point(
            problem="blocked", scheme=name, control=f"tolerance {level:g}", family="tolerance", increments=round(60 * level),
            iterations=9, umat_calls=9, message="", errors={"thickness": 1e-3 * factor / level**2}, seconds=[1e-3 * level] * 3,
        )
        for name, factor in zip(NAMES, (1.0, 0.7), strict=True) for level in (1.0, 1.1, 1.3, 1.6, 4.0, 30.0)
    ]  # fmt: skip


def notes(axes: Axes) -> list[Annotation]:
    return [text for text in axes.texts if isinstance(text, Annotation)]


def faults(axes: Axes) -> list[str]:
    """Pairs of labels that overlap, labels that leave the axes, labels over a point."""
    boxes = {note.get_text(): label_box(note) for note in notes(axes)}
    inside = axes.get_window_extent()
    found = [f"{one} over {two}" for one, two in combinations(boxes, 2) if boxes[one].overlaps(boxes[two])]
    found += [name for name, box in boxes.items() if box.x0 < inside.x0 or box.x1 > inside.x1 or box.y0 < inside.y0]
    for line in axes.lines:
        marks = line.get_transform().transform(np.asarray(line.get_xydata(), dtype=float))
        found += [f"{name} over a point" for name, box in boxes.items() if box.count_contains(marks)]
    return found


@pytest.fixture
def figure() -> Figure:
    return draw(problems(True)[0], "thickness", crowded(), scheme_colours(NAMES, NAMES))


@pytest.mark.parametrize("panel", [0, 1])
def test_no_label_covers_another_or_is_cut(figure: Figure, panel: int) -> None:
    axes = figure.axes[panel]
    assert faults(axes) == []
    assert len(notes(axes)) >= 4
    assert any("tolerance 30" in note.get_text() for note in notes(axes))  # the end of the front is named
    for note in notes(axes):  # below and left of its point, come what may
        note.set_position((-6, -5))
    assert faults(axes) != []


def test_a_label_without_room_is_left_out() -> None:
    figure = Figure(figsize=(2.0, 2.0))
    axes = figure.add_subplot()
    axes.plot([0.0, 1.0], [0.0, 1.0])
    many = [Label(f"label number {n}", 0.5, 0.5) for n in range(40)]
    placed = place_labels(axes, many)
    assert 0 < len(placed) < len(many)
    assert len(axes.texts) == len(placed)
    assert faults(axes) == []
