"""Measured order of Newton's method with each tangent."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from plyflow.evidence.stability.cells import Check, Claim, Family, Outcome
from plyflow.evidence.stability.subject import Column, Run, Subject
from plyflow.evidence.stability.tensors import EPSILON, Array
from plyflow.run.case_run import case_controls

FAMILY = Family("Order of convergence", place=14)
QUADRATIC = Claim(7, "consistent tangent: order of the last Newton steps at least 1.9")
TANGENTS = {"consistent": ("default", 1.9, 0.1), "paper": ("paper", 0.5, 1.0), "symmetric": ("symmetric", 0.5, 1.0)}
"""Scene, least order, and the factor by which a step must reduce the residual to count."""
ABOVE_ROUNDING = 100.0
FEWEST = 5


@FAMILY.cells(
    "{load}, {tangent} tangent: order of the last Newton steps",
    "median over the increments of a case, least of the cases [-]",
    lambda load, tangent: TANGENTS[tangent][1],
    at_least=True,
    claim=lambda load, tangent: QUADRATIC if tangent == "consistent" else None,
    load=("ramp-dwell", "monotonic"),
    tangent=TANGENTS,
)
def newton_order(check: Check, subject: Subject, column: Column, load: str, tangent: str) -> Outcome:
    """Order over the cases of a column, iterated down to rounding."""
    scene, _, converging = TANGENTS[tangent]
    controls = replace(case_controls(), residual_tolerance=1e-13, max_iterations=40, easy_iterations=20)
    medians, everything = [], []
    for layup, width in subject.few([("CP", 15.0), ("SB", 15.0), ("BP", 15.0), ("BP", 30.0)], 2):
        case = column.case(layup, width, load)
        peak = case.load_programme.peak
        run = subject.drive_case(case, subject.values(column, layup, width, kappa=1e3 * peak), scene, controls).ended()
        orders = last_orders(run, peak, converging)
        if len(orders) < FEWEST:
            return check.fail(f"only {len(orders)} increments have three residuals above rounding")
        medians.append(float(np.median(orders)))
        everything += list(orders)
    good = float(np.mean(np.array(everything) >= check.bound))
    return check.judge(min(medians), increments_measured=len(everything), share_above_bound=good)


def last_orders(run: Run, load: float, converging: float) -> Array:
    """Order ln(r3/r2) / ln(r2/r1) from the last three residuals above rounding, for every increment that has them.

    Steps count once they reduce the residual by the factor `converging`. Rounding: an ulp of F beside the
    strain increment, and times kappa beside the load.
    """
    strain = np.abs(np.diff(np.log(run.history.deformation_gradient[:, 2, 2])))
    squeezing = run.locked[:-1] < 1.0
    with np.errstate(divide="ignore"):
        rounding = ABOVE_ROUNDING * EPSILON * (1.0 / strain + squeezing * run.values["kappa"] / load)
    found = []
    for residuals, least in zip(run.history.residuals[1:], rounding, strict=True):
        triples = zip(residuals, residuals[1:], residuals[2:], strict=False)
        usable = [(a, b, c) for a, b, c in triples if b < converging * a and least < c < b]
        if usable:
            first, second, third = usable[-1]
            found.append(np.log(third / second) / np.log(second / first))
    return np.array(found)
