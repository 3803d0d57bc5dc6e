"""Unloading, reloading and cyclic load: the lock stays, the dissipation never falls."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from plyflow.case.case import PLY_KINDS, Case
from plyflow.driver.drive import Controls, History, Step
from plyflow.evidence.stability.bench import LOCKED, Bench, Column
from plyflow.evidence.stability.cells import Check, Outcome, Task
from plyflow.evidence.stability.lock import plate_positions
from plyflow.evidence.stability.programmes import failed_increments

GROUP = "Unloading, reloading, cycles"
MEASURES = "largest thickness regained while no load pulls, relative [-]"
UNLOADED = Check(GROUP, "unloaded in 1 s, left for 100 s, loaded again: stays where it was", MEASURES, 1e-4)
CYCLED = Check(GROUP, "ten cycles between full load and none", MEASURES, 1e-4)
DROPPED = Check(GROUP, "load taken off and put on again in one instant, five times", MEASURES, 1e-4)
MOVED = Check(
    GROUP,
    "plate moved up and down by 2 %, ten times, after the lock: opposes both ways",
    "worst number of iterations",
    12,
)
CONTROLS = Controls(initial_increment=1e-2, minimum_increment=1e-60, maximum_increment=5.0)


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    for column in bench.columns:
        for check, fill in ((UNLOADED, unloaded), (CYCLED, cycled), (DROPPED, dropped), (MOVED, moved)):
            yield Task(check, column.label, partial(fill, bench, column))


def _plate(load: float, duration: float, instant: bool = False) -> Step:
    targets = {"11": 1.0, "22": 0.0, "33": load, "12": 0.0, "13": 0.0, "23": 0.0}
    return Step(duration, targets, PLY_KINDS, instant)


def _peak(column: Column) -> float:
    return Case(column.material, column.temperature, "BP", 15.0).load_programme.peak


def unloaded(bench: Bench, column: Column) -> Outcome:
    """One unloading with a rest, between two loadings."""
    load = _peak(column)
    steps = [_plate(load, 1.0), _plate(load, 100.0), _plate(0.0, 1.0), _plate(0.0, 100.0), _plate(load, 1.0)]
    return _judge(bench, column, UNLOADED, [*steps, _plate(load, 100.0)])


def cycled(bench: Bench, column: Column) -> Outcome:
    """A sawtooth of load."""
    return _judge(bench, column, CYCLED, sawtooth(_peak(column)))


def sawtooth(load: float) -> list[Step]:
    """Ten cycles from nothing to a pressure [MPa] and back, 10 s each way."""
    return [_plate(share * load, 10.0) for _ in range(10) for share in (1.0, 0.0)]


def dropped(bench: Bench, column: Column) -> Outcome:
    """A ramp to full load, then the load off and on in single instants."""
    load = _peak(column)
    steps = [_plate(load, 10.0), *(_plate(share * load, 10.0, True) for _ in range(5) for share in (0.0, 1.0))]
    return _judge(bench, column, DROPPED, steps)


def _judge(bench: Bench, column: Column, check: Check, steps: list[Step]) -> Outcome:
    history = bench.drive(bench.values(column), steps, CONTROLS)
    if not history.completed:
        return check.refuse(history.message)
    locked = history.statev[:, LOCKED]
    if np.diff(locked).min() < 0.0:
        return check.fail("the lock was left again")
    regained = np.diff(history.deformation_gradient[:, 2, 2]).clip(min=0.0).sum()
    return check.judge(float(regained), **_numbers(history))


def _numbers(history: History) -> dict[str, float]:
    return {
        "increments": history.increments,
        "iterations_worst": int(history.iterations[1:].max()),
        "failed_increments": failed_increments(history),
    }


def moved(bench: Bench, column: Column) -> Outcome:
    """A plate glued to the ply: it pulls on the way up and pushes on the way down."""
    values = bench.values(column)
    below = float(np.exp(values["eps_lock"])) * 0.97
    positions = [below, *(share * below for _ in range(10) for share in (1.02, 1.0))]
    history = bench.drive(values, plate_positions(positions), CONTROLS)
    if not history.completed:
        return MOVED.refuse(history.message)
    speed = np.diff(history.deformation_gradient[:, 2, 2])
    axial = history.stress[1:, 2]
    clear = np.abs(speed) > 1e-6
    if np.any(axial[clear] * speed[clear] <= 0.0):
        return MOVED.fail("the axial stress helps the plate")
    return MOVED.judge(int(history.iterations[1:].max()), failed_increments=failed_increments(history))
