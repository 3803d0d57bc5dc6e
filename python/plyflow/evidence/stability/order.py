"""Measured order of Newton's method with each tangent."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from plyflow.case.case import Case, driver_steps
from plyflow.driver.drive import History
from plyflow.evidence.stability.bench import LOCKED, Bench, Column, Values
from plyflow.evidence.stability.cells import Check, Outcome, Task
from plyflow.evidence.stability.tensors import EPSILON, Array
from plyflow.run.case_run import case_controls

GROUP = "Order of convergence"
BOUNDS = {"default": 1.9, "paper": 0.5, "symmetric": 0.5}
NAMES = {"default": "consistent", "paper": "paper", "symmetric": "symmetric"}
CHECKS = {
    (load, scene): Check(
        GROUP,
        f"{load}, {NAMES[scene]} tangent: order of the last Newton steps",
        "median over the increments of a case, least of the cases [-]",
        bound,
        at_least=True,
    )
    for load in ("ramp-dwell", "monotonic")
    for scene, bound in BOUNDS.items()
}
ABOVE_ROUNDING = 100.0
CONVERGING = {"default": 0.1, "paper": 1.0, "symmetric": 1.0}
FEWEST = 5


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    for how, check in CHECKS.items():
        for column in bench.columns:
            yield Task(
                check,
                column.label,
                partial(measure, bench, check, column, *how),
            )


def measure(bench: Bench, check: Check, column: Column, load: str, scene: str) -> Outcome:
    """Order over the cases of a column, iterated down to rounding."""
    controls = replace(case_controls(), residual_tolerance=1e-13, max_iterations=40, easy_iterations=20)
    medians, everything = [], []
    for layup, width in bench.few([("CP", 15.0), ("SB", 15.0), ("BP", 15.0), ("BP", 30.0)], 2):
        case = Case(column.material, column.temperature, layup, width, load)
        values = bench.values(column, layup, width, kappa=1e3 * case.load_programme.peak)
        history = bench.drive(values, driver_steps(case.load_programme), controls, scene)
        if not history.completed:
            return check.refuse(history.message)
        orders = last_orders(history, values, case.load_programme.peak, CONVERGING[scene])
        if len(orders) < FEWEST:
            return check.fail(f"only {len(orders)} increments have three residuals above rounding")
        medians.append(float(np.median(orders)))
        everything += list(orders)
    good = float(np.mean(np.array(everything) >= check.bound))
    return check.judge(min(medians), increments_measured=len(everything), share_above_bound=good)


def last_orders(history: History, values: Values, load: float, converging: float) -> Array:
    """Order ln(r3/r2) / ln(r2/r1) from the last three residuals above rounding, for every increment that has them.

    Steps count once they reduce the residual by the factor `converging`. Rounding: an ulp of F beside the
    strain increment, and times kappa beside the load.
    """
    strain = np.abs(np.diff(np.log(history.deformation_gradient[:, 2, 2])))
    squeezing = history.statev[:-1, LOCKED] < 1.0
    with np.errstate(divide="ignore"):
        rounding = ABOVE_ROUNDING * EPSILON * (1.0 / strain + squeezing * values["kappa"] / load)
    found = []
    for residuals, least in zip(history.residuals[1:], rounding, strict=True):
        triples = zip(residuals, residuals[1:], residuals[2:], strict=False)
        usable = [(a, b, c) for a, b, c in triples if b < converging * a and least < c < b]
        if usable:
            first, second, third = usable[-1]
            found.append(np.log(third / second) / np.log(second / first))
    return np.array(found)
