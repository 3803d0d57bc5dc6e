"""No rate, vanishing rate, and time increments over sixteen decades."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from plyflow.evidence.stability.bench import Bench, Column, Values
from plyflow.evidence.stability.cells import Check, Outcome, Task
from plyflow.evidence.stability.states import STAGES, stage_increment
from plyflow.evidence.stability.tensors import EPSILON, Array, elastic_stress, green, second_piola

GROUP = "Rates and time increments"
NO_RATE = Check(
    GROUP,
    "no rate: the elastic stress alone, tangent finite and positive",
    "stress beside an independent elastic law / stiffness [-]",
    32 * EPSILON,
)
VANISHING = Check(
    GROUP,
    "rate down to 2e-16 of strain in 1 s: the stress falls all the way",
    "largest ratio of the stress to that of twice the rate [-]",
    1.0,
)
TIMES = Check(
    GROUP,
    "dt from 1e-10 to 1e6 s: stress as (J2 + floor)^(a/2) Cdot",
    "deviation from the power law over 16 decades [-]",
    1e-12,
)
DECADES = range(-10, 7)
SIZE = 1e-2


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    for check, fill in ((NO_RATE, no_rate), (VANISHING, vanishing_rate), (TIMES, time_increments)):
        for column in bench.columns:
            yield Task(check, column.label, partial(fill, bench, column))


def no_rate(bench: Bench, column: Column) -> Outcome:
    """Stress and tangent of an increment in which nothing moves."""
    values = bench.values(column)
    worst, stiffness = 0.0, values["E_L"] + values["kappa"]
    for locked in STAGES.values():
        _, end = stage_increment(values, locked, SIZE)
        for dt in (1e-10, 1.0, 1e6):
            answer = bench.call(end, end, dt, values, locked)
            flow = viscous_stress(answer.stress, end, float(answer.statev[5]), values)
            worst = max(worst, float(np.abs(flow).max()) / stiffness)
            tangent = 0.5 * (answer.ddsdde + answer.ddsdde.T)
            if not np.linalg.eigvalsh(tangent).min() > 0.0:
                return NO_RATE.fail(f"the tangent at rest is not positive definite at dt = {dt:g} s")
    return NO_RATE.judge(worst)


def vanishing_rate(bench: Bench, column: Column) -> Outcome:
    """Stress of increments halved from 3e-2 down to one unit in the last place."""
    values = bench.values(column, kappa=0.0)
    sizes = 2.0 ** -np.arange(5, 53)
    axial = []
    for size in sizes:
        end = np.diag([1.0, 1.0 + size, 1.0 - size])
        answer = bench.call(np.eye(3), end, 1.0, values)
        flow = viscous_stress(answer.stress, end, float(answer.statev[5]), values)
        axial.append(flow[1, 1] - flow[2, 2])
    ratios = np.array(axial[1:]) / np.array(axial[:-1])
    if not np.all(ratios > 0.0):
        return VANISHING.fail("the stress changes its sign")
    return VANISHING.judge(
        float(ratios.max()),
        slope_at_zero=float(np.log2(axial[-2] / axial[-1])),
        smallest_stress_MPa=float(axial[-1]),
    )


def time_increments(bench: Bench, column: Column) -> Outcome:
    """One strain increment, taken in times from 1e-10 to 1e6 s."""
    values = bench.values(column, kappa=0.0)
    worst = 0.0
    for locked in STAGES.values():
        start, end = stage_increment(values, locked, SIZE)
        scaled = []
        for decade in DECADES:
            dt = 10.0**decade
            answer = bench.call(start, end, dt, values, locked)
            flow = viscous_stress(answer.stress, end, float(answer.statev[5]), values)
            scaled.append(flow[2, 2] / rate_factor(start, end, dt, values))
        worst = max(worst, float(np.ptp(scaled) / abs(scaled[0])))
    return TIMES.judge(worst)


def viscous_stress(stress: Array, end: Array, pressure: float, values: Values) -> Array:
    """Viscous second Piola-Kirchhoff stress (3, 3) in MPa: what elastic law and pressure leave."""
    right = green(end)
    constraint = -pressure * np.linalg.det(end) * np.linalg.inv(right)
    return np.asarray(second_piola(stress, end) - elastic_stress(right, values) - constraint)


def rate_factor(start: Array, end: Array, dt: float, values: Mapping[str, float]) -> float:
    """(J2 + j0)^(a/2) / dt: how the viscous stress of a given increment depends on its time."""
    strain = green(end) - green(start)
    j2 = 0.5 * float((strain**2).sum()) / dt**2
    floor = max(values["rate_floor"], values["strain_floor"] / dt) ** 2
    return float((j2 + floor) ** (0.5 * values["a"]) / dt)
