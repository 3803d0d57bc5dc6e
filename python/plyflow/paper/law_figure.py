"""One figure of a few histories: thickness over time, the comparison laws dashed."""

from __future__ import annotations

import io
from collections.abc import Sequence

import matplotlib
from matplotlib.figure import Figure

from plyflow.paper.demo_figures import RC
from plyflow.run.law_run import COMPARISON, CaseHistory

MOST_LINES = 12
STYLES = {"rogers": (0, (1, 2)), "wang_gutowski": (0, (4, 3))}


def history_figure(histories: Sequence[CaseHistory]) -> str:
    """SVG text: the model as solid lines, the comparison laws of each case dashed in its colour."""
    with matplotlib.rc_context(RC):
        figure = Figure(figsize=(6.4, 4.2), layout="constrained")
        axes = figure.add_subplot()
        for place, history in enumerate(histories[:MOST_LINES]):
            colour = f"C{place % 10}"
            table = history.table()
            axes.plot(table["time_s"], table["thickness_ratio"], color=colour, label=history.case.specimen)
            for name in history.comparison:
                values = table[f"thickness_ratio_{name}"]
                axes.plot(table["time_s"], values, color=colour, linestyle=STYLES[name], linewidth=1.0)
        for name, style in STYLES.items():
            axes.plot([], [], color="black", linestyle=style, linewidth=1.0, label=COMPARISON[name])
        axes.set(xlabel="time [s]", ylabel=r"thickness $h / h_0$ [-]")
        axes.legend(fontsize=8, frameon=False)
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None})
    return stream.getvalue()
