"""Simple shear in all planes, shear under load, and compression along the fibre."""

from __future__ import annotations

import numpy as np

from plyflow.driver.drive import Controls, Kind, Step
from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.rounding import INEXACT, Rounding, measure_rounding
from plyflow.evidence.stability.subject import NOTHING, Column, Run, Subject, Values

THINNING = ("31", "32")
"""Planes in which simple shear moves the ply's faces towards each other."""
ALL_STRESS: dict[str, Kind] = dict.fromkeys(NOTHING, "S")
FIBRE_DRIVEN: dict[str, Kind] = {**ALL_STRESS, "11": "F", "12": "F", "13": "F", "23": "F"}


def _place(plane: str) -> tuple[int, int]:
    return int(plane[0]) - 1, int(plane[1]) - 1


def _sheared(plane: str, amount: float) -> np.ndarray:
    gradient = np.eye(3)
    gradient[_place(plane)] = amount
    return gradient


def sheared(check: Check, subject: Subject, column: Column, plane: str) -> Outcome:
    """Shear at constant speed: out of the ply's plane it shortens the ply normal and may end at the limit with a message.

    In all other planes no thickness changes, whatever the shear.
    """
    values = subject.values(column, kappa=1.0)
    found: list[Rounding] = []
    statev, start = subject.statev(), np.eye(3)
    for step in range(1, 41):
        one = (start, _sheared(plane, step / 40.0), 0.25, values, statev)
        answer = subject.call(*one)
        if answer.messages:
            share = max((rounding.share for rounding in found), default=0.0)
            return check.refuse(answer.messages, share, shear_reached=step / 40.0)
        thinner = -0.5 * np.log1p((step / 40.0) ** 2) if plane in THINNING else 0.0
        if abs(answer.statev[0] - thinner) > 1e-15:
            return check.fail(f"compaction {answer.statev[0]:.3g} at shear {step / 40.0:g}, the ply normal's is {thinner:.3g}")
        if step % 8 == 0:
            found.append(measure_rounding(subject, *one))
        start, statev = one[1], answer.statev
    share = max(rounding.share for rounding in found)
    if any(rounding.inexact for rounding in found):
        return check.fail(INEXACT, share)
    good = max((rounding.stress for rounding in found if rounding.well_conditioned), default=0.0)
    return check.judge(share, condition=max(rounding.condition for rounding in found), error_below_1e3=good)


def _drive(subject: Subject, values: Values, targets: dict[str, float], kinds: dict[str, Kind]) -> Run:
    controls = Controls(initial_increment=1e-2, maximum_increment=1.0)
    return subject.drive(values, [Step(10.0, {**NOTHING, **targets}, kinds)], controls).ended()


def under_load(check: Check, subject: Subject, column: Column, plane: str) -> Outcome:
    """A shear stress ramped up in 10 s; by the UMAT's own law it then flows at about 1e-3 1/s."""
    values = subject.values(column)
    answer = subject.call(np.eye(3), _sheared(plane, 1e-3), 1.0, values)
    run = _drive(subject, values, {plane: float(answer.stress[list(NOTHING).index(plane)])}, ALL_STRESS)
    shear = float(run.history.deformation_gradient[-1][_place(plane)])
    return check.judge(run.worst, failed_increments=run.failed, shear=shear)


def shortened(check: Check, subject: Subject, column: Column) -> Outcome:
    """Compression along the fibre by displacement; the sides follow at constant volume."""
    run = _drive(subject, subject.values(column), {"11": 0.9}, FIBRE_DRIVEN)
    volume = float(np.linalg.det(run.history.deformation_gradient[-1]) - 1.0)
    if abs(volume) > 1e-4:
        return check.fail(f"volume changed by {volume:.3g}")
    return check.judge(run.worst, failed_increments=run.failed, volume_change=volume)


def pushed(check: Check, subject: Subject, column: Column) -> Outcome:
    """Compression along the fibre by stress, its Poisson expansion and flow free."""
    values = subject.values(column)
    run = _drive(subject, values, {"11": -0.1 * values["E_L"]}, ALL_STRESS)
    stretch = float(run.history.deformation_gradient[-1, 0, 0])
    return check.judge(run.worst, failed_increments=run.failed, fibre_stretch=stretch)
