"""A laminate under the plate from the first to the last second of its load: increments, history, what is kept on the way."""

from __future__ import annotations

import hashlib
import io
import json
import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from plyflow.case.case import state_place
from plyflow.errors import InputError, RunError
from plyflow.files import write_files
from plyflow.hosts.laminate.element import Array
from plyflow.hosts.laminate.equilibrium import SLOW, Equilibrium, State

CHECKPOINT = "checkpoint.npz"
EVERY = 10.0  # s of the clock between checkpoints
FIRST, LARGEST, SMALLEST = 0.05, 100.0, 1e-9  # s
DEPTH = 0.25  # strain of the stack in an increment over the lock strain; friction decides the widths on the way there
# Share of that strain that is tried, by the failures so far: a point that an increment ends at may be passed by a larger one.
TRIES = (1.0, 1.0 / 3.0, 2.0, 1.0 / 9.0, 3.0, 1.0 / 27.0, 1.5, 1.0 / 81.0, 0.7, 1.0 / 243.0)
GROWTH, LOCKED = 2.0, 1.5  # increments grow by; that and the first of a piece by so much more where all is locked
EASY = 9  # iterations up to which the next increment may be longer by that
Told = Callable[[float, int, float], None]


@dataclass
class Course:
    """How a run went so far.

    Parameters
    ----------
    rows : list of (4 + blocks) numbers: time s, thickness ratio, locked share of the points, plate work N mm, widths.
    increments, iterations, rejections : counts; shortened : increments repeated because they went too far; reasons :
        rejections by reason; cpu : s.
    first_lock, last_lock : times [s] at the end of the increments in which the first and the last point locked.
    rubbed : work done on the plates by friction, N mm.
    piece, increment, dt : piece of the load, increments in it, longest length [s] of the next one.
    failed : increments in a row that failed.
    """

    rows: list[list[float]] = field(default_factory=list)
    increments: int = 0
    shortened: int = 0
    iterations: int = 0
    rejections: int = 0
    reasons: dict[str, int] = field(default_factory=dict)
    cpu: float = 0.0
    rubbed: float = 0.0
    first_lock: float | None = None
    last_lock: float | None = None
    piece: int = 0
    increment: int = 0
    dt: float = 0.0
    failed: int = 0

    @property
    def table(self) -> Array:
        """(increments + 1, 4 + blocks) the rows."""
        return np.array(self.rows)


class LaminateRun:
    """A specimen on its way through the load; `states` keeps what the VTU series shows, one state a piece of the load.

    Parameters
    ----------
    model : Equilibrium
        The specimen with its equations.
    folder : Path or None
        Where the checkpoint is kept; a run with the same inputs found there goes on.
    refine : float
        Factor by which all increments are shorter.

    Raises
    ------
    InputError
        The checkpoint belongs to another run.
    """

    def __init__(self, model: Equilibrium, folder: Path | None = None, refine: float = 1.0) -> None:
        self.model, self.folder, self.refine = model, folder, refine
        self._kept = time.monotonic()
        self.state, self.course, self.states = model.start(), Course(), [model.start()]
        self._locked, self._width = (state_place(model.umat.manifest, name) for name in ("locked", "width"))
        self.lock_strain = model.values["eps_lock"]
        self.height = len(model.specimen.angles) * model.specimen.case.block_thickness
        self.course.rows.append(self._row(0.0))
        if folder is not None and (folder / CHECKPOINT).is_file():
            self._resume(folder / CHECKPOINT)

    def finish(self, tell: Told = lambda time, increment, locked: None) -> None:
        """Go on to the end of the load; `tell` hears time [s], increments and locked share after each increment.

        Raises
        ------
        RunError
            No increment is short enough; what is reached stays in the checkpoint.
        """
        pieces = list(self.model.specimen.case.load_programme.pieces())
        for begin, end, _, _ in pieces[self.course.piece :]:
            if not self.course.increment:
                first = min(FIRST * max(1.0, (end - begin) / 12.0), (end - begin) / 4.0)
                self.course.dt = first * self._longer / self.refine
            while self.state.time < end:
                self._advance(end)
                if time.monotonic() - self._kept > EVERY:
                    self._keep()
                tell(self.state.time, self.course.increments, self.course.rows[-1][2])
            self.course.piece, self.course.increment = self.course.piece + 1, 0
            self.states.append(self.state)
            self._keep()

    def _advance(self, end: float) -> None:
        course = self.course
        clock = time.process_time()
        reached, iterations, deep = self._next(end)
        course.cpu += time.process_time() - clock
        course.iterations += iterations
        if isinstance(reached, str):
            course.rejections += 1
            course.reasons[reached] = course.reasons.get(reached, 0) + 1
            course.failed += 1
            course.dt /= 1.0 if deep else 4.0
            if course.dt < SMALLEST or (course.failed == len(TRIES) and deep):
                course.failed, course.dt = 0, max(course.dt, 4.0 * SMALLEST)
                self._keep()
                raise RunError(self._stuck(reached))
            return
        share = float(self.state.unknowns[-1] - reached.unknowns[-1]) / self._depth
        if not deep and share > 2.0 and course.rows[-1][2] < 1.0:
            course.shortened += 1
            course.dt = reached.length / min(share, 4.0)
            return
        if math.isclose(reached.time, end, rel_tol=1e-9):
            reached = replace(reached, time=end)
        self._accept(reached)
        course.failed = 0
        if not deep:
            growth = (GROWTH * self._longer) ** (1.0 / self.refine) if iterations <= EASY else 1.2
            course.dt = min(reached.length * growth, LARGEST / self.refine)

    def _accept(self, reached: State) -> None:
        course, state = self.course, self.state
        moved = float(state.unknowns[-1] - reached.unknowns[-1])
        work = 0.5 * (self._force(reached.time) + self._force(state.time)) * moved
        course.rubbed += self.model.rubbed(state, reached)
        self.state = reached
        course.increments, course.increment = course.increments + 1, course.increment + 1
        course.rows.append(self._row(course.rows[-1][3] + work))
        locked = course.rows[-1][2]
        course.first_lock = reached.time if locked > 0.0 and course.first_lock is None else course.first_lock
        course.last_lock = reached.time if locked == 1.0 and course.last_lock is None else course.last_lock

    def _force(self, at: float) -> float:
        specimen = self.model.specimen
        return float(specimen.case.load_programme.pressure(at)) * specimen.case.width**2 * specimen.share

    @property
    def _depth(self) -> float:
        """Way of the plate wanted in an increment, mm."""
        return DEPTH * abs(self.lock_strain) * (self.height + float(self.state.unknowns[-1])) / self.refine

    @property
    def _longer(self) -> float:
        return LOCKED if self.course.rows[-1][2] == 1.0 else 1.0

    def _next(self, end: float) -> tuple[State | str, int, bool]:
        """The next state; the iterations; whether the increment was as deep as wanted rather than as long.

        Where plies snap at the lock they do so in no time: no length is short enough, but each way of the plate has one.
        """
        state, course = self.state, self.course
        depth, left, spent = self._depth * TRIES[course.failed % len(TRIES)], end - state.time, 0
        guess = state.length * depth / -float(state.moved[-1]) if state.length else FIRST / 10.0

        def load(length: float) -> float:
            return self._force(state.time + length)

        if 0.0 < guess < (left if course.rows[-1][2] < 1.0 else min(left, course.dt)):
            reached, spent = self.model.advance(state, guess, load, course.increment + 1, depth, 1e3 * left)
            if reached != SLOW and (isinstance(reached, str) or reached.time <= end):
                return reached, spent, True
        dt = left if left <= 1.2 * course.dt else course.dt
        reached, iterations = self.model.advance(state, dt, load, course.increment + 1)
        return reached, spent + iterations, False

    def _row(self, work: float) -> list[float]:
        state = self.state
        thickness = 1.0 + float(state.unknowns[-1]) / self.height
        widths = self.model.of_blocks(state.statev[:, self._width]).mean(axis=1)
        widths = np.where(widths > 0.0, widths, 1.0)
        locked = float((self.model.of_blocks(state.statev[:, self._locked]) >= 0.5).mean())
        return [state.time, thickness, locked, work, *map(float, widths)]

    def _stuck(self, reason: str) -> str:
        kept = "" if self.folder is None else f"; what is reached is kept in {self.folder / CHECKPOINT}, the same command goes on"
        specimen = self.model.specimen
        return f"{specimen.case.label}: stopped at {self.state.time:g} s of {specimen.case.load_programme.end:g} s: {reason}{kept}"

    @property
    def identity(self) -> str:
        """Hash of everything that the course of the run depends on."""
        specimen, umat = self.model.specimen, self.model.umat
        case, model = specimen.case, self.model
        known: list[Any] = [specimen.angles, specimen.cells, specimen.arms, model.coefficient, model.props.tolist(), self.refine]
        known += [umat.provenance.as_dict(), case.temperature, case.width, list(case.load_programme.pieces())]
        return hashlib.sha256(json.dumps(known, default=str).encode()).hexdigest()

    def _keep(self) -> None:
        if self.folder is None:
            return
        self._kept = time.monotonic()
        stream = io.BytesIO()
        states = {f"state{i}_{n}": v for i, s in enumerate([self.state, *self.states]) for n, v in vars(s).items()}
        np.savez_compressed(stream, identity=self.identity, course=json.dumps(asdict(self.course)), **states)
        write_files(self.folder, {CHECKPOINT: stream.getvalue()})

    def _resume(self, path: Path) -> None:
        try:
            with np.load(path) as kept:
                data: dict[str, Any] = dict(kept)
        except (OSError, ValueError) as error:
            raise InputError(f"{path} is no checkpoint: {error}; remove it or choose another folder") from error
        if str(data["identity"]) != self.identity:
            raise InputError(f"{path} belongs to another run; choose another folder, or remove it")
        self.course = Course(**json.loads(str(data["course"])))
        count = sum(name.endswith("_time") for name in data)
        states = [State(**{f.name: data[f"state{i}_{f.name}"] for f in fields(State)}) for i in range(count)]
        self.state, self.states = states[0], states[1:]
