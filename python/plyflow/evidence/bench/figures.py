"""Log-log figures: error against run time and against increments, with the labelled front of what is best."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plyflow.evidence.bench.accuracy import front, median_seconds
from plyflow.evidence.bench.labels import Label, place_labels
from plyflow.evidence.bench.measure import Point
from plyflow.evidence.bench.problems import QUANTITIES, Problem
from plyflow.show.figure import STYLE as RC

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8C564B", "#7F3C8D", "#444444")
MARKS = "os^Dv<>PX"
OTHERS = "#A0A0A0"
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
    costs: dict[Axes, Cost] = {left: lambda p: 1e3 * median_seconds(p), right: lambda p: float(p.increments)}
    for axes, cost in costs.items():
        _panel(axes, points, quantity, cost, colours)
    left.set_xlabel("run time, median [ms]")
    right.set_xlabel("increments")
    left.set_ylabel(QUANTITIES[quantity])
    figure.suptitle(problem.label)
    handles = dict(zip(*reversed(left.get_legend_handles_labels()), strict=True))
    figure.legend(list(handles.values()), list(handles), loc="outside lower center", ncols=5, frameon=False, fontsize=8)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # labels are placed in the layout as it stands
    for axes, cost in costs.items():
        place_labels(axes, front_labels(points, quantity, cost))
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
    axes.margins(0.18, 0.16)


def _mark(number: int, colour: str) -> str:
    return "." if colour == OTHERS else MARKS[number % len(MARKS)]


def _line(
    axes: Axes, points: Sequence[Point], quantity: str, cost: Cost, name: str, colour: str, mark: str
) -> None:
    style: dict[str, Any] = {"linestyle": ":" if points[0].family == "tolerance" else "-", "linewidth": 0.9}
    label = None if points[0].family == "tolerance" else "other scenes" if colour == OTHERS else name
    axes.plot([cost(p) for p in points], [p.errors[quantity] for p in points], color=colour, marker=mark,
              markersize=4, alpha=0.85, label=label, **style)  # fmt: skip


def front_labels(points: Sequence[Point], quantity: str, cost: Cost) -> list[Label]:
    """Scheme and step control of the front's points: its two ends first, then from the most accurate on."""
    best = front(points, quantity, cost)
    ordered = [*best[-1:], *best[:1], *reversed(best[1:-1])] if len(best) > 1 else best
    return [Label(f"{p.scheme}\n{p.control}", cost(p), p.errors[quantity]) for p in ordered]
