"""The cell behind Eq. A.1, drawn."""

from __future__ import annotations

import math
from functools import cache

from matplotlib.patches import Circle, Polygon

from plyflow.law.equations import cell_sine
from plyflow.show.figure import BLUE, GREY, RED, panels, styled, svg
from plyflow.show.page import Picture

_K, _FRACTION = 0.813, 0.5  # IM7-8552 at 70 C


@cache
@styled
def cell() -> Picture:
    """Fibres of diameter d at the corners of the cell, and the two legs whose ratio Eq. A.1 has as its argument."""
    alpha = math.asin(cell_sine(_K, _FRACTION))
    lean, height = math.cos(alpha), math.sin(alpha)
    side = math.pi / (4 * _FRACTION) / height  # the area, that of one fibre over its fraction, is side times height
    figure, (axes,) = panels(1, (6.4, 1.9))
    corners = [(0.0, 0.0), (side, 0.0), (side + lean, height), (lean, height)]
    for corner in corners:
        axes.add_patch(Circle(corner, 0.5, facecolor="none", edgecolor=GREY))
    axes.add_patch(Polygon(corners, facecolor="none", edgecolor="black", linewidth=1.2))
    axes.plot([lean, side, side], [height, height, 0.0], color=RED)
    axes.plot([side, lean], [0.0, height], color=BLUE, linestyle="--")
    for x, y, text in ((side / 2, -0.3, "$s$"), (0.3, 0.3, "$d$"), ((lean + side) / 2, height + 0.12, r"$s - d\,\cos\alpha$")):
        axes.text(x, y, text, ha="center")
    axes.text(side + 0.06, height + 0.12, r"$d\,\sin\alpha$")
    axes.text(side - 0.55, 0.12, r"$\gamma$", color=BLUE)
    axes.set(aspect="equal", xlim=(-0.6, side + lean + 0.6), ylim=(-0.6, height + 0.6))
    axes.axis("off")
    return Picture(
        svg(figure),
        "Cell of sides s and d, IM7-8552 at 70 C: the upper fibre stands over the lower one after the shear angle whose tangent is "
        "the ratio of the two legs in red",
    )
