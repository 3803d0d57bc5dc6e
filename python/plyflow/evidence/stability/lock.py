"""The lock: passed by any increment at the same width, never left again, neither on unloading nor in cycles."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from plyflow.driver.drive import Controls, Step
from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.states import compacted
from plyflow.evidence.stability.subject import LOCKED, Column, Subject, plate
from plyflow.evidence.stability.tensors import limit_stretch

CONTROLS = Controls(initial_increment=1e-2, minimum_increment=1e-60, maximum_increment=5.0)
LOADS: dict[str, list[tuple[float, float, bool]]] = {
    "rest": [(share, duration, False) for share in (1.0, 0.0, 1.0) for duration in (1.0, 100.0)],
    "cycles": [(share, 10.0, False) for share in (1.0, 0.0) * 10],
    "instants": [(1.0, 10.0, False), *((share, 10.0, True) for share in (0.0, 1.0) * 5)],
}
"""Share of the full load, duration [s], whether in an instant."""


def crossed(check: Check, subject: Subject, column: Column, how: str, increment: float, scene: str) -> Outcome:
    """A ply with a free edge taken over the lock in 1 s, by a plate that moves or under a load that rises, in equal increments.

    Nothing is extrapolated, so that PNEWDT can only come from the increment itself.
    """
    values = subject.values(column)
    beyond = float(np.exp(0.5 * (values["eps_lock"] + np.log(limit_stretch(values)))))
    step = plate(beyond, 1.0, driven=True) if how == "by the plate" else plate(column.peak, 1.0)
    controls = Controls(increment, 1e-12, increment, growth=1.0, extrapolation="none")
    run = subject.drive(values, [step], controls, scene).ended()
    history = run.history
    if asked := history.cutbacks_by_reason.get("pnewdt", 0):
        return check.fail(f"asked for smaller increments through PNEWDT {asked} times")
    if np.diff(run.locked).min() < 0.0:
        return check.fail("the lock was left again")
    return check.judge(run.width_error, increments=history.increments, failed_increments=run.failed)


def crept(check: Check, subject: Subject, column: Column, scene: str) -> Outcome:
    """Creep over the lock from 1.5e-5 before it in steps of 1e-7."""
    values = subject.values(column)
    lock = values["eps_lock"]
    strains = lock + 1.505e-5 - 1e-7 * np.arange(302)  # the lock is half-way through a step
    statev, locked_at, falls = subject.statev(scene=scene), [], 0
    for begin, end in pairwise(strains):
        answer = subject.call(compacted(float(begin)), compacted(float(end)), 1.0, values, statev, scene)
        if answer.pnewdt < 1.0:
            return check.fail(f"asked for {answer.pnewdt:.3g} of a step of 1e-7 at {end - lock:.3g} from the lock")
        falls += int(answer.statev[LOCKED] < statev[LOCKED])
        if answer.statev[LOCKED] > statev[LOCKED]:
            locked_at.append(lock - float(end))
        statev = answer.statev
    if len(locked_at) != 1 or falls:
        return check.fail(f"locked {len(locked_at)} times, unlocked {falls} times")
    return check.judge(abs(locked_at[0]))


def back_and_forth(check: Check, subject: Subject, column: Column, scene: str) -> Outcome:
    """A plate driven over the lock, back above it, and over it again, three times, with a free edge."""
    values = subject.values(column)
    beyond = 0.5 * (np.exp(values["eps_lock"]) + limit_stretch(values))
    before = np.exp(0.5 * values["eps_lock"])
    steps = [plate(float(position), 10.0, driven=True) for position in (beyond, before) * 3]
    run = subject.drive(values, steps, Controls(initial_increment=0.05, minimum_increment=1e-12), scene)
    history = run.history
    if not history.completed:
        return check.fail(f"stopped at {history.time[-1]:g} s: {history.message}")
    if np.diff(run.locked).min() < 0.0 or run.locked[-1] != 1.0:
        return check.fail("the lock was left again")
    width = history.deformation_gradient[run.locked >= 1.0, 1, 1]
    return check.judge(
        run.width_error,
        drift_after_the_lock=float(np.ptp(width)),
        increments=history.increments,
        iterations_worst=run.worst,
    )


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
