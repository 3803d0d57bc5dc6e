"""Newton on the 84 cases of the programme: what each tangent costs, what a good first tangent buys, the order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from plyflow.case.case import Case, all_cases
from plyflow.driver.drive import Controls
from plyflow.evidence.stability.cells import Check, Detail, Outcome
from plyflow.evidence.stability.subject import Column, Run, Subject
from plyflow.evidence.stability.tensors import EPSILON, Array
from plyflow.run.case_run import case_controls

TANGENTS = {"consistent": "default", "paper": "paper", "symmetric": "symmetric"}
CONVERGING = {"consistent": 0.1, "paper": 1.0, "symmetric": 1.0}
"""Factor by which a step must reduce the residual for its order to count."""
ABOVE_ROUNDING = 100.0
FEWEST = 5
Tally = tuple[dict[str, Any], list[str]]


def cases(subject: Subject) -> Sequence[Case]:
    """List the 84 ramp-dwell cases; in the quick matrix every fourth."""
    return all_cases()[::4] if subject.quick else all_cases()


def plain_newton(extrapolation: Any) -> Controls:
    """Newton without the power-law step, as Abaqus has it, increments free to grow."""
    return replace(
        case_controls(),
        newton="plain",
        extrapolation=extrapolation,
        easy_iterations=8,
        max_iterations=20,
        max_attempts=10,
        max_increments=3000,
    )


def run_tangent(subject: Subject, tangent: str) -> Tally:
    """Every case with one of the tangents, controls of the demo."""
    return run_cases(subject, cases(subject), TANGENTS[tangent], case_controls())


def run_plain(subject: Subject, extrapolation: str, scene: str) -> Tally:
    """Every fourth case with plain Newton."""
    return run_cases(subject, cases(subject)[::4], scene, plain_newton(extrapolation))


def run_cases(subject: Subject, selected: Sequence[Case], scene: str, controls: Controls) -> Tally:
    """Run cases and count; the messages are those of the cases that do not end."""
    runs = [_run(subject, case, scene, controls) for case in selected]
    histories = [run.history for run in runs]
    counts = [int(number) for history in histories for number in history.iterations[1:]] or [0]
    numbers: dict[str, Any] = {
        "cases": len(runs),
        "ended": sum(history.completed for history in histories),
        "increments": sum(history.increments for history in histories),
        "iterations": sum(history.total_iterations for history in histories),
        "median": float(np.median(counts)),
        "worst": max(counts),
        "failed_increments": sum(run.failed for run in runs),
        "run_time_s": sum(history.run_time_s for history in histories),
    }
    return numbers, [history.message for history in histories if not history.completed]


def _run(subject: Subject, case: Case, scene: str, controls: Controls) -> Run:
    values = subject.values(Column(case.material, case.temperature), case.layup, case.width)
    return subject.drive_case(case, values, scene, controls)


def demand(check: Check, subject: Subject, number: str) -> Outcome:
    """One of the demands on the consistent tangent; a case that does not end fails them all."""
    numbers, messages = subject.once(run_tangent, "consistent")
    if messages:
        return check.fail(messages[0], **numbers)
    return check.judge(float(numbers[number]), **numbers)


def _finished(check: Check, tally: Tally) -> Outcome:
    """How many cases do not end; each was refused by the driver with a message."""
    numbers, messages = tally
    if messages:
        return check.refuse(f"{len(messages)} of {numbers['cases']} cases: {messages[0]}", len(messages), **numbers)
    return check.judge(0, **numbers)


def finished(check: Check, subject: Subject, tangent: str) -> Outcome:
    """Every case with one of the tangents."""
    return _finished(check, subject.once(run_tangent, tangent))


def plain_finished(check: Check, subject: Subject) -> Outcome:
    """Every case with plain Newton."""
    return _finished(check, subject.once(run_plain, "none", "default"))


def saved(check: Check, subject: Subject, extrapolation: str) -> Outcome:
    """Compare the two tangents at vanishing rate, by cases that end and by iterations of an increment."""
    (last_rate, _), (floor, _) = (subject.once(run_plain, extrapolation, scene) for scene in ("default", "floor"))
    details: dict[str, Detail] = {f"last_rate_{name}": value for name, value in last_rate.items()}
    details |= {f"floor_{name}": value for name, value in floor.items()}
    if last_rate["ended"] < max(floor["ended"], 1):
        return check.fail(f"the last rate ends {last_rate['ended']} cases, the floor {floor['ended']}", **details)
    each = [one["iterations"] / max(one["increments"], 1) for one in (last_rate, floor)]
    ratio = each[0] / each[1] if floor["increments"] else 0.0
    reason = (
        f"{each[0]:.2f} iterations an increment and {last_rate['ended']} of {last_rate['cases']} cases with the last rate, "
        f"{each[1]:.2f} and {floor['ended']} with the floor"
    )
    return check.judge(ratio, reason, **details)


def order(check: Check, subject: Subject, column: Column, load: str, tangent: str) -> Outcome:
    """Order over the cases of a column, iterated down to rounding."""
    controls = replace(case_controls(), residual_tolerance=1e-13, max_iterations=40, easy_iterations=20)
    medians, everything = [], []
    for layup, width in subject.few([("CP", 15.0), ("SB", 15.0), ("BP", 15.0), ("BP", 30.0)], 2):
        case = column.case(layup, width, load)
        peak = case.load_programme.peak
        run = subject.drive_case(
            case, subject.values(column, layup, width, kappa=1e3 * peak), TANGENTS[tangent], controls
        ).ended()
        orders = last_orders(run, peak, CONVERGING[tangent])
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
