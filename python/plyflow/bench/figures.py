"""Log-log figures: error against run time and against increments, with the labelled front of what is best."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plyflow.bench.accuracy import front, median_seconds
from plyflow.bench.measure import Point
from plyflow.bench.problems import QUANTITIES, Problem
from plyflow.report.figures import RC

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8C564B", "#7F3C8D", "#444444")
MARKS = "os^Dv<>PX"
OTHERS = "#A0A0A0"
LABEL_EVERY = 0.35  # decades between labels of the front
PANEL = (5.4, 4.4)
Cost = Callable[[Point], float]


def figures(problems: Sequence[Problem], points: Sequence[Point], colours: Mapping[str, str]) -> dict[str, str]:
    """SVG text by file name: one figure for each problem and quantity, two panels each."""
    found = {}
    with matplotlib.rc_context(RC):
        for problem in problems:
            for quantity in problem.quantities:
                mine = [p for p in points if p.problem == problem.name and p.errors.get(quantity, 0.0) > 0.0]
                figure = draw(problem, quantity, mine, colours)
                stream = io.StringIO()
                figure.savefig(stream, format="svg", metadata={"Date": None})
                found[f"{problem.name}-{quantity}.svg"] = stream.getvalue()
    return found


def draw(problem: Problem, quantity: str, points: Sequence[Point], colours: Mapping[str, str]) -> Figure:
    """One figure of two panels."""
    figure = Figure(figsize=(2 * PANEL[0], PANEL[1] + 1.1), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=(1.3, 1.0))
    _panel(left, points, quantity, lambda p: 1e3 * median_seconds(p), colours)
    _panel(right, points, quantity, lambda p: float(p.increments), colours)
    left.set_xlabel("run time, median [ms]")
    right.set_xlabel("increments")
    left.set_ylabel(QUANTITIES[quantity])
    figure.suptitle(problem.label)
    handles = dict(zip(*reversed(left.get_legend_handles_labels()), strict=True))
    figure.legend(list(handles.values()), list(handles), loc="outside lower center", ncols=5, frameon=False, fontsize=8)
    return figure


def scheme_colours(names: Sequence[str], told_apart: Sequence[str]) -> dict[str, str]:
    """A colour for each scheme that is told apart, the same in all figures, and grey for the others, which lie behind."""
    colours = {name: COLOURS[n % len(COLOURS)] for n, name in enumerate(told_apart)}
    return {name: OTHERS for name in names if name not in colours} | colours


def _panel(axes: Axes, points: Sequence[Point], quantity: str, cost: Cost, colours: Mapping[str, str]) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    for number, (name, colour) in enumerate(colours.items()):
        mine = [p for p in points if p.scheme == name]
        for family in dict.fromkeys(p.family for p in mine):
            _line(axes, [p for p in mine if p.family == family], quantity, cost, name, colour, _mark(number, colour))
    best = front(points, quantity, cost)
    across, up = [cost(p) for p in best], [p.errors[quantity] for p in best]
    axes.step(across, up, where="post", color="black", linewidth=2.2, alpha=0.35, zorder=1, label="front")
    _label_front(axes, best, quantity, cost)


def _mark(number: int, colour: str) -> str:
    return "." if colour == OTHERS else MARKS[number % len(MARKS)]


def _line(
    axes: Axes, points: Sequence[Point], quantity: str, cost: Cost, name: str, colour: str, mark: str
) -> None:
    style: dict[str, Any] = {"linestyle": ":" if points[0].family == "tolerance" else "-", "linewidth": 0.9}
    label = None if points[0].family == "tolerance" else "other scenes" if colour == OTHERS else name
    axes.plot([cost(p) for p in points], [p.errors[quantity] for p in points], color=colour, marker=mark,
              markersize=4, alpha=0.85, label=label, **style)  # fmt: skip


def _label_front(axes: Axes, best: Sequence[Point], quantity: str, cost: Cost) -> None:
    """Name and level below and left of the front's points, from the most accurate on, as many as fit."""
    last = -math.inf
    for point in reversed(best):
        height = math.log10(point.errors[quantity])
        if height - last < LABEL_EVERY:
            continue
        last = height
        axes.annotate(
            f"{point.scheme}\n{point.control}", (cost(point), point.errors[quantity]), xytext=(-6, -5),
            textcoords="offset points", ha="right", va="top", fontsize=7,
        )  # fmt: skip
    axes.margins(0.18, 0.16)
