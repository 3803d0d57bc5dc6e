"""Newton on the 84 cases of the programme: what each tangent costs, what a good first tangent buys, the order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from plyflow.case.case import Case, all_cases
from plyflow.driver.drive import Controls
from plyflow.evidence.stability.cells import Check, Claim, Detail, Family, Outcome
from plyflow.evidence.stability.subject import Column, Run, Subject
from plyflow.run.case_run import case_controls

TANGENT_FAMILY = Family("Three tangents over the 84 cases", place=12)
FIRST_FAMILY = Family("First iterations: plain Newton, tangent at vanishing rate", place=13)
TANGENTS = {"consistent": "default", "paper": "paper", "symmetric": "symmetric"}
demands = partial(TANGENT_FAMILY.cells, whole=True)
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
        "landings_on_the_lock": sum(history.cutbacks_by_reason.get("pnewdt", 0) for history in histories),
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


for name, measures, bound, number, claim in (
    (
        "median of the iterations of an increment",
        "iterations",
        4,
        "median",
        "median iterations at most 4 over the 84 cases",
    ),
    ("most iterations of an increment", "iterations", 12, "worst", "worst iterations at most 12"),
    (
        "no failed increment besides located events",
        "failed increments",
        0,
        "failed_increments",
        "no failed increments besides located events",
    ),
):
    place = 8 + len(TANGENT_FAMILY.entries)
    demands(f"consistent: {name}", measures, bound, claim=Claim(place, claim), number=[number])(demand)


def _finished(check: Check, tally: Tally) -> Outcome:
    """How many cases do not end; each was refused by the driver with a message."""
    numbers, messages = tally
    if messages:
        return check.refuse(f"{len(messages)} of {numbers['cases']} cases: {messages[0]}", len(messages), **numbers)
    return check.judge(0, **numbers)


@demands("{tangent}: every case ends", "cases that do not end", 0, tangent=TANGENTS)
def finished(check: Check, subject: Subject, tangent: str) -> Outcome:
    """Every case with one of the tangents."""
    return _finished(check, subject.once(run_tangent, tangent))


@FIRST_FAMILY.cells(
    "last rate, plain Newton, extrapolation none: every case ends", "cases that do not end", 0, whole=True
)
def plain_finished(check: Check, subject: Subject) -> Outcome:
    """Every case with plain Newton."""
    return _finished(check, subject.once(run_plain, "none", "default"))


@FIRST_FAMILY.cells(
    "last rate beside floor, extrapolation {extrapolation}: costs no case and no iterations",
    "iterations an increment with the last rate / with the floor [-]",
    1.0,
    whole=True,
    extrapolation=("none", "linear"),
)
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
