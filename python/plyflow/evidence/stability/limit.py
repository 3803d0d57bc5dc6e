"""The compaction limit: approached to 1e-9, overstepped, and reached under load."""

from __future__ import annotations

import numpy as np

from plyflow.driver.drive import Controls
from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.rounding import INEXACT, measure_rounding
from plyflow.evidence.stability.states import STAGES, compacted, held_width
from plyflow.evidence.stability.subject import Column, Subject, Values, plate
from plyflow.evidence.stability.tensors import Array, limit_stretch

OVERSTEPS = (0.0, 1e-9, 1e-3, 0.1)


def _ends(values: Values, locked: bool, gap: float) -> tuple[Array, Array]:
    """From above the lock (squeeze) or from below it (bleed) to a relative distance from the limit."""
    eps = float(np.log(limit_stretch(values)) + np.log1p(gap))
    if locked:
        return held_width(values["eps_lock"] - 1e-2, values), held_width(eps, values)
    return compacted(values["eps_lock"] + 1e-2), compacted(eps)


def approached(check: Check, subject: Subject, column: Column, gap: float) -> Outcome:
    """Stress next to the limit in both stages: sign, and rounding against its condition."""
    values, roundings = subject.values(column, kappa=1.0), []
    for name, locked in STAGES.items():
        one = (*_ends(values, locked, gap), 1.0, values, locked)
        stress = subject.call(*one).stress
        if not stress[2] - stress[1] < 0.0:
            return check.fail(f"axial stress {stress[2] - stress[1]:.3g} MPa in {name} does not resist")
        roundings.append(measure_rounding(subject, *one))
    worst = max(roundings, key=lambda rounding: rounding.share)
    if any(rounding.inexact for rounding in roundings):
        return check.fail(INEXACT, worst.share)
    return check.judge(worst.share, error=worst.stress, condition=worst.condition)


def no_stress(check: Check, subject: Subject, column: Column, beyond: bool) -> Outcome:
    """An end at or beyond the limit asks for a smaller increment, a start there ends the analysis."""
    values, message = subject.values(column), ""
    for name, locked in STAGES.items():
        for overstep in OVERSTEPS:
            start, end = _ends(values, locked, -overstep)
            if overstep == 0.0:
                end[2, 2] = limit_stretch(values) * (1.0 - 4e-16)
            answer = subject.call(end if beyond else start, end, 1.0, values, locked)
            wanted = answer.stopped if beyond else answer.pnewdt <= 0.25 and not answer.stopped
            if not (wanted and "limit" in answer.messages):
                return check.fail(f"{name}, {overstep:g} beyond: stress returned, message {answer.messages!r}", 1.0)
            message = answer.messages
    return check.refuse(message, 0.0)


def pressed(check: Check, subject: Subject, column: Column) -> Outcome:
    """A pressure thousands of times the programme's; the ply must stop short of the limit.

    The rate falls by orders from the first increment to the second: extrapolated, the first guess lies beyond the limit or
    at several times the load, from where Newton's iterations do not come back.
    """
    controls = Controls(minimum_increment=1e-30, max_increments=5000, extrapolation="none")
    run = subject.drive(subject.values(column), [plate(1e3, 10.0)], controls)
    gap = run.thickness / limit_stretch(run.values) - 1.0
    if not run.history.completed:
        return check.refuse(run.history.message, gap)
    return check.judge(gap, iterations_worst=run.worst)


def driven(check: Check, subject: Subject, column: Column) -> Outcome:
    """A plate that moves through the limit at constant speed."""
    values = subject.values(column)
    steps = [plate(0.9 * limit_stretch(values), 10.0, driven=True)]
    run = subject.drive(values, steps, Controls(minimum_increment=1e-9))
    gap = run.thickness / limit_stretch(values) - 1.0
    if run.history.completed:
        return check.fail("went through the limit", gap)
    return check.refuse(run.history.message, gap)
