"""The compaction limit: approached to 1e-9, overstepped, and reached under load."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from plyflow.case.case import PLY_KINDS
from plyflow.driver.drive import Controls, Step
from plyflow.evidence.stability.bench import Bench, Column
from plyflow.evidence.stability.cells import Check, Outcome, Task
from plyflow.evidence.stability.precision import WELL_CONDITIONED, measure_rounding
from plyflow.evidence.stability.states import STAGES, compacted, held_width, limit_stretch
from plyflow.evidence.stability.tensors import Array

GROUP = "Compaction limit"
GAPS = (1e-3, 1e-6, 1e-9)
APPROACHED = {
    gap: Check(
        GROUP,
        f"limit approached to {gap:g}: finite, right sign, as exact as its input",
        "error against quadruple precision / (condition x rounding) [-]",
        4.0,
    )
    for gap in GAPS
}
OVERSTEPPED = Check(
    GROUP,
    "limit reached or overstepped in one increment: PNEWDT and a message",
    "stresses returned",
    0.0,
    may_refuse=True,
)
BEYOND = Check(
    GROUP, "start beyond the limit: the analysis ends with a message", "stresses returned", 0.0, may_refuse=True
)
PRESSED = Check(
    GROUP, "1000 MPa on the plate for 10 s: stops short of the limit", "gap to the limit left [-]", 0.0, True
)
DRIVEN = Check(
    GROUP, "plate driven through the limit: refused there", "gap to the limit at the end [-]", 0.0, True, True
)
OVERSTEPS = (0.0, 1e-9, 1e-3, 0.1)


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    for column in bench.columns:
        for gap, check in APPROACHED.items():
            yield Task(check, column.label, partial(approached, bench, column, gap))
        for check, fill in ((OVERSTEPPED, overstepped), (BEYOND, beyond), (PRESSED, pressed), (DRIVEN, driven)):
            yield Task(check, column.label, partial(fill, bench, column))


def _ends(bench: Bench, column: Column, locked: bool, gap: float) -> tuple[Array, Array]:
    """From above the lock (squeeze) or from below it (bleed) to a relative distance from the limit."""
    values = bench.values(column)
    eps = float(np.log(limit_stretch(values)) + np.log1p(gap))
    if locked:
        return held_width(values["eps_lock"] - 1e-2, values), held_width(eps, values)
    return compacted(values["eps_lock"] + 1e-2), compacted(eps)


def approached(bench: Bench, column: Column, gap: float) -> Outcome:
    """Stress next to the limit in both stages: sign, and rounding against its condition."""
    values, check = bench.values(column, kappa=1.0), APPROACHED[gap]
    roundings = []
    for name, locked in STAGES.items():
        ends = _ends(bench, column, locked, gap)
        stress = bench.call(*ends, 1.0, values, locked).stress
        if not stress[2] - stress[1] < 0.0:
            return check.fail(f"axial stress {stress[2] - stress[1]:.3g} MPa in {name} does not resist")
        roundings.append(measure_rounding(bench, ends, 1.0, values, locked))
    worst = max(roundings, key=lambda rounding: rounding.share)
    if any(one.condition < WELL_CONDITIONED and one.stress > 1e-12 for one in roundings):
        return check.fail("error above 1e-12 where the condition is below 1e3", worst.share)
    return check.judge(worst.share, error=worst.stress, condition=worst.condition)


def overstepped(bench: Bench, column: Column) -> Outcome:
    """Ends at or beyond the limit ask for a smaller increment."""
    return _all_refused(bench, column, OVERSTEPPED, stopped=False)


def beyond(bench: Bench, column: Column) -> Outcome:
    """Starts at or beyond the limit end the analysis."""
    return _all_refused(bench, column, BEYOND, stopped=True)


def _all_refused(bench: Bench, column: Column, check: Check, stopped: bool) -> Outcome:
    values, message = bench.values(column), ""
    for name, locked in STAGES.items():
        for overstep in OVERSTEPS:
            start, end = _ends(bench, column, locked, -overstep)
            if overstep == 0.0:
                end[2, 2] = limit_stretch(values) * (1.0 - 4e-16)
            answer = bench.call(end if stopped else start, end, 1.0, values, locked)
            wanted = answer.stopped if stopped else answer.pnewdt <= 0.25 and not answer.stopped
            if not (wanted and "limit" in answer.messages):
                return check.fail(f"{name}, {overstep:g} beyond: stress returned, message {answer.messages!r}", 1.0)
            message = answer.messages
    return check.refuse(message, 0.0)


def pressed(bench: Bench, column: Column) -> Outcome:
    """A pressure thousands of times the programme's; the ply must stop short of the limit."""
    values = bench.values(column)
    targets = {"11": 1.0, "22": 0.0, "33": 1e3, "12": 0.0, "13": 0.0, "23": 0.0}
    step = Step(10.0, targets, PLY_KINDS)
    history = bench.drive(values, [step], Controls(minimum_increment=1e-30, max_increments=5000))
    gap = float(history.deformation_gradient[-1, 2, 2] / limit_stretch(values) - 1.0)
    if not history.completed:
        return PRESSED.refuse(history.message, gap)
    return PRESSED.judge(gap, iterations_worst=int(history.iterations[1:].max()))


def driven(bench: Bench, column: Column) -> Outcome:
    """A plate that moves through the limit at constant speed."""
    values = bench.values(column)
    targets = {"11": 1.0, "22": 0.0, "33": 0.9 * limit_stretch(values), "12": 0.0, "13": 0.0, "23": 0.0}
    history = bench.drive(values, [Step(10.0, targets, {**PLY_KINDS, "33": "F"})], Controls(minimum_increment=1e-9))
    gap = float(history.deformation_gradient[-1, 2, 2] / limit_stretch(values) - 1.0)
    if history.completed:
        return DRIVEN.fail("went through the limit", gap)
    return DRIVEN.refuse(history.message, gap)
