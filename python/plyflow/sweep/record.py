"""The record beside the result: inputs, assumptions, tools; without times, so that equal sweeps have equal records."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import metadata
from typing import Any

from plyflow.case.assumptions import default_assumptions
from plyflow.case.materials import INTERPOLATION
from plyflow.sweep.axes import NUMBER_NAMES, TEXT_NAMES
from plyflow.sweep.plan import DEFAULTS, UMAT_DEFAULTS, Plan

LIBRARIES = ("numpy", "pandas", "pyarrow", "dask")
COLUMNS = {
    "case": "number of the case in the list, from 1",
    "status": "done or failed",
    "reason": "why a case failed",
    "thickness_ratio": "h/h0 at the end of the load",
    "thickness_mm": "thickness of the specimen of 16 plies at the end [mm]",
    "thickness_ratio_limit": "h/h0 at the compaction limit",
    "width_ratio": "w/w0 at the end",
    "width_mm": "width at the end [mm]",
    "fibre_fraction": "fibre volume fraction at the end",
    "lock_time_s": "time at which the ply locks [s], empty if it does not",
    "eps_lock": "compaction at locking (Eq. 6)",
    "*_1d": "the same by the one-dimensional law",
    "increments, iterations, cutbacks": "of the driver",
}


def sweep_record(plan: Plan, key: str, counts: Mapping[str, Any] | None) -> dict[str, Any]:
    """Plain data of a sweep, begun (no counts) or complete."""
    varied = set(plan.source.columns)
    filled = DEFAULTS | (UMAT_DEFAULTS if plan.model == "umat" else {})
    return {
        "key": key,
        "complete": counts is not None,
        "cases": len(plan.source),
        **(counts or {}),
        "inputs": plan.inputs(),
        "defaults": {name: value for name, value in filled.items() if name not in varied},
        "assumptions": [
            *(str(entry) for name, entry in default_assumptions().items() if name not in varied),
            *(f"{name}: a column of the table" for name in plan.columns if name not in (*TEXT_NAMES, *NUMBER_NAMES)),
            f"material parameters: between the columns of the material's table by {INTERPOLATION}"
            + (", straight on outside them" if plan.extrapolate else ", refused outside them"),
            "eps_lock by Eq. 6 unless it is a column; a block of equal plies acts as one ply",
            "plate pressure = force / (width x width); fibre inextensible, edge free",
        ],
        "columns": COLUMNS,
        "libraries": {name: metadata.version(name) for name in LIBRARIES},
    }
