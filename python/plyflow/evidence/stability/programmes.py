"""Whole programmes with few and many increments, and the load in one instant: the width at the end."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial

import numpy as np

from plyflow.case.case import PLY_KINDS, Case, driver_steps, law_parameters
from plyflow.driver.drive import Controls, History, Step
from plyflow.evidence.stability.bench import LOCKED, Bench, Column, Values
from plyflow.evidence.stability.cells import Check, Outcome, Task
from plyflow.law import LawParameters, integrate

GROUP = "Programmes and step sizes"
ASKED = (10, 100, 1000)
LOADS = ("ramp-dwell", "monotonic", "instant")
SCENES = ("default", "augmented", "blend", "bdf2log")
WIDTH_TOLERANCE = 1e-3
SHORTEST = 1e-90
CHECKS = {
    (scene, load, asked): Check(
        GROUP,
        f"{load}, {asked} increments asked for, {scene} scene",
        "final width beside exp(-eps_lock), relative [-]",
        WIDTH_TOLERANCE,
        may_refuse=load == "instant",
    )
    for scene in SCENES
    for load in LOADS
    for asked in ASKED
}


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    for how, check in CHECKS.items():
        if bench.quick and how[2] == 1000 and how[0] != "default":
            continue
        for column in bench.columns:
            yield Task(
                check,
                column.label,
                partial(fill, bench, check, column, how),
            )


def fill(bench: Bench, check: Check, column: Column, how: tuple[str, str, int]) -> Outcome:
    """Run the cases of a column; the worst width decides, a refused case is told."""
    scene, load, asked = how
    worst, thickness, iterations, failed, refused = 0.0, 0.0, [0], 0, []
    cases = cases_of(bench, column, load, scene)
    for case in cases:
        values, history = run(bench, case, scene, load, asked)
        if not history.completed:
            refused.append(f"{case.layup} {case.width:g} mm: {history.message}")
            continue
        worst = max(worst, width_error(history, values))
        if load != "instant" and case == cases[-1]:
            thickness = max(thickness, _thickness_error(case, values, history))
        iterations += list(history.iterations[1:])
        failed += failed_increments(history)
    if worst > check.bound or not refused:
        return check.judge(
            worst,
            thickness_error=thickness,
            iterations_median=float(np.median(iterations)),
            iterations_worst=int(max(iterations)),
            failed_increments=failed,
        )
    return check.refuse("; ".join(refused), worst, refused=len(refused))


def cases_of(bench: Bench, column: Column, load: str, scene: str) -> list[Case]:
    """List the programme's cases of a column: three layups at two widths, beside the default scene two of them."""
    name = "monotonic" if load == "monotonic" else "ramp-dwell"
    cases = [
        Case(column.material, column.temperature, layup, width, name)
        for width in (15.0, 30.0)
        for layup in ("CP", "SB", "BP")
    ]
    return [cases[0], cases[2]] if bench.quick or scene != "default" else [*cases[3:], *cases[:3]]


def run(bench: Bench, case: Case, scene: str, load: str, asked: int) -> tuple[Values, History]:
    """One case with increments of its whole time / `asked`, or shorter where the lock or Newton needs it."""
    programme = case.load_programme
    values = bench.values(Column(case.material, case.temperature), case.layup, case.width)
    steps = driver_steps(programme)
    if load == "instant":
        targets = {"11": 1.0, "22": 0.0, "33": programme.peak, "12": 0.0, "13": 0.0, "23": 0.0}
        steps = [Step(programme.end, targets, PLY_KINDS, instant=True)]
    largest = programme.end / asked
    controls = Controls(
        initial_increment=min(largest, *(step.duration for step in steps)),
        maximum_increment=largest,
        minimum_increment=SHORTEST,
        growth=10.0,
        easy_in_a_row=1,
        easy_iterations=6,
    )
    return values, bench.drive(values, steps, controls, scene)


def width_error(history: History, values: Values) -> float:
    """Relative error of the final width beside exp(-eps_lock); infinite where the ply has not locked."""
    if history.statev[-1, LOCKED] == 0.0:
        return float("inf")
    return float(abs(history.deformation_gradient[-1, 1, 1] * np.exp(values["eps_lock"]) - 1.0))


def failed_increments(history: History) -> int:
    """Attempts given up for anything but an event that PNEWDT located."""
    return sum(count for why, count in history.cutbacks_by_reason.items() if why != "pnewdt")


@cache
def _law_thickness(case_key: tuple[str, float, str, float, str], parameters: LawParameters) -> float:
    """Final h/h0 [-] of the one-dimensional law for a case of the programme."""
    load = Case(*case_key).load_programme
    return float(integrate(parameters, load, np.array([load.end])).thickness_ratio[0])


def _thickness_error(case: Case, values: Values, history: History) -> float:
    """Difference of the final thickness from the one-dimensional law, of the initial thickness."""
    key = (case.material, case.temperature, case.layup, case.width, case.load)
    law = _law_thickness(key, law_parameters(values))
    return float(abs(history.deformation_gradient[-1, 2, 2] - law))
