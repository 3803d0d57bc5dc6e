"""Figures of the compaction programme; UMAT as solid lines or marks, one-dimensional law dashed."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from plyflow.run.case_run import RunResult

LAYUP_STYLES = {"CP": ("#0072B2", "o"), "SB": ("#D55E00", "s"), "BP": ("#009E73", "^")}
LAYUP_NAMES = {"CP": "cross-ply", "SB": "semi-blocked", "BP": "blocked"}
PANEL_SIZE = (4.4, 3.7)
LAW_STYLE: dict[str, Any] = {"color": "black", "linestyle": (0, (4, 3)), "linewidth": 0.9}
RC: Any = {
    "font.size": 10.0,
    "svg.fonttype": "path",
    "svg.hashsalt": "plyflow",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.6,
}


@dataclass(frozen=True)
class Panel:
    """One figure: file name without ending, group it belongs to, caption, SVG text."""

    name: str
    group: str
    caption: str
    svg: str


def all_panels(results: Sequence[RunResult]) -> list[Panel]:
    """Every figure of the programme: thickness over time, final thickness and width over temperature."""
    with matplotlib.rc_context(RC):
        return [*_time_panels(results), *_final_panels(results)]


def temperature_colour(temperature: float, low: float = 30.0, high: float = 90.0) -> tuple[float, ...]:
    """Colour of a temperature [degC], dark (cold) to bright (hot)."""
    place = 0.5 if high <= low else (temperature - low) / (high - low)
    return tuple(matplotlib.colormaps["plasma"](0.88 * place))


def _groups(
    results: Iterable[RunResult], key: Callable[[RunResult], tuple[object, ...]]
) -> list[list[RunResult]]:
    found: dict[tuple[object, ...], list[RunResult]] = {}
    for result in results:
        found.setdefault(key(result), []).append(result)
    return list(found.values())


def _time_panels(results: Sequence[RunResult]) -> list[Panel]:
    bottom = min(float(result.thickness_ratio[-1]) for result in results) - 0.02
    groups = _groups(results, lambda one: (one.case.material, one.case.width, one.case.layup))
    return [_time_panel(group, bottom) for group in groups]


def _time_panel(group: list[RunResult], bottom: float) -> Panel:
    case = group[0].case
    caption = (
        f"{case.material}, {LAYUP_NAMES[case.layup]} ({case.layup}), {case.width:g} mm, {case.load}: "
        "thickness over time, UMAT (colour) and one-dimensional law (dashed)."
    )
    name = _slug("thickness-time", case.material, case.layup, case.width)
    return Panel(name, "time", caption, _svg(time_figure(group, bottom)))


def time_figure(group: Sequence[RunResult], bottom: float) -> Figure:
    """Thickness over time of the cases of one stack, from `bottom` [-] up; the legend stands below the axes."""
    case = group[0].case
    figure, axes = _new_panel()
    temperatures = [result.case.temperature for result in group]
    for result in group:
        colour = temperature_colour(result.case.temperature, min(temperatures), max(temperatures))
        label = f"{result.case.temperature:g} °C"
        axes.plot(
            result.history.time, result.thickness_ratio, color=colour, linewidth=3.0, alpha=0.65, label=label
        )
        axes.plot(result.law.time, result.law.thickness_ratio, **LAW_STYLE)
    axes.set(xlabel="time [s]", ylabel=r"thickness $h / h_0$ [-]", ylim=(bottom, 1.005))
    axes.set_xlim(0.0, case.load_programme.end)
    axes.set_title(f"{case.material}, {case.layup}, {case.width:g} mm")
    handles = [*axes.get_legend_handles_labels()[0], Line2D([], [], label="1D law", **LAW_STYLE)]
    figure.legend(handles=handles, fontsize=8, ncols=4, frameon=False, loc="outside lower center")
    return figure


def _final_panels(results: Sequence[RunResult]) -> list[Panel]:
    panels = []
    for quantity in ("thickness", "width"):
        values = [_final(result, quantity)[0] for result in results]
        margin = 0.06 * (max(values) - min(values)) + 1e-3
        limits = (min(values) - margin, max(values) + margin)
        for group in _groups(results, lambda one: (one.case.material, one.case.width)):
            panels.append(_final_panel(group, quantity, limits))
    return panels


def _final(result: RunResult, quantity: str) -> tuple[float, float]:
    if quantity == "thickness":
        return float(result.thickness_ratio[-1]), float(result.law.thickness_ratio[-1])
    return float(result.width_ratio[-1]), float(result.law.width_ratio[-1])


def _final_panel(group: list[RunResult], quantity: str, limits: tuple[float, float]) -> Panel:
    case = group[0].case
    figure, axes = _new_panel()
    for layup in _groups(group, lambda one: (one.case.layup,)):
        name = layup[0].case.layup
        colour, marker = LAYUP_STYLES[name]
        temperatures = [result.case.temperature for result in layup]
        umat, law = zip(*(_final(result, quantity) for result in layup), strict=True)
        axes.plot(temperatures, umat, color=colour, marker=marker, linestyle="none", label=f"{name} UMAT")
        axes.plot(
            temperatures, law, color=colour, linestyle=(0, (4, 3)), linewidth=1.2, label=f"{name} 1D law"
        )
    ratio = "$h / h_0$" if quantity == "thickness" else "$w / w_0$"
    axes.set(xlabel="temperature [°C]", ylabel=f"final {quantity} {ratio} [-]", ylim=limits)
    axes.set_title(f"{case.material}, {case.width:g} mm")
    figure.legend(
        *axes.get_legend_handles_labels(), fontsize=8, ncols=3, frameon=False, loc="outside lower center"
    )
    caption = (
        f"{case.material}, {case.width:g} mm, {case.load}: final {quantity} over temperature, "
        "UMAT (marks) and one-dimensional law (dashed)."
    )
    return Panel(_slug(f"{quantity}-final", case.material, case.width), quantity, caption, _svg(figure))


def _new_panel() -> tuple[Figure, Axes]:
    figure = Figure(figsize=PANEL_SIZE, layout="constrained")
    return figure, figure.add_subplot()


def _svg(figure: Figure) -> str:
    stream = io.StringIO()
    figure.savefig(stream, format="svg", metadata={"Date": None})
    return stream.getvalue()


def _slug(*parts: object) -> str:
    return "-".join(f"{part:g}" if isinstance(part, float) else str(part).lower() for part in parts)
