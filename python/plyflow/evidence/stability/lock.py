"""The lock as an event: landed on from any side by any step, never left again."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import pairwise

import numpy as np

from plyflow.case.case import PLY_KINDS
from plyflow.driver.drive import Controls, Step
from plyflow.evidence.stability.bench import LOCKED, Bench, Column
from plyflow.evidence.stability.cells import Check, Outcome, Task
from plyflow.evidence.stability.states import compacted, limit_stretch

GROUP = "The lock as an event"
LANDING_TOLERANCE = 1e-5
ATTEMPTS = 200
GROWTH = 1.5
KINDS = ("in the middle of an increment", "at the end of an increment", "by a tiny step", "by a huge step")
CROSSED = {
    kind: Check(
        GROUP,
        f"lock crossed {kind}: landed on",
        "distance of the compaction from eps_lock where it locks [-]",
        LANDING_TOLERANCE * (1.0 + 1e-6),
    )
    for kind in KINDS
}
CREPT = Check(
    GROUP,
    "lock crossed in steps of 1e-7: locks once, asks for nothing",
    "distance of the compaction from eps_lock where it locks [-]",
    LANDING_TOLERANCE * (1.0 + 1e-6),
)
BACK_AND_FORTH = {
    scene: Check(
        GROUP,
        f"back and forth over the lock, {scene} scene: stays locked",
        "final width beside exp(-eps_lock), relative [-]",
        1e-3,
    )
    for scene in ("default", "blend")
}


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    for column in bench.columns:
        for kind, check in CROSSED.items():
            yield Task(check, column.label, partial(crossed, bench, column, kind))
        yield Task(CREPT, column.label, partial(crept, bench, column))
        for scene, check in BACK_AND_FORTH.items():
            yield Task(check, column.label, partial(back_and_forth, bench, column, scene))


def crossed(bench: Bench, column: Column, kind: str) -> Outcome:
    """Follow PNEWDT along a straight path of F over the lock to the state that has locked; increments grow again."""
    values, check = bench.values(column), CROSSED[kind]
    lock, limit = values["eps_lock"], np.log(limit_stretch(values))
    begin, end = {
        KINDS[0]: (lock + 0.01, lock - 0.01),
        KINDS[1]: (lock + 0.01, lock),
        KINDS[2]: (lock + 2e-5, lock - 2e-5),
        KINDS[3]: (0.0, 0.5 * (lock + limit)),
    }[kind]
    start, target = compacted(begin), compacted(end)
    statev, done, share, attempts = np.zeros(8), 0.0, 1.0, 0
    while attempts < ATTEMPTS:
        ends = [start + time * (target - start) for time in (done, done + share)]
        answer = bench.call(ends[0], ends[1], share, values, statev)
        attempts += 1
        if answer.pnewdt < 1.0:
            share *= answer.pnewdt
            continue
        if answer.statev[LOCKED] == 1.0:
            return check.judge(abs(float(answer.statev[0]) - lock), attempts=attempts)
        statev, done = answer.statev, done + share
        share = min(GROWTH * share, 1.0 - done)
    return check.fail(f"not locked after {ATTEMPTS} attempts", abs(float(statev[0]) - lock))


def crept(bench: Bench, column: Column) -> Outcome:
    """Creep over the lock from 1.5e-5 before it in steps far below the tolerance."""
    values = bench.values(column)
    lock = values["eps_lock"]
    strains = lock + 1.5e-5 - 1e-7 * np.arange(301)
    statev, locked_at, falls = np.zeros(8), [], 0
    for begin, end in pairwise(strains):
        answer = bench.call(compacted(float(begin)), compacted(float(end)), 1.0, values, statev)
        if answer.pnewdt < 1.0:
            return CREPT.fail(f"asked for {answer.pnewdt:.3g} of a step of 1e-7 at {end - lock:.3g} from the lock")
        falls += int(answer.statev[LOCKED] < statev[LOCKED])
        if answer.statev[LOCKED] > statev[LOCKED]:
            locked_at.append(abs(float(end) - lock))
        statev = answer.statev
    if len(locked_at) != 1 or falls:
        return CREPT.fail(f"locked {len(locked_at)} times, unlocked {falls} times")
    return CREPT.judge(locked_at[0])


def back_and_forth(bench: Bench, column: Column, scene: str) -> Outcome:
    """A plate driven over the lock, back above it, and over it again, three times, with a free edge."""
    values, check = bench.values(column), BACK_AND_FORTH[scene]
    beyond = 0.5 * (np.exp(values["eps_lock"]) + limit_stretch(values))
    before = np.exp(0.5 * values["eps_lock"])
    history = bench.drive(
        values, plate_positions([beyond, before] * 3), Controls(initial_increment=0.05, minimum_increment=1e-12), scene
    )
    if not history.completed:
        return check.fail(f"stopped at {history.time[-1]:g} s: {history.message}")
    locked = history.statev[:, LOCKED]
    if np.diff(locked).min() < 0.0 or locked[-1] != 1.0:
        return check.fail("the lock was left again")
    width = history.deformation_gradient[locked >= 1.0, 1, 1]
    return check.judge(
        float(abs(width[-1] * np.exp(values["eps_lock"]) - 1.0)),
        drift_after_the_lock=float(np.ptp(width)),
        increments=history.increments,
        iterations_worst=int(history.iterations[1:].max()),
    )


def plate_positions(positions: Sequence[float], duration: float = 10.0) -> list[Step]:
    """Steps that drive the plate (F33) from one position to the next, fibre held, edge free."""
    kinds = {**PLY_KINDS, "33": "F"}
    return [
        Step(duration, {"11": 1.0, "22": 0.0, "33": float(position), "12": 0.0, "13": 0.0, "23": 0.0}, kinds)
        for position in positions
    ]
