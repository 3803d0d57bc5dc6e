"""The runs: every problem, scheme and step control, repeated in turns so that a slow moment hits all alike."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import product
from typing import Any

import numpy as np

from plyflow.driver.drive import History
from plyflow.errors import InputError
from plyflow.evidence.bench.problems import Control, Problem, Reference, values_for
from plyflow.evidence.bench.schemes import Scheme
from plyflow.evidence.bench.spread import Spread, spread_of
from plyflow.show.progress import Advance

SLOW_LEVELS = ("largest 120", "largest 20", "equal 30")
BEST_OF = 3  # runs in a row of which a turn takes the best, because a busy machine only ever adds, to processor time too


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
        """Processor time in s over the repeats."""
        return spread_of(self.seconds)

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON."""
        return vars(self) | {"seconds_median": self.time.median, "seconds_spread": self.time.relative}


Task = tuple[Problem, Scheme, Control]


def tasks_of(problems: Sequence[Problem], schemes: Sequence[Scheme]) -> list[Task]:
    """Every combination that makes sense; a scene with baked constants runs its own case only."""
    found: list[Task] = []
    for problem, scheme in product(problems, schemes):
        with suppress(InputError):
            scheme.props(problem)
            found += [(problem, scheme, control) for control in problem.step_controls(newton=scheme.newton, **scheme.more)
                      if not scheme.slow or control.label in SLOW_LEVELS]  # fmt: skip
    return found


def measure(tasks: Sequence[Task], repeats: int, slow_repeats: int, advance: Advance) -> list[Point]:
    """Run all tasks once for the errors (the runs are deterministic), then `repeats` times in turns for the times.

    Slow schemes run `slow_repeats` times in all, runs that stopped once.
    """
    histories, points = [], []
    for problem, scheme, control in tasks:
        history = scheme.run(problem, control.controls)
        histories.append(history)
        points.append(Point(
            problem.name, scheme.name, control.label, control.family, history.increments, history.total_iterations,
            history.umat_calls, "" if history.completed else history.message,
            seconds=[history.run_time_s] if scheme.slow or not history.completed else [],
        ))  # fmt: skip
        advance(scheme.name)
    _add_errors(list(zip(tasks, histories, points, strict=True)))
    for number in range(repeats):
        for (problem, scheme, control), point in zip(tasks, points, strict=True):
            runs = BEST_OF if not scheme.slow else 1 if number + 1 < slow_repeats else 0
            if point.completed and runs:
                point.seconds.append(min(scheme.run(problem, control.controls).run_time_s for _ in range(runs)))
            advance(scheme.name)
    return points


def _add_errors(runs: Sequence[tuple[Task, History, Point]]) -> None:
    for problem in {task[0].name: task[0] for task, _, _ in runs}.values():
        mine = [(scheme, history, point) for (own, scheme, _), history, point in runs if own.name == problem.name]
        values = values_for(problem, next(scheme.manifest for scheme, _, _ in mine if scheme.general))
        reference = Reference(problem, values, np.concatenate([history.time for _, history, _ in mine]))
        for scheme, history, point in mine:
            if point.completed:
                point.errors = problem.errors(history, history.statev[:, scheme.locked_index] >= 0.5, reference)
