"""Whole programmes with few and many increments, and the load in one instant: the width at the end."""

from __future__ import annotations

from functools import cache

import numpy as np

from plyflow.case.case import Case, driver_steps, law_parameters
from plyflow.case.loads import find_load
from plyflow.driver.drive import Controls
from plyflow.evidence.stability.cells import Check, Outcome
from plyflow.evidence.stability.subject import Column, Run, Subject, plate
from plyflow.law import LawParameters, integrate

SHORTEST = 1e-90


def whole_programmes(check: Check, subject: Subject, column: Column, scene: str, load: str, asked: int) -> Outcome:
    """Run the cases of a column; the worst width decides, a refused case is told."""
    worst, thickness, iterations, failed, refused = 0.0, 0.0, [0], 0, []
    cases = cases_of(subject, column, load, scene)
    for case in cases:
        run = run_programme(subject, case, scene, load, asked)
        if not run.history.completed:
            refused.append(f"{case.layup} {case.width:g} mm: {run.history.message}")
            continue
        worst = max(worst, run.width_error)
        if load != "instant" and case == cases[-1]:
            law = _law_thickness(case.load, case.width, law_parameters(run.values))
            thickness = max(thickness, abs(run.thickness - law))
        iterations += list(run.history.iterations[1:])
        failed += run.failed
    if refused and worst <= check.bound:
        return check.refuse("; ".join(refused), worst, refused=len(refused))
    return check.judge(
        worst,
        thickness_error=thickness,
        iterations_median=float(np.median(iterations)),
        iterations_worst=int(max(iterations)),
        failed_increments=failed,
    )


def cases_of(subject: Subject, column: Column, load: str, scene: str) -> list[Case]:
    """List the programme's cases of a column: three layups at two widths, beside the default scene two of them."""
    name = "monotonic" if load == "monotonic" else "ramp-dwell"
    cases = [column.case(layup, width, name) for width in (15.0, 30.0) for layup in ("CP", "SB", "BP")]
    return [cases[0], cases[2]] if subject.quick or scene != "default" else [*cases[3:], *cases[:3]]


def run_programme(subject: Subject, case: Case, scene: str, load: str, asked: int) -> Run:
    """One case with increments of its whole time / `asked`, or shorter where the lock or Newton needs it."""
    programme = case.load_programme
    values = subject.values(Column(case.material, case.temperature), case.layup, case.width)
    steps = driver_steps(programme)
    if load == "instant":
        steps = [plate(programme.peak, programme.end, instant=True)]
    largest = programme.end / asked
    controls = Controls(
        initial_increment=min(largest, *(step.duration for step in steps)),
        maximum_increment=largest,
        minimum_increment=SHORTEST,
        growth=10.0,
        easy_in_a_row=1,
        easy_iterations=6,
    )
    return subject.drive(values, steps, controls, scene)


@cache
def _law_thickness(load: str, width: float, parameters: LawParameters) -> float:
    """Final h/h0 [-] of the one-dimensional law for a case of the programme."""
    programme = find_load(load, width)
    return float(integrate(parameters, programme, np.array([programme.end])).thickness_ratio[0])
