"""The runs: every problem, scheme and step control, repeated in turns so that a slow moment hits all alike."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from plyflow.driver.drive import History, drive
from plyflow.errors import InputError
from plyflow.evidence.bench.problems import Control, Problem, Reference, values_for
from plyflow.evidence.bench.schemes import Scheme

SLOW_LEVELS = ("growth 0.3", "growth 1", "equal 10", "equal 30")
Advance = Callable[[str], None]


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
    def median(self) -> float:
        """Median run time in s."""
        return statistics.median(self.seconds)

    @property
    def spread(self) -> float:
        """Half the interquartile range of the run time over its median."""
        ordered = sorted(self.seconds)
        quarter = len(ordered) // 4
        return (ordered[-1 - quarter] - ordered[quarter]) / 2 / self.median

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return vars(self) | {"seconds_median": self.median, "seconds_spread": self.spread}


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
            for control in problem.step_controls(newton=scheme.newton, **scheme.more):
                if not scheme.slow or control.label in SLOW_LEVELS:
                    found.append(Task(problem, scheme, control, props))
    return found


def measure(
    tasks: Sequence[Task], repeats: int, slow_repeats: int, advance: Advance = lambda name: None, best_of: int = 3
) -> list[Point]:
    """Run all tasks `repeats` times in turns; errors from the first round (the runs are deterministic).

    A turn's time is the best of `best_of` runs in a row, because a busy machine only ever adds to it.
    """
    points, histories = [], []
    for task in tasks:
        history = task.run()
        histories.append(history)
        points.append(_point(task, history))
        advance(task.scheme.name)
    _add_errors(tasks, histories, points)
    for task, point in zip(tasks, points, strict=True):
        if point.completed and not task.scheme.slow:
            point.seconds = [min(point.seconds + [task.run().run_time_s for _ in range(best_of - 1)])]
    for number in range(1, repeats):
        for task, point in zip(tasks, points, strict=True):
            # A run that stopped is not worth repeating.
            if point.completed and (not task.scheme.slow or number < slow_repeats):
                runs = 1 if task.scheme.slow else best_of
                point.seconds.append(min(task.run().run_time_s for _ in range(runs)))
            advance(task.scheme.name)
    return points


def _point(task: Task, history: History) -> Point:
    return Point(
        problem=task.problem.name,
        scheme=task.scheme.name,
        control=task.control.label,
        family=task.control.family,
        increments=history.increments,
        iterations=history.total_iterations,
        umat_calls=history.umat_calls,
        message="" if history.completed else history.message,
        seconds=[history.run_time_s],
    )


def _add_errors(tasks: Sequence[Task], histories: Sequence[History], points: Sequence[Point]) -> None:
    for problem in {task.problem.name: task.problem for task in tasks}.values():
        mine = [n for n, task in enumerate(tasks) if task.problem.name == problem.name]
        times = np.unique(np.concatenate([histories[n].time for n in mine]))
        values = values_for(problem, next(tasks[n].scheme.manifest for n in mine if tasks[n].scheme.general))
        reference = Reference(problem, values, times)
        for n in mine:
            if points[n].completed:
                locked = histories[n].statev[:, tasks[n].scheme.locked_index] >= 0.5
                points[n].errors = problem.errors(histories[n], locked, reference)
                if tasks[n].scheme.spreads_the_lock:
                    points[n].errors.pop("stress", None)
