"""Unloading, reloading and cyclic load: the lock stays, the dissipation never falls."""

from __future__ import annotations

import numpy as np

from plyflow.driver.drive import Controls, Step
from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.subject import Column, Subject, plate

CONTROLS = Controls(initial_increment=1e-2, minimum_increment=1e-60, maximum_increment=5.0)
LOADS: dict[str, list[tuple[float, float, bool]]] = {
    "rest": [(share, duration, False) for share in (1.0, 0.0, 1.0) for duration in (1.0, 100.0)],
    "cycles": [(share, 10.0, False) for share in (1.0, 0.0) * 10],
    "instants": [(1.0, 10.0, False), *((share, 10.0, True) for share in (0.0, 1.0) * 5)],
}
"""Share of the full load, duration [s], whether in an instant."""


def cycle_steps(load: str, peak: float) -> list[Step]:
    """Steps of one of the loads for a full load [MPa]."""
    return [plate(share * peak, duration, instant=instant) for share, duration, instant in LOADS[load]]


def reloaded(check: Check, subject: Subject, column: Column, load: str) -> Outcome:
    """Load on and off."""
    run = subject.drive(subject.values(column), cycle_steps(load, column.peak), CONTROLS).ended()
    if np.diff(run.locked).min() < 0.0:
        return check.fail("the lock was left again")
    regained = np.diff(run.history.deformation_gradient[:, 2, 2]).clip(min=0.0).sum()
    return check.judge(
        float(regained),
        increments=run.history.increments,
        iterations_worst=run.worst,
        failed_increments=run.failed,
    )


def moved(check: Check, subject: Subject, column: Column) -> Outcome:
    """A plate glued to the ply: it pulls on the way up and pushes on the way down."""
    values = subject.values(column)
    below = float(np.exp(values["eps_lock"])) * 0.97
    steps = [plate(share * below, 10.0, driven=True) for share in (1.0, *((1.02, 1.0) * 10))]
    run = subject.drive(values, steps, CONTROLS).ended()
    speed = np.diff(run.history.deformation_gradient[:, 2, 2])
    axial = run.history.stress[1:, 2]
    clear = np.abs(speed) > 1e-6
    if np.any(axial[clear] * speed[clear] <= 0.0):
        return check.fail("the axial stress helps the plate")
    return check.judge(run.worst, failed_increments=run.failed)
