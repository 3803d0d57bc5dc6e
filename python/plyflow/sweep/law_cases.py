"""A part of a sweep by the one-dimensional law: all cases of one load shape at once, by quadrature."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from plyflow.case.case import Case
from plyflow.case.loads import find_load
from plyflow.case.programme import LOADS
from plyflow.case.solution import final_law, solve
from plyflow.errors import PlyflowError
from plyflow.law import LawHistory, LawParameters, LoadProgramme, batch, integrate_batch

CASE_NAMES = ("material", "temperature", "layup", "width")
NO_SETTINGS = (*CASE_NAMES, "load", "scene", "refine")
SHAPE_DIGITS = 12
Shape = tuple[tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True)
class LawTask:
    """A case ready to run: its place in the part, case, constants (at the end of a cycle), load, initial fibre fraction [-]."""

    place: int
    case: Case
    law: LawParameters
    load: LoadProgramme
    fibre_fraction: float


def failed(error: Exception) -> dict[str, Any]:
    """Result of a case that could not be finished."""
    words = " ".join(str(error).split())
    reason = words if isinstance(error, PlyflowError) else f"unexpected {type(error).__name__}: {words}"
    return {"status": "failed", "reason": reason}


def law_case(row: dict[str, Any], extrapolate: bool = False, load: str = LOADS[0]) -> Case:
    """The case of a row; what is not its name, load or scene is a setting; a `load` that is a cycle brings its temperatures along."""
    missing = [name for name in CASE_NAMES if name not in row and not (name == "temperature" and load not in LOADS)]
    if missing:
        raise PlyflowError(f"no {missing[0]} given")
    if math.isnan(row.get("temperature", 0.0)):
        raise PlyflowError("temperature nan must be a finite number")
    settings = {name: value for name, value in row.items() if name not in NO_SETTINGS}
    names = (row["material"], row.get("temperature", math.nan), row["layup"], row["width"])
    return Case(*names, load, settings=settings, extrapolate=extrapolate)


def run_law_rows(rows: Sequence[dict[str, Any]], extrapolate: bool = False) -> list[dict[str, Any]]:
    """Results of cases (n) by name, in order; a case that cannot be set up or finished says why.

    `extrapolate` allows temperatures outside the material's table.
    """
    results: list[dict[str, Any]] = [{} for _ in rows]
    groups: dict[Shape, list[LawTask]] = {}
    shaped = cache(_shaped)  # for these rows only: a load may be a file, which changes
    for place, row in enumerate(rows):
        try:
            load, shape = shaped(row["load"], float(row.get("width", math.nan)))
            case = law_case(row, extrapolate, row["load"] if load.temperatures else LOADS[0])
            law = final_law(case, load)
            groups.setdefault(shape, []).append(LawTask(place, case, law, load, case.fibre_fraction))
        except Exception as error:
            results[place] = failed(error)
    for tasks in groups.values():
        for task, result in zip(tasks, _solved(tasks), strict=True):
            results[task.place] = result
    return results


def _shaped(name: str, width: float) -> tuple[LoadProgramme, Shape]:
    """A load, and its times and pressures over the peak: all that the clock of the law needs of it; a cycle is one of its own."""
    load = find_load(name, width)
    if load.temperatures:
        return load, (load.times, load.pressures + load.temperatures)
    peak = load.peak or 1.0
    return load, (load.times, tuple(float(f"{value / peak:.{SHAPE_DIGITS}g}") for value in load.pressures))


def _solved(tasks: Sequence[LawTask]) -> list[dict[str, Any]]:
    """Results of cases of one load shape; one by one if they cannot be done together."""
    try:
        return _solve(tasks)
    except Exception as error:
        if len(tasks) == 1:
            return [failed(error)]
        return [result for task in tasks for result in _solved([task])]


def _solve(tasks: Sequence[LawTask]) -> list[dict[str, Any]]:
    load = tasks[0].load
    if load.temperatures:
        solution = solve([task.case for task in tasks], load)
        return _results(tasks, solution)
    laws = batch([_under_peak(task.law, task.load.peak, load.peak) for task in tasks])
    solution = integrate_batch(laws, load, None, np.array([task.fibre_fraction for task in tasks]))
    return _results(tasks, solution)


def _results(tasks: Sequence[LawTask], solution: LawHistory) -> list[dict[str, Any]]:
    ends = [solution.thickness_ratio[:, -1], solution.width_ratio[:, -1], solution.fibre_fraction[:, -1], solution.lock_time]
    return [_finished(task, *map(float, values)) for task, *values in zip(tasks, *ends, strict=True)]


def _under_peak(law: LawParameters, peak: float, reference: float) -> LawParameters:
    """The law that does under the peak `reference` what this one does under `peak`: stress is in proportion to exp(b)."""
    if peak == reference or peak <= 0.0 or reference <= 0.0:
        return law
    shift = math.log(reference / peak)
    return replace(law, b_squeeze=law.b_squeeze + shift, b_bleed=law.b_bleed + shift)


def _finished(task: LawTask, thickness: float, width: float, fraction: float, lock_time: float) -> dict[str, Any]:
    if not all(math.isfinite(value) for value in (thickness, width, fraction)):
        return failed(PlyflowError(f"the law gives no finite thickness and width ({thickness:g}, {width:g})"))
    return {
        "status": "done",
        "thickness_ratio": thickness,
        "thickness_mm": task.case.blocks * task.law.h0 * thickness,
        "thickness_ratio_limit": math.exp(task.law.eps_limit),
        "width_ratio": width,
        "width_mm": task.law.w0 * width,
        "fibre_fraction": fraction,
        "lock_time_s": None if math.isnan(lock_time) else lock_time,
        "eps_lock": task.law.eps_lock,
    }
