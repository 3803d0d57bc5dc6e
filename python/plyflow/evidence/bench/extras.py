"""What the report adds to the runs: rounding against quadruple precision, the model's own distance, batch rate."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from plyflow.driver.points import available_threads, call_points
from plyflow.evidence.bench.problems import Problem, Reference
from plyflow.evidence.bench.schemes import Scheme
from plyflow.run.case_run import ORDERS, case_controls
from plyflow.umat.compile import QUAD_FLAGS, compile_umat
from plyflow.umat.library import QuadLibrary, UmatLibrary


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
    quad = QuadLibrary(compile_umat(scheme.source, QUAD_FLAGS))
    run, props, found = scheme.run(problem, case_controls(1.0, scheme.scene["integrator"])), scheme.props(problem), []
    for i in range(1, len(run.time)):
        start, end = run.deformation_gradient[i - 1 : i + 1]
        given = (start, end, float(run.increment[i]), props, run.statev[i - 1])
        have, want = library.call(*given, temperature=problem.case.temperature), quad.call_quad(*given)
        pairs = ((have.stress, want.stress.sum(axis=-1)), (have.ddsdde, want.ddsdde.sum(axis=-1)))
        found.append([np.max(np.abs(double - exact)) / np.max(np.abs(exact)) for double, exact in pairs])
    stress, ddsdde = ((float(np.median(column)), float(max(column))) for column in zip(*found, strict=True))
    return Rounding(len(found), stress, ddsdde)


def model_distance(problem: Problem, scheme: Scheme, values: dict[str, float], refinement: float = 16.0) -> float:
    """Relative distance of the final thickness from the one-dimensional law at vanishing increments.

    Richardson extrapolation by the scheme's order of two fine runs: what elasticity and the penalty leave.
    """
    integrator, ends = scheme.scene["integrator"], []
    for fine in (refinement, 2.0 * refinement):
        run = scheme.run(problem, case_controls(fine, integrator))
        exact = Reference(problem, values, run.time).thickness(run.time[-1:])[0]
        ends.append(float(run.deformation_gradient[-1, 2, 2] / exact) - 1.0)
    return ends[1] + (ends[1] - ends[0]) / (2.0 ** ORDERS[integrator] - 1.0)


def batch_rates(scheme: Scheme, props: Sequence[float], points: int, repeats: int) -> dict[int, list[float]]:
    """Calls per second of the batch entry on 1, 2, ... threads up to the cores, in turns; a random state each point.

    Seconds of the clock on the wall, because several threads share the work; the first turn only warms up.
    """
    generator = np.random.default_rng(11)
    start = np.diag([1.001, 1.02, 0.98]) + 0.003 * generator.normal(size=(points, 3, 3))
    end = start + 0.002 * generator.normal(size=(points, 3, 3))
    state = np.zeros((points, len(scheme.manifest["statev"])))
    rates: dict[int, list[float]] = {n: [] for n in range(1, min(available_threads(), 4) + 1)}
    for _ in range(repeats + 1):
        for n, found in rates.items():
            begin = time.perf_counter()
            call_points(scheme.library, props, start, end, 0.1, state, threads=n)
            found.append(points / (time.perf_counter() - begin))
    return {n: found[1:] for n, found in rates.items()}
