"""The stress in double beside the same generated source in quadruple precision, along whole programmes."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from plyflow.case.case import Case, driver_steps
from plyflow.evidence.stability.bench import Bench, Column
from plyflow.evidence.stability.cells import Check, Outcome, Task
from plyflow.evidence.stability.precision import WELL_CONDITIONED, Rounding, measure_rounding
from plyflow.evidence.stability.states import random_increment
from plyflow.run.case_run import case_controls

GROUP = "Double beside quadruple precision"
BOUND = 1e-12
SCENES = ("default", "augmented", "blend")
ALONG = {
    scene: Check(
        GROUP,
        f"increments of the ramp-dwell programme, {scene} scene: as exact as their input",
        "error of the stress / (condition x rounding) [-]",
        4.0,
    )
    for scene in SCENES
}
DRAWN = Check(
    GROUP,
    "random increments with Table 4, moderate penalty: where conditioned better than 1e3",
    "largest error of the stress, relative [-]",
    BOUND,
)
SAMPLES = 12


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    for scene in SCENES[:1] if bench.quick else SCENES:
        for column in bench.columns:
            yield Task(ALONG[scene], column.label, partial(along, bench, column, scene))
    for column in bench.columns:
        yield Task(DRAWN, column.label, partial(drawn, bench, column))


def along(bench: Bench, column: Column, scene: str) -> Outcome:
    """Increments spread over a programme, both stages, with the constants as shipped."""
    case = Case(column.material, column.temperature, "BP", 15.0)
    values = bench.values(column)
    history = bench.drive(values, driver_steps(case.load_programme), case_controls(), scene)
    if not history.completed:
        return ALONG[scene].refuse(history.message)
    gradients, found = history.deformation_gradient, []
    for row in np.linspace(1, history.increments, 4 if bench.quick else SAMPLES).astype(int):
        ends = (gradients[row - 1], gradients[row])
        dt = float(history.increment[row])
        found.append(measure_rounding(bench, ends, dt, values, history.statev[row - 1], scene))
    return _judge(ALONG[scene], found, max(one.share for one in found))


def drawn(bench: Bench, column: Column) -> Outcome:
    """Random increments of 1e-4 to 1e-1 of strain, both stages."""
    rng = bench.generator(int(1000 + bench.columns.index(column)))
    values, found = bench.values(column, kappa=1.0, E_L=1.0), []
    for number in range(6 if bench.quick else 30):
        one = random_increment(values, number % 2 == 1, rng)
        found.append(measure_rounding(bench, (one.start, one.end), one.dt, values, one.locked))
    good = [one.stress for one in found if one.condition < WELL_CONDITIONED]
    return _judge(DRAWN, found, max(good, default=float("nan")))


def _judge(check: Check, found: list[Rounding], measured: float) -> Outcome:
    good = [one.stress for one in found if one.condition < WELL_CONDITIONED]
    details = {
        "calls": len(found),
        "conditioned_below_1e3": len(good),
        "error_below_1e3": max(good, default=0.0),
        "error_above_1e3": max((one.stress for one in found if one.condition >= WELL_CONDITIONED), default=0.0),
        "condition_least": min(one.condition for one in found),
        "condition_largest": max(one.condition for one in found),
        "error_of_tangent": max(one.tangent for one in found),
    }
    if details["error_below_1e3"] > BOUND:
        return check.fail("error above 1e-12 where the condition is below 1e3", measured, **details)
    return check.judge(measured, **details)
