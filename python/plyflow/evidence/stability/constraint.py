"""Incompressibility before the lock: penalties over twelve decades, and three devices compared."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from plyflow.case.case import law_parameters
from plyflow.driver.drive import Controls
from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.subject import LOCKED, Column, Run, Subject, Values, plate
from plyflow.evidence.stability.tensors import EPSILON
from plyflow.law import compaction_stress
from plyflow.run.case_run import case_controls

MODERATE = 1e4
DWELL = 1000.0
CONTROLS = replace(case_controls(), initial_increment=1e-4)
"""Those of the demo, with increments before the lock at 30 degC too, where it is passed within 0.02 s."""
DEVICES: dict[str, tuple[str, dict[str, Any]]] = {
    "penalty": ("default", {}),
    "augmented": ("augmented", {}),
    "multiplier": ("default", {"incompressible": True, "constraint_release_statev": LOCKED + 1}),
}


def penalty(check: Check, subject: Subject, column: Column, decade: int) -> Outcome:
    """Ramp-dwell of the thickest block with a penalty that many decades above the load."""
    values = subject.values(column, kappa=column.peak * 10.0**decade)
    run = subject.drive_case(column.case(), values, controls=CONTROLS).ended()
    squeezing = np.flatnonzero(run.locked[1:] < 1.0) + 1
    change = np.abs(np.linalg.det(run.history.deformation_gradient[squeezing]) - 1.0) - 4.0 * EPSILON
    load = -run.history.stress[squeezing, 2]
    return check.judge(
        float((change * values["kappa"] / load).max()),
        volume_change=run.volume_change,
        width_error=run.width_error,
        iterations_worst=run.worst,
        failed_increments=run.failed,
    )


def one_device(check: Check, subject: Subject, column: Column, device: str, held: str) -> Outcome:
    """The whole programme (thickness beside the exact multiplier's), or a load that stays short of the lock."""
    if held == "quiet":
        return _quiet(check, subject, column, device)
    worst, numbers = _together(subject, [column], device)
    return check.judge(worst, **numbers)


def _quiet(check: Check, subject: Subject, column: Column, device: str) -> Outcome:
    """A dwell of 1000 increments."""
    scene, extra = DEVICES[device]
    values = subject.values(column)
    load = _quiet_load(values)
    values["kappa"] = MODERATE * load
    controls = Controls(initial_increment=1e-2, maximum_increment=1.0, minimum_increment=1e-12, **extra)
    run = subject.drive(values, [plate(load, 1.0), plate(load, DWELL)], controls, scene)
    history = run.history
    if not history.completed or run.locked[-1] != 0.0:
        return check.fail(f"did not end short of the lock: {history.message}")
    return check.judge(
        abs(float(np.linalg.det(history.deformation_gradient[-1])) - 1.0),
        largest_on_the_way=run.volume_change,
        increments=history.increments,
        iterations=history.total_iterations,
    )


def _quiet_load(values: Values) -> float:
    """Pressure [MPa] that by the one-dimensional law still creeps slowly at half of the lock strain."""
    half = 0.5 * values["eps_lock"]
    return float(-compaction_stress(half, 0.1 * values["eps_lock"] / DWELL, law_parameters(values)))


def ramp_dwell(subject: Subject, column: Column, device: str) -> Run:
    """Ramp-dwell of the thickest block with one of the devices."""
    scene, extra = DEVICES[device]
    values = subject.values(column, kappa=MODERATE * column.peak)
    return subject.drive_case(column.case(), values, scene, replace(CONTROLS, **extra))


def _together(subject: Subject, columns: list[Column], device: str) -> tuple[float, dict[str, float]]:
    """Worst width and worst numbers and sums of one device over some columns."""
    runs = [subject.once(ramp_dwell, column, device).ended() for column in columns]
    exact = [subject.once(ramp_dwell, column, "multiplier") for column in columns]
    return max(run.width_error for run in runs), {
        "volume_change": max(run.volume_change for run in runs),
        "thickness_beside_multiplier": max(
            abs(run.thickness - other.thickness) for run, other in zip(runs, exact, strict=True)
        ),
        "increments": sum(run.history.increments for run in runs),
        "iterations": sum(run.history.total_iterations for run in runs),
        "failed_increments": sum(run.failed for run in runs),
    }


def compared(check: Check, subject: Subject, device: str) -> Outcome:
    """Sums and worst numbers of one device over all columns."""
    worst, numbers = _together(subject, subject.columns, device)
    seconds = sum(subject.once(ramp_dwell, column, device).history.run_time_s for column in subject.columns)
    return check.judge(worst, **numbers, run_time_s=seconds)
