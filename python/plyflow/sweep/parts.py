"""Parts of a sweep: computed anywhere, as the bytes of one Parquet file each."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from plyflow.sweep.axes import TEXT_NAMES
from plyflow.sweep.law_cases import run_law_rows
from plyflow.sweep.plan import DEFAULTS, UMAT_DEFAULTS, Plan
from plyflow.sweep.umat_cases import BESIDE, run_umat_rows

LAW_RESULTS = (
    "thickness_ratio", "thickness_mm", "thickness_ratio_limit", "width_ratio", "width_mm", "fibre_fraction",
    "lock_time_s", "eps_lock",
)  # fmt: skip
COUNTS = ("increments", "iterations", "cutbacks")


@dataclass(frozen=True)
class Part:
    """Some cases of a sweep: number of the part, first case (from 1), rows, and what running them needs."""

    number: int
    first: int
    rows: Sequence[dict[str, Any]]
    model: str
    columns: tuple[str, ...]
    umats: Mapping[str, Mapping[str, Any]]
    extrapolate: bool = False


def result_schema(plan_columns: Sequence[str], model: str) -> Any:
    """Schema of the result table: case, inputs, status, reason, results; lengths [mm], times [s]."""
    results = [(name, pa.float64()) for name in LAW_RESULTS]
    if model == "umat":
        results += [(name, pa.float64()) for name in BESIDE.values()] + [(name, pa.int64()) for name in COUNTS]
    inputs = [(name, pa.string() if name in TEXT_NAMES else pa.float64()) for name in plan_columns]
    # A result that is an input too (eps_lock set by the user) stays with the inputs.
    results = [entry for entry in results if entry[0] not in plan_columns]
    return pa.schema([("case", pa.int64()), *inputs, ("status", pa.string()), ("reason", pa.string()), *results])


def parts_of(plan: Plan, wanted: set[int]) -> Any:
    """Those parts of a plan whose numbers are wanted, one at a time."""
    filled = DEFAULTS | (UMAT_DEFAULTS if plan.model == "umat" else {})
    for number, rows in enumerate(plan.source.chunks(plan.chunk_size)):
        if number in wanted:
            full = [filled | row for row in rows]
            first = 1 + number * plan.chunk_size
            yield Part(number, first, full, plan.model, plan.columns, plan.umats, plan.extrapolate)


def run_part(part: Part) -> tuple[int, bytes, int]:
    """Number of the part, its Parquet file, and how many of its cases failed."""
    if part.model == "umat":
        results = run_umat_rows(part.rows, part.umats, part.extrapolate)
    else:
        results = run_law_rows(part.rows, part.extrapolate)
    rows = zip(part.rows, results, strict=True)
    table = [{"case": part.first + place} | found | row for place, (row, found) in enumerate(rows)]
    stream = io.BytesIO()
    pq.write_table(pa.Table.from_pylist(table, schema=result_schema(part.columns, part.model)), stream)
    return part.number, stream.getvalue(), sum(found["status"] == "failed" for found in results)
