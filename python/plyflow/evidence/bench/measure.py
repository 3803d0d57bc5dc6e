"""The runs: every problem, scheme and step control, repeated in turns so that a slow moment hits all alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from plyflow.driver.drive import History, drive
from plyflow.errors import InputError
from plyflow.evidence.bench.problems import Control, Problem, Reference, values_for
from plyflow.evidence.bench.schemes import Scheme
from plyflow.evidence.bench.spread import Spread, spread_of
from plyflow.show.progress import Advance

SLOW_LEVELS = ("growth 0.3", "growth 1", "equal 10", "equal 30")
BEST_OF = 3  # runs in a row of which a turn takes the best, because a busy machine only ever adds to the time


@dataclass
class Point:
    """One problem, scheme and step control: what it costs and how far it is off.

    `seconds` holds one entry a repeat; `errors` is empty where the run stopped, `message` says why.
    """

    problem: str
    scheme: str
    control: str
    family: str
    increments: int
    iterations: int
    umat_calls: int
    message: str
    errors: dict[str, float] = field(default_factory=dict)
    seconds: list[float] = field(default_factory=list)

    @property
    def completed(self) -> bool:
        """Whether the programme was finished."""
        return self.message == ""

    @property
    def time(self) -> Spread:
        """Run time in s over the repeats."""
        return spread_of(self.seconds)

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return vars(self) | {"seconds_median": self.time.median, "seconds_spread": self.time.relative}


@dataclass(frozen=True)
class Task:
    """One run that can be repeated."""

    problem: Problem
    scheme: Scheme
    control: Control
    props: Any

    def run(self) -> History:
        """Once more."""
        return drive(
            self.scheme.library, self.props, len(self.scheme.manifest["statev"]), self.problem.steps(), self.control.controls,
            temperature=self.problem.case.temperature,
        )  # fmt: skip


def tasks_of(problems: Sequence[Problem], schemes: Sequence[Scheme]) -> list[Task]:
    """Every combination that makes sense; a scene with baked constants runs its own case only."""
    found = []
    for problem in problems:
        for scheme in schemes:
            try:
                props = np.array(scheme.props(problem))
            except InputError:
                continue
            found += [Task(problem, scheme, control, props) for control in problem.step_controls(newton=scheme.newton, **scheme.more)
                      if not scheme.slow or control.label in SLOW_LEVELS]  # fmt: skip
    return found


def measure(tasks: Sequence[Task], repeats: int, slow_repeats: int, advance: Advance) -> list[Point]:
    """Run all tasks once for the errors (the runs are deterministic), then `repeats` times in turns for the times.

    Slow schemes run `slow_repeats` times in all, runs that stopped once.
    """
    points, histories = [], []
    for task in tasks:
        history = task.run()
        histories.append(history)
        points.append(Point(
            task.problem.name, task.scheme.name, task.control.label, task.control.family, history.increments,
            history.total_iterations, history.umat_calls, "" if history.completed else history.message,
            seconds=[history.run_time_s] if task.scheme.slow or not history.completed else [],
        ))  # fmt: skip
        advance(task.scheme.name)
    _add_errors(tasks, histories, points)
    for number in range(repeats):
        for task, point in zip(tasks, points, strict=True):
            runs = BEST_OF if not task.scheme.slow else 1 if number + 1 < slow_repeats else 0
            if point.completed and runs:
                point.seconds.append(min(task.run().run_time_s for _ in range(runs)))
            advance(task.scheme.name)
    return points


def _add_errors(tasks: Sequence[Task], histories: Sequence[History], points: Sequence[Point]) -> None:
    for problem in {task.problem.name: task.problem for task in tasks}.values():
        mine = [one for one in zip(tasks, histories, points, strict=True) if one[0].problem.name == problem.name]
        times = np.unique(np.concatenate([history.time for _, history, _ in mine]))
        values = values_for(problem, next(task.scheme.manifest for task, _, _ in mine if task.scheme.general))
        reference = Reference(problem, values, times)
        for task, history, point in mine:
            if point.completed:
                locked = history.statev[:, task.scheme.locked_index] >= 0.5
                point.errors = problem.errors(history, locked, reference)
