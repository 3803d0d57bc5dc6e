"""Parts of a sweep: computed anywhere, as the bytes of one Parquet file each."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from plyflow.hosts.laminate.needs import require_libraries
from plyflow.sweep.axes import TEXT_NAMES
from plyflow.sweep.law_cases import run_law_rows
from plyflow.sweep.plan import Plan
from plyflow.sweep.umat_cases import BESIDE, run_umat_rows

LAW_RESULTS = (
    "thickness_ratio", "thickness_mm", "thickness_ratio_limit", "width_ratio", "width_mm", "fibre_fraction",
    "lock_time_s", "eps_lock",
)  # fmt: skip
LAMINATE_RESULTS = ("width_ratio_inner", "width_ratio_outer", "lock_time_last_s", "locked_share")
LAMINATE_HISTORY = ("times_s", "thickness_ratios")
COUNTS = ("increments", "iterations", "cutbacks")
Finished = tuple[int, bytes, int]  # number of the part, its Parquet file, how many of its cases failed


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

    def run(self) -> Finished:
        """Run all cases."""
        if self.model == "law1d":
            results = run_law_rows(self.rows, self.extrapolate)
        else:
            run = run_umat_rows if self.model == "umat" else _laminates()
            results = run(self.rows, self.umats, self.extrapolate)
        rows = enumerate(zip(self.rows, results, strict=True), start=self.first)
        table = [{"case": case} | found | row for case, (row, found) in rows]
        stream = io.BytesIO()
        pq.write_table(pa.Table.from_pylist(table, schema=result_schema(self.columns, self.model)), stream)
        return self.number, stream.getvalue(), sum(found["status"] == "failed" for found in results)


def result_schema(inputs: Sequence[str], model: str) -> Any:
    """Schema of the result table: case, inputs, status, reason, results; lengths [mm], times [s]."""
    results = dict.fromkeys(LAW_RESULTS, pa.float64())
    if model != "law1d":
        results |= dict.fromkeys(BESIDE.values(), pa.float64()) | dict.fromkeys(COUNTS, pa.int64())
    if model == "laminate":
        results |= dict.fromkeys(LAMINATE_RESULTS, pa.float64()) | dict.fromkeys(LAMINATE_HISTORY, pa.string())
    given = {name: pa.string() if name in TEXT_NAMES else pa.float64() for name in inputs}
    # A result that is an input too (eps_lock set by the user) keeps its place among the inputs.
    return pa.schema({"case": pa.int64()} | given | {"status": pa.string(), "reason": pa.string()} | results)


def parts_of(plan: Plan, wanted: Iterable[int]) -> Iterator[Part]:
    """Those parts of a plan whose numbers are wanted, one at a time."""
    for number in sorted(wanted):
        start = number * plan.chunk_size
        rows = [plan.defaults | row for row in plan.source.rows(start, start + plan.chunk_size)]
        yield Part(number, start + 1, rows, plan.model, plan.columns, plan.umats, plan.extrapolate)


def _laminates() -> Callable[..., list[dict[str, Any]]]:
    require_libraries()
    # Loading felupe takes a second, so only sweeps of laminates pay for it.
    from plyflow.sweep.laminate_cases import run_laminate_rows  # noqa: PLC0415

    return run_laminate_rows
