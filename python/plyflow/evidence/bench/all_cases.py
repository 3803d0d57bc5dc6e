"""Increments that an accuracy takes in every case of both programmes, not only in the chosen ones."""

from __future__ import annotations

import statistics
from dataclasses import dataclass

import numpy as np

from plyflow.case.case import all_cases
from plyflow.evidence.bench.accuracy import TARGET
from plyflow.evidence.bench.problems import Problem, Reference, values_for
from plyflow.evidence.bench.schemes import Scheme
from plyflow.show.progress import Advance

LOADS, FAMILIES = ("ramp-dwell", "monotonic"), ("largest", "jump")
WANTED_MEDIAN, WANTED_WORST = 25, 60


@dataclass(frozen=True)
class CaseCounts:
    """Least increments and UMAT calls for `TARGET` in final thickness by case; cases in which no control reached it."""

    increments: dict[str, int]
    umat_calls: dict[str, int]
    missed: list[str]

    def line(self) -> str:
        """Median and worst against what is wanted."""
        counts = sorted(self.increments.values())
        median, worst = statistics.median(counts), counts[-1]
        met = not self.missed and median <= WANTED_MEDIAN and worst <= WANTED_WORST
        return (
            f"increments over {len(counts)} cases of both programmes, best of the controls: median {median:g} (target "
            f"{WANTED_MEDIAN}), worst {worst} (target {WANTED_WORST}), not reached in {len(self.missed)}: {'met' if met else 'missed'}"
        )


def count_cases(scheme: Scheme, every: int, advance: Advance) -> CaseCounts:
    """Run every n-th case of both programmes with all levels of the families with few increments."""
    found = CaseCounts({}, {}, [])
    for case in [case for load in LOADS for case in all_cases(load)[::every]]:
        problem = Problem("", case)
        values = values_for(problem, scheme.manifest)
        exact = Reference(problem, values, np.array([case.load_programme.end])).thickness(np.array([case.load_programme.end]))[0]
        runs = [scheme.run(problem, one.controls) for one in problem.step_controls(newton=scheme.newton) if one.family in FAMILIES]
        good = [run for run in runs if run.completed and abs(run.deformation_gradient[-1, 2, 2] / exact - 1.0) <= TARGET]
        advance(case.label)
        if good:
            found.increments[case.label] = min(run.increments for run in good)
            found.umat_calls[case.label] = min(run.umat_calls for run in good)
        else:
            found.missed.append(case.label)
    return found
