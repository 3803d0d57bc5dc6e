"""What the report adds to the runs: rounding against quadruple precision, the model's own distance, batch rate."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from plyflow.driver.drive import drive
from plyflow.driver.points import available_threads, call_points
from plyflow.evidence.bench.problems import Problem, Reference
from plyflow.evidence.bench.schemes import Scheme
from plyflow.run.case_run import case_controls
from plyflow.umat.compile import QUAD_FLAGS, compile_umat, generate_cached
from plyflow.umat.library import QuadLibrary, UmatLibrary
from umatgen.scene import SCENES


@dataclass(frozen=True)
class Rounding:
    """Relative distance of the double-precision stress and DDSDDE from quadruple precision along a run: median, worst."""

    increments: int
    stress: tuple[float, float]
    ddsdde: tuple[float, float]


def rounding(problem: Problem, scheme: Scheme) -> Rounding:
    """Repeat every increment of a run in both precisions, from the same start."""
    library = scheme.library
    assert isinstance(library, UmatLibrary)
    quad = QuadLibrary(compile_umat(generate_cached(SCENES[scheme.name])[0], QUAD_FLAGS))
    props = scheme.props(problem)
    run = drive(library, props, len(scheme.manifest["statev"]), problem.steps(), case_controls(),
                temperature=problem.case.temperature)  # fmt: skip
    gradients, found = run.deformation_gradient, []
    for i in range(1, len(run.time)):
        given = (gradients[i - 1], gradients[i], float(run.increment[i]), props, run.statev[i - 1])
        have, want = library.call(*given, temperature=problem.case.temperature), quad.call_quad(*given)
        stress, tangent = want.stress.sum(axis=-1), want.ddsdde.sum(axis=-1)
        found.append(
            (np.max(np.abs(have.stress - stress)) / np.max(np.abs(stress)),
             np.max(np.abs(have.ddsdde - tangent)) / np.max(np.abs(tangent)))
        )  # fmt: skip
    table = np.array(found)
    median, worst = np.median(table, axis=0), np.max(table, axis=0)
    return Rounding(len(table), (float(median[0]), float(worst[0])), (float(median[1]), float(worst[1])))


def model_distance(problem: Problem, scheme: Scheme, values: dict[str, float], refinement: float = 40.0) -> float:
    """Relative distance of the final thickness from the one-dimensional law at vanishing increments.

    Richardson extrapolation (first order) of two fine runs: what elasticity and the penalty leave.
    """
    ends = []
    for fine in (refinement, 2.0 * refinement):
        run = drive(scheme.library, scheme.props(problem), len(scheme.manifest["statev"]), problem.steps(),
                    case_controls(fine), temperature=problem.case.temperature)  # fmt: skip
        exact = Reference(problem, values, run.time).thickness(run.time[-1:])[0]
        ends.append(float(run.deformation_gradient[-1, 2, 2] / exact) - 1.0)
    return 2.0 * ends[1] - ends[0]


def batch_rates(scheme: Scheme, props: Sequence[float], points: int, repeats: int) -> dict[int, list[float]]:
    """Calls per second of the batch entry on 1, 2, ... threads up to the cores, in turns; a random state each point."""
    generator = np.random.default_rng(11)
    start = np.diag([1.001, 1.02, 0.98]) + 0.003 * generator.normal(size=(points, 3, 3))
    end = start + 0.002 * generator.normal(size=(points, 3, 3))
    state = np.zeros((points, len(scheme.manifest["statev"])))
    threads = range(1, min(available_threads(), 4) + 1)
    rates: dict[int, list[float]] = {n: [] for n in threads}
    for _ in range(repeats + 1):
        for n in threads:
            begin = time.perf_counter()
            call_points(scheme.library, props, start, end, 0.1, state, threads=n)
            rates[n].append(points / (time.perf_counter() - begin))
    return {n: found[1:] for n, found in rates.items()}


def middle(values: Sequence[float]) -> tuple[float, float]:
    """Median and half the interquartile range."""
    ordered = sorted(values)
    quarter = len(ordered) // 4
    return statistics.median(ordered), (ordered[-1 - quarter] - ordered[quarter]) / 2
