"""The whole compaction programme by the one-dimensional law, a row a case: what claims and figures look at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from plyflow.case.case import all_cases
from plyflow.case.programme import paper_programme
from plyflow.law import batch, integrate_batch


def programme_table(settings: Mapping[str, float], load: str = "ramp-dwell") -> pd.DataFrame:
    """Final state of the 84 cases.

    Parameters
    ----------
    settings : mapping
        Assumptions and constants by name, as `plyflow.case.case.Case.settings`.
    load : str
        "ramp-dwell" or "monotonic".

    Returns
    -------
    pandas.DataFrame
        material, temperature [degC], layup, width [mm]; thickness = h/h0, limit = h/h0 at the compaction limit,
        widening = w/w0, locked, lock_time [s], early: part of the compaction done after a fifth of the test.
    """
    rows: list[dict[str, Any]] = []
    for specimen in paper_programme().specimen:
        cases = [case for case in all_cases(load) if case.width == specimen.width]
        laws = [replace(case, settings=settings).law() for case in cases]
        programme = cases[0].load_programme
        solution = integrate_batch(batch(laws), programme, [0.2 * programme.end, programme.end])
        for row, (case, law) in enumerate(zip(cases, laws, strict=True)):
            thickness = solution.thickness_ratio[row]
            rows.append(
                {
                    "material": case.material,
                    "temperature": case.temperature,
                    "layup": case.layup,
                    "width": case.width,
                    "thickness": float(thickness[-1]),
                    "limit": float(np.exp(law.eps_limit)),
                    "widening": float(solution.width_ratio[row, -1]),
                    "locked": bool(solution.locked[row, -1]),
                    "lock_time": float(solution.lock_time[row]),
                    "early": float((1.0 - thickness[0]) / (1.0 - thickness[-1])),
                }
            )
    return pd.DataFrame(rows)


def by_layup(table: pd.DataFrame, quantity: str) -> pd.DataFrame:
    """A quantity with a column a layup and a row a material, width and temperature."""
    return table.pivot_table(index=["material", "width", "temperature"], columns="layup", values=quantity)


def steps_of(table: pd.DataFrame, quantity: str, low: float, high: float) -> pd.Series:
    """Largest change of a quantity between neighbouring temperatures from low to high [degC], for each specimen kind."""
    inside = table[(table["temperature"] >= low) & (table["temperature"] <= high)]
    groups = inside.sort_values("temperature").groupby(["material", "layup", "width"])[quantity]
    return groups.apply(lambda values: float(np.max(np.abs(np.diff(values)))))
