"""Many points at once under the rules of Abaqus: meshes of scattered constants, and points in series.

One point can have an increment to its liking; a model of thousands has one increment for all of them. The iteration is
Abaqus's: plain Newton, EXTRAPOLATION=NO, an attempt given up where any point sets PNEWDT below 1, five attempts. `Rules` is
Abaqus's table of controls (*CONTROLS) with three differences, the same for every run: residuals of 1e-3 of the largest load in
place of 5e-3 of the present forces, a largest increment of 20 s, and no test of the displacement correction. With
`correction=CORRECTION` that test is made as Abaqus makes it.
"""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse.linalg import splu

from plyflow.driver.drive import Library
from plyflow.driver.points import BatchResult, call_points
from plyflow.evidence.stability.plane_mesh import IN_PLANE, Array, Mesh
from plyflow.law import LoadProgramme

CORRECTION = 0.01  # Abaqus's default


@dataclass(frozen=True)
class Rules:
    """Abaqus's controls of increments and iterations, by their names in *CONTROLS.

    Parameters
    ----------
    largest_increment : in s; `first_part` of a step's duration is its first increment, if that is smaller.
    residual, correction : R_n^alpha of the largest load, and C_n^alpha, what the last correction of the displacements (or the
        next one by extrapolation) may be of their increment; infinite: not tested.
    attempts, iterations : IA and IC; `slow_after`, `diverge_after`: IR and I0; `few`, `many`: IG and IL.
    cut, cut_slow, shrink, growth : DF, DC, DB and DD.
    increments : INC of *STEP, of the whole load.
    """

    largest_increment: float = 20.0
    first_part: float = 0.2
    residual: float = 1e-3
    correction: float = math.inf
    attempts: int = 5
    iterations: int = 16
    increments: int = 1000
    diverge_after: int = 4
    slow_after: int = 8
    few: int = 4
    many: int = 10
    cut: float = 0.25
    cut_slow: float = 0.5
    shrink: float = 0.75
    growth: float = 1.5


@dataclass(frozen=True)
class Run:
    """How a run ended.

    Parameters
    ----------
    finished, message : whether the whole load was carried, and if not, why.
    increments, iterations, cutbacks : done; cutbacks by reason: "material" (PNEWDT), "diverging", "slow", "inverted".
    width, thickness : (n,) stretch of every point across, and along the plate's axis, at the end.
    plate : height of the whole over that at the start.
    seconds : of CPU; history : (end [s], size [s], iterations) of every increment.
    """

    finished: bool
    message: str
    increments: int
    iterations: int
    cutbacks: Counter[str]
    width: Array
    thickness: Array
    plate: float
    seconds: float
    history: list[tuple[float, float, int]] = field(default_factory=list)


class _AttemptError(Exception):
    """An attempt is given up: reason and factor of the next one's size."""

    def __init__(self, reason: str, factor: float) -> None:
        super().__init__(reason)
        self.reason, self.factor = reason, factor


class Analysis:
    """A mesh of points of one UMAT under the plate.

    Parameters
    ----------
    library : any compiled UMAT with fibre along 1 and compaction along 3, NTENS = 6.
    mesh : `plyflow.evidence.stability.plane_mesh`.
    props : (n_props,), or (e, n_props) of each element, or (4 e, n_props) of each point.
    n_statev : number of state variables.
    load : pressure over time; its force is that on the length of the mesh before it widens.
    """

    def __init__(
        self, library: Library, mesh: Mesh, props: ArrayLike, n_statev: int, load: LoadProgramme, rules: Rules | None = None
    ) -> None:
        self.library, self.mesh, self.load, self.rules = library, mesh, load, rules or Rules()
        self.count = 4 * len(mesh.elements)
        values = np.atleast_2d(np.asarray(props, dtype=float))
        self.props = np.repeat(values, self.count // len(values), axis=0) if len(values) > 1 else values[0]
        self.place = np.zeros(mesh.ties.shape[1])
        self.statev, self.energies = np.zeros((self.count, n_statev)), np.zeros((self.count, 3))
        self.stress, self.start = np.zeros((self.count, 6)), np.tile(np.eye(3), (self.count, 1, 1))
        self.tolerance = self.rules.residual * load.peak * mesh.length
        self.time, self.cutbacks, self.iterations = 0.0, Counter[str](), 0
        self.history: list[tuple[float, float, int]] = []

    def run(self) -> Run:
        """Carry the whole load, or as much of it as the rules allow."""
        begin, message = time.process_time(), ""
        try:
            for start, end, *_ in self.load.pieces():
                self._step(start, end)
        except _AttemptError as failed:
            message = f"{failed.reason} at {self.time:.6g} s, {self.rules.attempts} attempts"
        ends = self.start[:, 1:, 1:]
        return Run(
            not message, message, len(self.history), self.iterations, self.cutbacks, np.hypot(ends[:, 0, 0], ends[:, 1, 0]),
            np.linalg.det(ends) / np.hypot(ends[:, 0, 0], ends[:, 1, 0]), 1.0 + self.place[self.mesh.plate] / self.mesh.height,
            time.process_time() - begin, self.history,
        )  # fmt: skip

    def _step(self, start: float, end: float) -> None:
        """One straight piece of the load."""
        rules, easy = self.rules, 0
        dt = min(rules.largest_increment, rules.first_part * (end - start))
        while self.time < end:
            if len(self.history) >= rules.increments:
                raise _AttemptError("too many increments", 0.0)
            size = end - self.time if self.time + dt * (1.0 + 1e-6) >= end else dt
            size, iterations = self._increment(size, end)
            easy = easy + 1 if iterations <= rules.few else 0
            factor = rules.growth if easy >= 2 else rules.shrink if iterations > rules.many else 1.0
            dt = min(rules.largest_increment, max(size, dt if size == end - self.time else 0.0) * factor)
            self.time = end if end - self.time - size <= 1e-9 * end else self.time + size

    def _increment(self, size: float, end: float) -> tuple[float, int]:
        """Attempts until one converges: its size and iterations."""
        for attempt in range(self.rules.attempts + 1):
            try:
                return size, self._solve(size)
            except _AttemptError as failed:
                self.cutbacks[failed.reason] += 1
                if attempt == self.rules.attempts or failed.factor <= 0.0:
                    raise
                size *= failed.factor
        raise AssertionError

    def _solve(self, dt: float) -> int:
        """Plain Newton from the last place; the number of its iterations. The state moves on only if it converges."""
        rules, place, sizes, error = self.rules, self.place.copy(), [], np.inf
        outer = np.zeros_like(place)
        outer[self.mesh.plate] = -self.load.pressure(self.time + dt) * self.mesh.length
        for iteration in range(rules.iterations + 1):
            points, ends, inner, slope = self._system(place, dt)
            residual = outer - inner
            sizes.append(float(np.abs(residual).max()))
            if iteration > 0 and sizes[-1] <= self.tolerance:
                moved, last = np.abs(place - self.place).max(), np.abs(error).max()
                ahead = last * sizes[-1] / max(min(sizes[-3:-1]), 1e-300)
                if min(last, ahead) <= rules.correction * moved:
                    self._accept(place, points, ends, dt, iteration)
                    return iteration
            self._judge(sizes)
            error = splu(slope).solve(residual)
            place += error
            self.iterations += 1
        raise _AttemptError("slow", rules.cut_slow)

    def _judge(self, sizes: Sequence[float]) -> None:
        """Give up where the residual grows twice in a row, or falls too slowly to arrive in time."""
        rules, done = self.rules, len(sizes) - 1
        if not np.isfinite(sizes[-1]):
            raise _AttemptError("inverted", rules.cut)
        if done >= rules.diverge_after and sizes[-1] >= sizes[-2] >= sizes[-3]:
            raise _AttemptError("diverging", rules.cut)
        if done >= rules.slow_after and sizes[-1] > self.tolerance:
            pace = np.log(min(sizes[-1] / sizes[-2], 1.0 - 1e-12))
            if done + np.log(self.tolerance / sizes[-1]) / pace > rules.iterations:
                raise _AttemptError("slow", rules.cut_slow)

    def _system(self, place: Array, dt: float) -> tuple[BatchResult, Array, Array, object]:
        """What the points answer, their gradients (n, 3, 3), internal forces and their derivative."""
        plain, averaged = self.mesh.gradients(place)
        ends = np.tile(np.eye(3), (self.count, 1, 1))
        ends[:, 1:, 1:] = averaged.reshape(-1, 2, 2)
        if not (np.isfinite(averaged).all() and (np.linalg.det(plain) > 0.0).all()):
            raise _AttemptError("inverted", self.rules.cut)
        points = call_points(
            self.library, self.props, self.start, ends, dt, self.statev, self.stress, energies=self.energies,
            time=(self.time, self.time), threads=1,
        )  # fmt: skip
        if (points.outcome == "stopped").any():
            raise _AttemptError("stopped", 0.0)
        if len(points.failed):
            reason = "material" if points.pnewdt.min() < 1.0 else "inverted"
            raise _AttemptError(reason, min(points.pnewdt.min(), 1.0) if reason == "material" else self.rules.cut)
        shape = (-1, 4, 3)
        stress = points.stress[:, IN_PLANE].reshape(shape)
        tangent = points.ddsdde[:, IN_PLANE][:, :, IN_PLANE].reshape(*shape, 3)
        return points, ends, *self.mesh.forces(plain, np.linalg.det(averaged[:, 0]), stress, tangent)

    def _accept(self, place: Array, points: BatchResult, ends: Array, dt: float, iterations: int) -> None:
        self.place, self.start = place, ends
        self.stress, self.statev, self.energies = points.stress, points.statev, points.energies
        self.history.append((self.time + dt, dt, iterations))
