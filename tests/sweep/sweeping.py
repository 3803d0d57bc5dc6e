"""What several tests of sweeps need: small plans, the bytes of a result, a run in this process."""

from __future__ import annotations

import io
from pathlib import Path

import pandas as pd
from rich.console import Console

from plyflow.sweep.plan import Plan, make_plan
from plyflow.sweep.run import SweepOutcome, run_sweep
from plyflow.sweep.sources import read_source
from plyflow.sweep.store import RECORD, RESULT, TABLE

GRID = ("material=IM7-8552,IMA-M21", "temperature=30:90:10", "layup=CP,SB,BP", "width=15,30")


def grid_plan(*entries: str, model: str = "law1d", chunk: int | None = None) -> Plan:
    return make_plan(read_source(None, entries or GRID, {})[0], model, chunk)


def sweep_into(folder: Path, plan: Plan, workers: int = 0, overwrite: bool = False) -> SweepOutcome:
    return run_sweep(plan, folder, Console(file=io.StringIO()), workers=workers, overwrite=overwrite)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def result_of(folder: Path) -> pd.DataFrame:
    assert sorted(contents(folder)) == sorted([RESULT, TABLE, RECORD])
    return pd.read_parquet(folder / RESULT)
