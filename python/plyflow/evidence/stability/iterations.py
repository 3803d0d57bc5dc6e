"""Newton on the 84 cases of the programme: what each tangent costs, what a good first tangent buys, the order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np

from plyflow.case.case import Case, all_cases, driver_steps
from plyflow.driver.drive import Controls, History
from plyflow.evidence.stability.bench import Bench, Column
from plyflow.evidence.stability.cells import WHOLE, Check, Detail, Outcome, Task
from plyflow.evidence.stability.programmes import failed_increments
from plyflow.run.case_run import case_controls

TANGENT_GROUP = "Three tangents over the 84 cases"
FIRST_GROUP = "First iterations: plain Newton, tangent at vanishing rate"
TANGENTS = {"consistent": "default", "paper": "paper", "symmetric": "symmetric"}
MEDIAN = Check(TANGENT_GROUP, "consistent: median of the iterations of an increment", "iterations", 4)
WORST = Check(TANGENT_GROUP, "consistent: most iterations of an increment", "iterations", 12)
FAILED = Check(TANGENT_GROUP, "consistent: no failed increment besides located events", "failed increments", 0)
FINISHED = {
    tangent: Check(TANGENT_GROUP, f"{tangent}: every case ends", "cases that do not end", 0) for tangent in TANGENTS
}
SAVED = {
    extrapolation: Check(
        FIRST_GROUP,
        f"last rate beside floor, extrapolation {extrapolation}: costs no case and no iterations",
        "iterations an increment with the last rate / with the floor [-]",
        1.0,
    )
    for extrapolation in ("none", "linear")
}
PLAIN = Check(FIRST_GROUP, "last rate, plain Newton, extrapolation none: every case ends", "cases that do not end", 0)
LONGEST = 3000


@dataclass(frozen=True)
class Tally:
    """What a set of cases took: cases run and ended, counts over all of them, iterations of each accepted increment."""

    cases: int
    ended: int
    increments: int
    iterations: int
    failed: int
    landings: int
    run_time_s: float
    by_increment: tuple[int, ...]
    messages: tuple[str, ...]

    def numbers(self) -> dict[str, Detail]:
        """Plain numbers for the details of a cell."""
        counts = self.by_increment or (0,)
        return {
            "cases": self.cases,
            "ended": self.ended,
            "increments": self.increments,
            "iterations": self.iterations,
            "median": float(np.median(counts)),
            "worst": max(counts),
            "failed_increments": self.failed,
            "landings_on_the_lock": self.landings,
            "run_time_s": self.run_time_s,
        }


Runner = Callable[[str], Tally]


def tasks(bench: Bench) -> Iterator[Task]:
    """List the cells of this group."""
    tally = cache(partial(run_tangent, bench))
    for check in (MEDIAN, WORST, FAILED):
        yield Task(check, WHOLE, partial(demand, check, tally))
    for tangent, check in FINISHED.items():
        yield Task(check, WHOLE, partial(finished, check, tally, tangent))
    for extrapolation, check in SAVED.items():
        plain = cache(partial(run_plain, bench, extrapolation))
        if extrapolation == "none":
            yield Task(PLAIN, WHOLE, partial(finished, PLAIN, plain, "default"))
        yield Task(check, WHOLE, partial(saved, check, plain))


def cases(bench: Bench) -> Sequence[Case]:
    """List the 84 ramp-dwell cases; in the quick matrix every fourth."""
    return all_cases()[::4] if bench.quick else all_cases()


def plain_newton(extrapolation: Any) -> Controls:
    """Newton without the power-law step, as Abaqus has it, increments free to grow."""
    return replace(
        case_controls(),
        newton="plain",
        extrapolation=extrapolation,
        easy_iterations=8,
        max_iterations=20,
        max_attempts=10,
        max_increments=LONGEST,
    )


def run_tangent(bench: Bench, tangent: str) -> Tally:
    """Every case with one of the tangents, controls of the demo."""
    return run_cases(bench, cases(bench), TANGENTS[tangent], case_controls())


def run_plain(bench: Bench, extrapolation: str, scene: str) -> Tally:
    """Every fourth case with plain Newton."""
    return run_cases(bench, cases(bench)[::4], scene, plain_newton(extrapolation))


def run_cases(bench: Bench, selected: Sequence[Case], scene: str, controls: Controls) -> Tally:
    """Run cases and count."""
    histories = [_run(bench, case, scene, controls) for case in selected]
    return Tally(
        cases=len(histories),
        ended=sum(history.completed for history in histories),
        increments=sum(history.increments for history in histories),
        iterations=sum(history.total_iterations for history in histories),
        failed=sum(failed_increments(history) for history in histories),
        landings=sum(history.cutbacks_by_reason.get("pnewdt", 0) for history in histories),
        run_time_s=sum(history.run_time_s for history in histories),
        by_increment=tuple(int(n) for history in histories for n in history.iterations[1:]),
        messages=tuple(history.message for history in histories if not history.completed),
    )


def _run(bench: Bench, case: Case, scene: str, controls: Controls) -> History:
    values = bench.values(Column(case.material, case.temperature), case.layup, case.width)
    return bench.drive(values, driver_steps(case.load_programme), controls, scene)


def demand(check: Check, run: Runner) -> Outcome:
    """One of the demands on the consistent tangent; a case that does not end fails them all."""
    tally = run("consistent")
    numbers = tally.numbers()
    measured: Mapping[Check, Detail] = {
        MEDIAN: numbers["median"],
        WORST: numbers["worst"],
        FAILED: numbers["failed_increments"],
    }
    if tally.ended < tally.cases:
        return check.fail(tally.messages[0], **numbers)
    return check.judge(float(measured[check]), **numbers)


def finished(check: Check, run: Runner, which: str) -> Outcome:
    """How many cases do not end; each was refused by the driver with a message."""
    tally = run(which)
    missing = tally.cases - tally.ended
    if missing:
        return check.refuse(f"{missing} of {tally.cases} cases: {tally.messages[0]}", missing, **tally.numbers())
    return check.judge(missing, **tally.numbers())


def saved(check: Check, run: Runner) -> Outcome:
    """Compare the two tangents at vanishing rate, by cases that end and by iterations of an increment."""
    last_rate, floor = run("default"), run("floor")
    details: dict[str, Detail] = {f"last_rate_{name}": value for name, value in last_rate.numbers().items()}
    details |= {f"floor_{name}": value for name, value in floor.numbers().items()}
    if last_rate.ended < max(floor.ended, 1):
        return check.fail(f"the last rate ends {last_rate.ended} cases, the floor {floor.ended}", **details)
    each = [one.iterations / max(one.increments, 1) for one in (last_rate, floor)]
    ratio = each[0] / each[1] if floor.increments else 0.0
    reason = (
        f"{each[0]:.2f} iterations an increment and {last_rate.ended} of {last_rate.cases} cases with the last rate, "
        f"{each[1]:.2f} and {floor.ended} with the floor"
    )
    return check.judge(ratio, reason, **details)
