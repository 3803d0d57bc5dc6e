"""Incompressibility before the lock: penalties over twelve decades, and three devices compared."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np

from plyflow.case.case import PLY_KINDS, Case, driver_steps, law_parameters
from plyflow.driver.drive import Controls, History, Step
from plyflow.evidence.stability.bench import LOCKED, Bench, Column, Values
from plyflow.evidence.stability.cells import WHOLE, Check, Outcome, Task
from plyflow.evidence.stability.programmes import failed_increments, width_error
from plyflow.law import compaction_stress
from plyflow.run.case_run import case_controls

GROUP = "Incompressibility before the lock"
DECADES = tuple(range(13))
PENALTIES = {
    decade: Check(
        GROUP,
        f"kappa = 1e{decade} times the load: every programme ends, J - 1 as the penalty wants it",
        "largest |J - 1| kappa / load before the lock [-]",
        1.5,
    )
    for decade in DECADES
}
MODERATE = 1e4
DWELL = 1000.0
DEVICES: dict[str, tuple[str, dict[str, Any]]] = {
    "penalty": ("default", {}),
    "augmented": ("augmented", {}),
    "multiplier": ("default", {"incompressible": True, "constraint_release_statev": LOCKED + 1}),
}
BOUNDS = {"penalty": 1.5 / MODERATE, "augmented": 1e-8, "multiplier": 1e-12}
QUIET = {
    device: Check(
        GROUP,
        f"1000 s under load short of the lock, kappa 1e4 times the load, {device}",
        "|J - 1| at the end [-]",
        BOUNDS[device],
    )
    for device in DEVICES
}
WHOLE_PROGRAMME = {
    device: Check(
        GROUP,
        f"ramp-dwell programme, kappa 1e4 times the load, {device}",
        "final width beside exp(-eps_lock), relative [-]",
        1e-3,
    )
    for device in DEVICES
}

COMPARED = {
    device: Check(
        GROUP,
        f"all columns of the programme together, {device}",
        "worst final width beside exp(-eps_lock), relative [-]",
        1e-3,
    )
    for device in DEVICES
}


Run = tuple[Values, History]
Runner = Callable[[Column, str], Run]


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    run = cache(partial(ramp_dwell, bench))
    for column in bench.columns:
        for decade in bench.few(DECADES, 5):
            yield Task(
                PENALTIES[decade],
                column.label,
                partial(penalty, bench, column, decade),
            )
        for device in DEVICES:
            yield Task(QUIET[device], column.label, partial(quiet, bench, column, device))
            yield Task(
                WHOLE_PROGRAMME[device],
                column.label,
                partial(whole_programme, WHOLE_PROGRAMME[device], run, column, device),
            )
    for device, check in COMPARED.items():
        yield Task(
            check,
            WHOLE,
            partial(compared, check, run, bench.columns, device),
        )


def penalty(bench: Bench, column: Column, decade: int) -> Outcome:
    """Ramp-dwell of the thickest block with a penalty that many decades above the load."""
    check, case = PENALTIES[decade], Case(column.material, column.temperature, "BP", 15.0)
    load = case.load_programme.peak
    values = bench.values(column, kappa=load * 10.0**decade)
    history = bench.drive(values, driver_steps(case.load_programme), case_controls())
    if not history.completed:
        return check.refuse(history.message)
    return check.judge(
        _volume_change(history) * 10.0**decade,
        volume_change=_volume_change(history),
        width_error=width_error(history, values),
        iterations_worst=int(history.iterations[1:].max()),
        failed_increments=failed_increments(history),
    )


def quiet(bench: Bench, column: Column, device: str) -> Outcome:
    """A dwell of 1000 increments under a pressure that stays short of the lock."""
    check, (scene, extra) = QUIET[device], DEVICES[device]
    values = bench.values(column)
    load = _quiet_load(values)
    values["kappa"] = MODERATE * load
    targets = {"11": 1.0, "22": 0.0, "33": load, "12": 0.0, "13": 0.0, "23": 0.0}
    steps = [Step(1.0, targets, PLY_KINDS), Step(DWELL, targets, PLY_KINDS)]
    controls = Controls(initial_increment=1e-2, maximum_increment=1.0, minimum_increment=1e-12, **extra)
    history = bench.drive(values, steps, controls, scene)
    if not history.completed or history.statev[-1, LOCKED] != 0.0:
        return check.fail(f"did not end short of the lock: {history.message}")
    return check.judge(
        abs(float(np.linalg.det(history.deformation_gradient[-1])) - 1.0),
        largest_on_the_way=_volume_change(history),
        increments=history.increments,
        iterations=history.total_iterations,
    )


def ramp_dwell(bench: Bench, column: Column, device: str) -> Run:
    """Ramp-dwell of the thickest block with one of the devices."""
    case = Case(column.material, column.temperature, "BP", 15.0)
    values = bench.values(column, kappa=MODERATE * case.load_programme.peak)
    scene, extra = DEVICES[device]
    controls = replace(case_controls(), **extra)
    return values, bench.drive(values, driver_steps(case.load_programme), controls, scene)


def whole_programme(check: Check, run: Runner, column: Column, device: str) -> Outcome:
    """Width after the lock; thickness beside the exact multiplier's."""
    values, history = run(column, device)
    if not history.completed:
        return check.refuse(history.message)
    return check.judge(
        width_error(history, values),
        volume_change=_volume_change(history),
        thickness_beside_multiplier=_thickness_apart(history, run(column, "multiplier")[1]),
        increments=history.increments,
        iterations=history.total_iterations,
        failed_increments=failed_increments(history),
    )


def compared(check: Check, run: Runner, columns: Sequence[Column], device: str) -> Outcome:
    """Sums and worst numbers of one device over all columns."""
    runs = [run(column, device) for column in columns]
    exact = [run(column, "multiplier")[1] for column in columns]
    histories = [history for _, history in runs]
    for history in histories:
        if not history.completed:
            return check.refuse(history.message)
    return check.judge(
        max(width_error(history, values) for values, history in runs),
        volume_change=max(_volume_change(history) for history in histories),
        thickness_beside_multiplier=max(map(_thickness_apart, histories, exact)),
        increments=sum(history.increments for history in histories),
        iterations=sum(history.total_iterations for history in histories),
        failed_increments=sum(failed_increments(history) for history in histories),
        run_time_s=sum(history.run_time_s for history in histories),
    )


def _thickness_apart(history: History, other: History) -> float:
    """Difference of two final thicknesses, of the initial thickness [-]."""
    return float(abs(history.deformation_gradient[-1, 2, 2] - other.deformation_gradient[-1, 2, 2]))


def _quiet_load(values: Values) -> float:
    """Pressure [MPa] that by the one-dimensional law still creeps slowly at half of the lock strain."""
    half = 0.5 * values["eps_lock"]
    law = law_parameters(values)
    return float(-compaction_stress(half, 0.1 * values["eps_lock"] / DWELL, law))


def _volume_change(history: History) -> float:
    """Largest |J - 1| up to the lock [-]."""
    squeezing = history.statev[:, LOCKED] < 1.0
    return float(np.abs(np.linalg.det(history.deformation_gradient[squeezing]) - 1.0).max())
