"""The stress in double beside the same generated source in quadruple precision, along whole programmes."""

from __future__ import annotations

import numpy as np

from plyflow.evidence.stability.cells import Check, Family, Outcome
from plyflow.evidence.stability.claims import AS_EXACT, AS_THE_INPUT
from plyflow.evidence.stability.precision import ALLOWED, INEXACT, Rounding, measure_rounding
from plyflow.evidence.stability.states import random_increment
from plyflow.evidence.stability.subject import Column, Subject

FAMILY = Family("Double beside quadruple precision", place=16)
SAMPLES = 12


@FAMILY.cells(
    "increments of the ramp-dwell programme, {scene} scene: as exact as their input",
    "error of the stress / (condition x rounding) [-]",
    4.0,
    claim=AS_THE_INPUT,
    quick=lambda scene: scene == "default",
    scene=("default", "augmented", "blend"),
)
def along(check: Check, subject: Subject, column: Column, scene: str) -> Outcome:
    """Increments spread over a programme, both stages, with the constants as shipped."""
    run = subject.drive_case(column.case(), subject.values(column), scene).ended()
    history, found = run.history, []
    for row in np.linspace(1, history.increments, 4 if subject.quick else SAMPLES).astype(int):
        start, end = history.deformation_gradient[row - 1 : row + 1]
        dt, statev = float(history.increment[row]), history.statev[row - 1]
        found.append(measure_rounding(subject, start, end, dt, run.values, statev, scene))
    return _judge(check, found, max(one.share for one in found))


@FAMILY.cells(
    "random increments with Table 4, moderate penalty: where conditioned better than 1e3",
    "largest error of the stress, relative [-]",
    ALLOWED,
    claim=AS_EXACT,
)
def drawn(check: Check, subject: Subject, column: Column) -> Outcome:
    """Random increments of 1e-4 to 1e-1 of strain, both stages."""
    rng = subject.generator(int(1000 + subject.columns.index(column)))
    values, found = subject.values(column, kappa=1.0, E_L=1.0), []
    for number in range(6 if subject.quick else 30):
        found.append(measure_rounding(subject, *random_increment(values, number % 2 == 1, rng)))
    return _judge(check, found, max((one.stress for one in found if one.well_conditioned), default=float("nan")))


def _judge(check: Check, found: list[Rounding], measured: float) -> Outcome:
    good = [one.stress for one in found if one.well_conditioned]
    details = {
        "calls": len(found),
        "conditioned_below_1e3": len(good),
        "error_below_1e3": max(good, default=0.0),
        "error_above_1e3": max((one.stress for one in found if not one.well_conditioned), default=0.0),
        "condition_least": min(one.condition for one in found),
        "condition_largest": max(one.condition for one in found),
        "error_of_tangent": max(one.tangent for one in found),
    }
    if any(one.inexact for one in found):
        return check.fail(INEXACT, measured, **details)
    return check.judge(measured, **details)
