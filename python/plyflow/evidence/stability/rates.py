"""No time, no rate, vanishing rate, and time increments over sixteen decades."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.ledger import viscous_stress
from plyflow.evidence.stability.states import STAGES, Increment, stage_increment
from plyflow.evidence.stability.subject import Column, Subject
from plyflow.evidence.stability.tensors import Array, green, second_piola

DECADES = range(-10, 7)
SIZE = 1e-2
RATE, HISTORY = 6, 8
"""Places of the rate and of what the integrator carries on in STATEV."""


def called_viscous_stress(subject: Subject, one: Increment) -> tuple[Array, Array]:
    """Viscous S (3, 3) and DDSDDE (6, 6) of one call, MPa."""
    answer = subject.call(*one)
    stress = second_piola(answer.stress, one.end)
    return viscous_stress(stress, one.end, answer.statev[5], one.values), answer.ddsdde


def rate_factor(start: Array, end: Array, dt: float, values: Mapping[str, float]) -> float:
    """(J2 + j0)^(a/2) / dt: how the viscous stress of a given increment depends on its time."""
    strain = green(end) - green(start)
    j2 = 0.5 * float((strain**2).sum()) / dt**2
    floor = max(values["rate_floor"], values["strain_floor"] / dt) ** 2
    return float((j2 + floor) ** (0.5 * values["a"]) / dt)


def no_rate(check: Check, subject: Subject, column: Column) -> Outcome:
    """Stress and tangent of an increment in which nothing moves."""
    values = subject.values(column)
    worst, stiffness = 0.0, values["E_L"] + values["kappa"]
    for locked in STAGES.values():
        _, end = stage_increment(values, locked, SIZE)
        for dt in (1e-10, 1.0, 1e6):
            flow, tangent = called_viscous_stress(subject, Increment(end, end, dt, values, locked))
            worst = max(worst, float(np.abs(flow).max()) / stiffness)
            if not np.linalg.eigvalsh(0.5 * (tangent + tangent.T)).min() > 0.0:
                return check.fail(f"the tangent at rest is not positive definite at dt = {dt:g} s")
    return check.judge(worst)


def no_time(check: Check, subject: Subject, column: Column, scene: str) -> Outcome:
    """Stress, tangent and state of an increment without time after one that moved at -1e-3 1/s."""
    values, worst = subject.values(column), 0.0
    for locked in STAGES.values():
        start, end = stage_increment(values, locked, SIZE)
        statev = subject.statev(locked, scene)
        kept = [RATE, *range(HISTORY, len(statev))]
        statev[kept] = -1e-3, *np.ones(len(kept) - 1)
        answer = subject.call(start, end, 0.0, values, statev, scene)
        if answer.messages:
            return check.refuse(answer.messages)
        if not np.array_equal(answer.statev[kept], statev[kept]) or answer.scd != 0.0:
            return check.fail("the rate, the history or the dissipation moved without time")
        if not np.linalg.eigvalsh(0.5 * (answer.ddsdde + answer.ddsdde.T)).min() > 0.0:
            return check.fail("the tangent without time is not positive definite")
        flow = viscous_stress(second_piola(answer.stress, end), end, answer.statev[5], values)
        worst = max(worst, float(np.abs(flow).max()) / (values["E_L"] + values["kappa"]))
    return check.judge(worst)


def vanishing_rate(check: Check, subject: Subject, column: Column) -> Outcome:
    """Stress of increments halved from 3e-2 down to one unit in the last place."""
    values, axial = subject.values(column, kappa=0.0), []
    for size in 2.0 ** -np.arange(5, 53):
        end = np.diag([1.0, 1.0 + size, 1.0 - size])
        flow, _ = called_viscous_stress(subject, Increment(np.eye(3), end, 1.0, values, False))
        axial.append(flow[1, 1] - flow[2, 2])
    ratios = np.array(axial[1:]) / np.array(axial[:-1])
    if not np.all(ratios > 0.0):
        return check.fail("the stress changes its sign")
    slope = float(np.log2(axial[-2] / axial[-1]))
    return check.judge(float(ratios.max()), slope_at_zero=slope, smallest_stress_MPa=float(axial[-1]))


def time_increments(check: Check, subject: Subject, column: Column) -> Outcome:
    """One strain increment, taken in times from 1e-10 to 1e6 s."""
    values, worst = subject.values(column, kappa=0.0), 0.0
    for locked in STAGES.values():
        ends, scaled = stage_increment(values, locked, SIZE), []
        for dt in (10.0**decade for decade in DECADES):
            flow, _ = called_viscous_stress(subject, Increment(*ends, dt, values, locked))
            scaled.append(flow[2, 2] / rate_factor(*ends, dt, values))
        worst = max(worst, float(np.ptp(scaled) / abs(scaled[0])))
    return check.judge(worst)
