"""What an autoclave engineer looks at: temperature and pressure, thickness with its limit, fibre fraction, over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from plyflow.law import LoadProgramme
from plyflow.show.figure import BLUE, GREY, PALETTE, RED, panels, styled, svg

FloatArray = NDArray[np.float64]
SIZE = (7.2, 7.2)
LONG = 7200.0  # s, from where the axis counts in minutes


@dataclass(frozen=True)
class CycleCurve:
    """A case in the figure: label, time (n,) [s], h/h0 (n,), fibre fraction (n,), lock time [s], h/h0 at the limit (n,)."""

    label: str
    time: FloatArray
    thickness_ratio: FloatArray
    fibre_fraction: FloatArray
    lock_time: float | None
    limit: FloatArray | None = None


@styled
def cycle_figure(load: LoadProgramme, curves: Sequence[CycleCurve]) -> str:
    """SVG of a cycle and what cases do in it."""
    unit, word = (60.0, "min") if load.end >= 0.25 * LONG else (1.0, "s")
    figure, (given, thickness, fraction) = panels(1, SIZE, rows=3, sharex=True)
    _draw_load(given, load, unit)
    for place, curve in enumerate(curves):
        colour = PALETTE[place % len(PALETTE)]
        thickness.plot(curve.time / unit, curve.thickness_ratio, color=colour, label=curve.label)
        fraction.plot(curve.time / unit, curve.fibre_fraction, color=colour)
        if curve.limit is not None:
            thickness.plot(curve.time / unit, curve.limit, color=colour, linestyle=":", linewidth=1.0)
        if curve.lock_time is not None:
            for axes in (thickness, fraction):
                axes.axvline(curve.lock_time / unit, color=colour, linestyle="--", linewidth=0.8)
    thickness.plot([], [], color=GREY, linestyle=":", linewidth=1.0, label="limit at the temperature of the moment")
    thickness.plot([], [], color=GREY, linestyle="--", linewidth=0.8, label="lock: bleeding from here on")
    thickness.set(ylabel="thickness $h/h_0$ [-]")
    thickness.legend()
    fraction.set(ylabel="fibre fraction [-]", xlabel=f"time [{word}]")
    return svg(figure)


def _draw_load(axes: Axes, load: LoadProgramme, unit: float) -> None:
    times = np.array(load.times) / unit
    axes.plot(times, load.temperatures, color=RED)
    axes.set_ylabel("temperature [degC]", color=RED)
    beside = axes.twinx()
    beside.plot(times, load.pressures, color=BLUE)
    beside.set_ylabel("pressure [MPa]", color=BLUE)
    beside.spines["right"].set_visible(True)
    beside.grid(False)
