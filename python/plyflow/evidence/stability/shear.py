"""Simple shear in all planes, shear under load, and compression along the fibre."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

from plyflow.driver.drive import Controls, History, Kind, Step
from plyflow.evidence.stability.bench import Bench, Column, statev_at_start
from plyflow.evidence.stability.cells import Check, Outcome, Task
from plyflow.evidence.stability.precision import WELL_CONDITIONED, measure_rounding
from plyflow.evidence.stability.programmes import failed_increments

GROUP = "Shear and the fibre direction"
PLANES = ("12", "13", "21", "23", "31", "32")
SHEARED = {
    plane: Check(
        GROUP,
        f"simple shear {plane} to 1 in 40 increments: resists, as exact as its input",
        "error against quadruple precision / (condition x rounding) [-]",
        4.0,
        may_refuse=plane in ("23", "32"),
    )
    for plane in PLANES
}
UNDER_LOAD = {
    plane: Check(GROUP, f"shear stress {plane} that flows at 1e-3 1/s: ends", "worst number of iterations", 12)
    for plane in ("12", "13", "23")
}
SHORTENED = Check(
    GROUP, "fibre shortened by 10 % in 10 s, sides free: ends, volume kept", "worst number of iterations", 12
)
PUSHED = Check(GROUP, "fibre stress -2.5 MPa (10 % of E_L), sides free: ends", "worst number of iterations", 12)
ALL_STRESS: dict[str, Kind] = dict.fromkeys(("11", "22", "33", "12", "13", "23"), "S")
NOTHING = dict.fromkeys(ALL_STRESS, 0.0)
CONTROLS = Controls(initial_increment=1e-2, maximum_increment=1.0)


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    for column in bench.columns:
        for plane, check in SHEARED.items():
            yield Task(check, column.label, partial(sheared, bench, column, plane))
        for plane, check in UNDER_LOAD.items():
            yield Task(check, column.label, partial(under_load, bench, column, plane))
        yield Task(SHORTENED, column.label, partial(shortened, bench, column))
        yield Task(PUSHED, column.label, partial(pushed, bench, column))


def sheared(bench: Bench, column: Column, plane: str) -> Outcome:
    """Shear at constant speed; transverse shear compacts and may end at the limit with a message."""
    values, check = bench.values(column, kappa=1.0), SHEARED[plane]
    place = (int(plane[0]) - 1, int(plane[1]) - 1)
    statev, shares, conditions, errors = statev_at_start(False), [0.0], [0.0], [0.0]
    start = np.eye(3)
    for step in range(1, 41):
        end = np.eye(3)
        end[place] = step / 40.0
        answer = bench.call(start, end, 0.25, values, statev)
        if answer.messages:
            return check.refuse(answer.messages, max(shares), shear_reached=step / 40.0)
        if step % 8 == 0:
            one = measure_rounding(bench, (start, end), 0.25, values, statev)
            shares.append(one.share)
            if one.condition < WELL_CONDITIONED:
                errors.append(one.stress)
            conditions.append(one.condition)
        start, statev = end, answer.statev
    if max(errors) > 1e-12:
        return check.fail("error above 1e-12 where the condition is below 1e3", max(shares))
    return check.judge(max(shares), condition=max(conditions), error_below_1e3=max(errors))


def under_load(bench: Bench, column: Column, plane: str) -> Outcome:
    """A shear stress ramped up in 10 s; by the UMAT's own law it then flows at about 1e-3 1/s."""
    values, check = bench.values(column), UNDER_LOAD[plane]
    place = (int(plane[0]) - 1, int(plane[1]) - 1)
    end = np.eye(3)
    end[place] = 1e-3
    stress = float(bench.call(np.eye(3), end, 1.0, values).stress[("11", "22", "33", "12", "13", "23").index(plane)])
    history = bench.drive(values, [Step(10.0, {**NOTHING, plane: stress}, ALL_STRESS)], CONTROLS)
    return _judge(check, history, shear=float(history.deformation_gradient[-1][place]))


def shortened(bench: Bench, column: Column) -> Outcome:
    """Compression along the fibre by displacement; the sides follow at constant volume."""
    values, kinds = bench.values(column), {**ALL_STRESS, "11": "F", "12": "F", "13": "F", "23": "F"}
    history = bench.drive(values, [Step(10.0, {**NOTHING, "11": 0.9}, kinds)], CONTROLS)
    volume = float(np.linalg.det(history.deformation_gradient[-1]) - 1.0)
    if history.completed and abs(volume) > 1e-4:
        return SHORTENED.fail(f"volume changed by {volume:.3g}")
    return _judge(SHORTENED, history, volume_change=volume)


def pushed(bench: Bench, column: Column) -> Outcome:
    """Compression along the fibre by stress, its Poisson expansion and flow free."""
    values = bench.values(column)
    target = {**NOTHING, "11": -0.1 * values["E_L"]}
    history = bench.drive(values, [Step(10.0, target, ALL_STRESS)], CONTROLS)
    return _judge(PUSHED, history, fibre_stretch=float(history.deformation_gradient[-1, 0, 0]))


def _judge(check: Check, history: History, /, **details: float) -> Outcome:
    if not history.completed:
        return check.refuse(history.message, **details)
    worst = int(history.iterations[1:].max())
    return check.judge(worst, failed_increments=failed_increments(history), **details)
