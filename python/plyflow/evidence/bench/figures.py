"""Log-log figures: error against processor time and against increments, with the front of what is best."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from plyflow.evidence.bench.accuracy import Cost, front, increments, median_seconds
from plyflow.evidence.bench.measure import Point
from plyflow.evidence.bench.problems import QUANTITIES, Problem
from plyflow.evidence.bench.schemes import Scheme
from plyflow.show.figure import GREY, MARKS, PALETTE, panels, styled

Look = tuple[str, str, str]  # label, colour, mark


@styled
def draw(problem: Problem, quantity: str, points: Sequence[Point], looks: dict[str, Look]) -> Figure:
    """One figure of two panels, error over processor time and over increments; `points` are those of the problem."""
    figure, (left, right) = panels(2, (10.8, 5.5), sharey=True, width_ratios=(1.3, 1.0))
    shown = [p for p in points if p.errors.get(quantity, 0.0) > 0.0]
    _panel(left, shown, quantity, lambda p: 1e3 * median_seconds(p), looks)
    _panel(right, shown, quantity, increments, looks)
    left.set(xlabel="processor time, median [ms]", ylabel=QUANTITIES[quantity])
    right.set(xlabel="increments")
    figure.suptitle(problem.label)
    handles = dict(zip(*reversed(left.get_legend_handles_labels()), strict=True))
    figure.legend(list(handles.values()), list(handles), loc="outside lower center", ncols=5)
    return figure


def looks_of(schemes: Sequence[Scheme]) -> dict[str, Look]:
    """Label, colour and mark of each scheme, the same in all figures; grey for those that lie behind, drawn first."""
    apart = [scheme.name for scheme in schemes if scheme.stands_out]
    behind: dict[str, Look] = {s.name: ("other scenes", GREY, ".") for s in schemes if not s.stands_out}
    return behind | {name: (name, PALETTE[n % len(PALETTE)], MARKS[n % len(MARKS)]) for n, name in enumerate(apart)}


def _panel(axes: Axes, points: Sequence[Point], quantity: str, cost: Cost, looks: dict[str, Look]) -> None:
    axes.set(xscale="log", yscale="log")
    for name, (label, colour, mark) in looks.items():
        mine = [p for p in points if p.scheme == name]
        for family in dict.fromkeys(p.family for p in mine):
            line = [(cost(p), p.errors[quantity]) for p in mine if p.family == family]
            axes.plot(*zip(*line, strict=True), color=colour, marker=mark, markersize=4, alpha=0.85, linewidth=0.9,
                      linestyle=":" if family == "tolerance" else "-", label="_" if family == "tolerance" else label)  # fmt: skip
    best = front(points, quantity, cost)
    axes.step([cost(p) for p in best], [p.errors[quantity] for p in best], where="post", color="black", linewidth=2.2, alpha=0.35,
              zorder=1, label="front")  # fmt: skip
