"""The HTML report: one file, no network, readable on a phone."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from importlib import resources
from typing import Any

import jinja2
import pandas as pd

from plyflow.paper.demo_figures import Panel
from plyflow.paper.demo_table import largest_difference
from plyflow.run.case_run import RunResult

GROUPS = {
    "thickness": "Final thickness over temperature",
    "width": "Final width over temperature",
    "time": "Thickness over time",
}
LIMITS = (
    "One material point: uniform deformation, no friction at the plates, no interaction between blocks.",
    "The one-dimensional law is what the UMAT must reproduce; it is not a measurement, and no measured "
    "points are shown.",
    "gamma_lock, l0/d and the bulk lock strain are not in the paper: the values used are assumptions and "
    "move both the UMAT and the law.",
    "The parameters come from cross-ply specimens of 15 mm between 30 and 90 degC; blocked plies and 30 mm "
    "specimens use the same parameters.",
    "Isothermal, no cure; the fibre is held inextensible, so the fibre modulus does not enter.",
)


def render_report(
    results: Sequence[RunResult],
    table: pd.DataFrame,
    panels: Sequence[Panel],
    failures: Mapping[str, str],
    timing: Mapping[str, Any],
) -> str:
    """Render the report as HTML text.

    Parameters
    ----------
    results, table, panels : finished cases, their table and figures.
    failures : mapping
        Label of each case that did not finish to its reason.
    timing : mapping
        Line to print (what) to its value (how long), in order.
    """
    template = resources.files("plyflow") / "paper" / "demo.html.j2"
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    page = environment.from_string(template.read_text(encoding="utf-8"))
    provenance = {name: value for name, value in results[0].provenance.items() if name != "inputs"}
    provenance["scene"] = ", ".join(f"{name} = {value}" for name, value in provenance["scene"].items())
    return page.render(
        rows=table.to_dict("records"),
        groups=[
            (title, [_embedded(panel) for panel in panels if panel.group == name])
            for name, title in GROUPS.items()
        ],
        largest={name: largest_difference(table, name) for name in ("thickness", "width")},
        assumptions=[*common_assumptions(results), lock_strain_line(results)],
        provenance=provenance,
        failures=failures,
        timing=timing,
        limits=[*LIMITS, *width_notes(results)],
        totals={name: int(table[name].sum()) for name in ("increments", "iterations", "cutbacks")},
    )


def common_assumptions(results: Sequence[RunResult]) -> list[str]:
    """Assumption lines shared by every case, in order."""
    shared = set.intersection(*(set(result.assumptions) for result in results))
    return [line for line in results[0].assumptions if line in shared]


def lock_strain_line(results: Sequence[RunResult]) -> str:
    """Range of eps_lock [-] over the cases."""
    strains = [result.values["eps_lock"] for result in results]
    return f"eps_lock, by Eq. 6 for each block's geometry: {max(strains):.4f} to {min(strains):.4f}"


def width_notes(results: Sequence[RunResult]) -> list[str]:
    """What to know about the final widths when every case has locked."""
    if any(result.lock_time is None for result in results):
        return []
    return [
        "Every case reaches the lock, so its final width is exp(-eps_lock) and depends on geometry alone; "
        "the paper reports widths of blocked plies that rise with temperature to a plateau near 70 degC."
    ]


def _embedded(panel: Panel) -> dict[str, str]:
    data = base64.b64encode(panel.svg.encode("utf-8")).decode("ascii")
    return {"caption": panel.caption, "source": f"data:image/svg+xml;base64,{data}"}
