"""Equilibrium of a specimen at the end of an increment: Newton's method with a damping that is blind to units."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import felupe
import numpy as np

from plyflow.case.case import property_values, props_vector
from plyflow.driver.points import BatchResult, call_points
from plyflow.errors import InputError
from plyflow.hosts.laminate.assembly import Assembly, factorised
from plyflow.hosts.laminate.element import Array, Forces, Kinematics, deform, forces, stiffness
from plyflow.hosts.laminate.specimen import Specimen
from plyflow.umat.prepare import Umat

SLIP = 1e-3  # elastic slip of a sticking plate over the width of the specimen
TOLERANCE = 1e-5  # force left at a node over the mean one at the peak of the load
KAPPA = 1000.0  # MPa, 10,000 times the pressure of the paper's plates: the penalty of a whole mesh need not be that of a point
ITERATIONS, DAMPINGS = 20, 8
LONGER = 1e-4  # change of the logarithm of an increment's length for the derivative by it
SLOW = "slower than wanted"
FARTHEST = 4.0  # largest change of that logarithm in an iteration
Load = Callable[[float], float]  # force [N] of the plate at the end of an increment, by its length [s]


@dataclass(frozen=True)
class State:
    """A specimen at a time.

    Parameters
    ----------
    time : s; unknowns : (n,) displacements, mm, the last one the plate's; moved : (n,) what the last increment added to
        them; length : of that increment, s.
    gradient : (p, 3, 3), statev : (p, s), stress : (p, 6) MPa, energies : (p, 3) MPa at the points, in the ply frames.
    friction : (2 m, 2) force of the plates on the m nodes of the lower and of the upper face, N.
    normal : (2 m,) normal forces there under a plate force of 1.
    """

    time: float
    unknowns: Array
    moved: Array
    length: float
    gradient: Array
    statev: Array
    stress: Array
    energies: Array
    friction: Array
    normal: Array


@dataclass(frozen=True)
class Trial:
    """What a trial of the unknowns gives: forces left (n,) [N], points, plate forces, their derivatives, element forces."""

    residual: Array
    at: Kinematics
    points: BatchResult
    friction: Array
    softened: Array
    normal: Array
    inner: Forces


Solve = Callable[[Array], tuple[Array, float]]  # step (n,) [mm] and change of ln dt that forces left (n,) [N] ask for


class Equilibrium:
    """Equations of a specimen with the UMAT at all its points and Coulomb friction (coefficient) at the plates.

    Raises
    ------
    InputError
        Friction below 0, a scene of another stress state, a load that never presses, a setting without meaning.
    """

    def __init__(self, specimen: Specimen, umat: Umat, friction: float) -> None:
        if not (math.isfinite(friction) and friction >= 0.0):
            raise InputError(f"--friction {friction:g}: a coefficient of friction is a finite number of at least 0")
        if umat.manifest["scene"]["stress_state"] != "3d":
            raise InputError(f"scene {umat.manifest['scene']['name']} is not for solids; a laminate needs one in 3D")
        if not specimen.case.load_programme.peak > 0.0:
            raise InputError(f"{specimen.case.load}: the load never presses; a laminate between plates needs a force above 0")
        self.specimen, self.umat, self.coefficient = specimen, umat, friction
        self.values = property_values(specimen.case, umat.manifest)
        if "kappa" in self.values and "kappa" not in specimen.case.settings:
            self.values["kappa"] = KAPPA
        self.props = np.array(props_vector(self.values, umat.manifest))
        region = felupe.RegionHexahedron(specimen.mesh)
        self.frames = specimen.frames
        self.slopes = np.einsum("ajqc,cjk->cqak", region.dhdX, self.frames)
        self.volumes = np.ascontiguousarray(region.dV.T)
        self.owner = specimen.unknowns(friction > 0.0)
        self.cells = specimen.mesh.cells
        self._places = (3 * self.cells[:, :, None] + np.arange(3)).reshape(len(self.cells), 24)
        self.tool = np.concatenate([specimen.faces(0)[0], specimen.faces(len(specimen.angles) - 1)[1]])
        rubbing = 3 * self.tool[:, None] + np.arange(2)
        self._assembly = Assembly(self.owner, self.unknowns, [self._places, rubbing])
        self._up = np.repeat([1.0, -1.0], specimen.nodes)
        self.peak = specimen.case.load_programme.peak * specimen.case.width**2 * specimen.share
        self._stick = self.coefficient * self.peak / specimen.nodes / (SLIP * specimen.case.width)

    @property
    def unknowns(self) -> int:
        """Number of unknowns."""
        return int(self.owner.max()) + 1

    def start(self) -> State:
        """The specimen before the test; `moved` is the motion of a stack without friction, of arbitrary size."""
        p, n = self.volumes.size, self.unknowns
        statev = np.zeros((p, len(self.umat.manifest["statev"])))
        gradient = np.broadcast_to(np.eye(3), (p, 3, 3)).copy()
        friction = np.zeros((len(self.tool), 2))
        stress, energies = np.zeros((p, 6)), np.zeros((p, 3))
        moved = self._widening()
        return State(0.0, np.zeros(n), moved, 0.0, gradient, statev, stress, energies, friction, self._areas())

    def _areas(self) -> Array:
        """(2 m,) share of each node in the area of its plate."""
        n = round(self.specimen.nodes**0.5)
        along = np.full(n, 1.0 / (n - 1))
        along[[0, -1]] /= 2.0
        return np.tile(np.outer(along, along).ravel(), 2)

    def _widening(self) -> Array:
        """(n,) small motion of a stack that keeps the volume and the length of its fibres."""
        moved = np.zeros((len(self.owner) // 3, 3))
        points, cells = self.specimen.mesh.points, self.cells
        frames = self.frames[:, :, 1:]
        rate = np.einsum("cik,k,cjk->cij", frames, [1.0, -1.0], frames)
        moved[cells] = np.einsum("cij,caj->cai", 1e-3 * rate, points[cells])
        unknowns = np.zeros(self.unknowns)
        unknowns[self.owner[self.owner >= 0]] = moved.ravel()[self.owner >= 0]
        return unknowns

    def trial(
        self, state: State, unknowns: Array, dt: float, force: float, increment: int, expected: Array | None = None
    ) -> Trial | str:
        """Forces left where the unknowns are tried at the end of an increment; or why the UMAT refuses them."""
        at = deform(self.slopes, self.volumes, self._own(unknowns))
        if at is None:
            return "an element is turned inside out"
        points = call_points(
            self.umat.library, self.props, state.gradient, at.gradient.reshape(-1, 3, 3), dt, state.statev, state.stress,
            energies=state.energies, temperature=self.specimen.case.temperature, time=(state.time, state.time),
            increment=increment,
        )  # fmt: skip
        if points.failed.size:
            first = int(points.failed[0])
            return f"{points.outcome[first]} at a point: {points.messages.get(first, 'no words')}"
        inner = forces(at, points.stress.reshape(*self.volumes.shape, 6), expected)
        whole = self._nodal(inner.force)
        held, softened = self._rub(state.friction, self._slip(state, unknowns), state.normal * force)
        whole.reshape(-1, 3)[self.tool, :2] += held
        normal = state.normal  # of a plate force of 1
        if force > 0.0:
            normal = np.maximum(self._up * whole.reshape(-1, 3)[self.tool, 2], 0.0) / force
        residual = self._gathered(whole)
        residual[-1] += force
        return Trial(residual, at, points, held, softened, normal, inner)

    def stiffness(self, trial: Trial) -> tuple[Any, Array]:
        """Derivatives of the forces left (n, n) [N/mm] and of the mean stress times volume of each element (c, 24) [N]."""
        c, q = self.volumes.shape
        stiff, mean_slopes = stiffness(trial.at, trial.inner, trial.points.ddsdde.reshape(c, q, 6, 6))
        turn = self.frames[:, None]
        blocks = (turn @ stiff.reshape(c, 8, 3, 24)).reshape(c, 24, 8, 3) @ turn.transpose(0, 1, 3, 2)
        return self._assembly.matrix([blocks.reshape(c, 24, 24), trial.softened]), mean_slopes

    def rubbed(self, before: State, after: State) -> float:
        """Work [N mm] against the friction of the plates between two states."""
        slip = self._slip(before, after.unknowns)
        return float(np.sum(0.5 * (before.friction + after.friction) * slip))

    def of_blocks(self, values: Array) -> Array:
        """(blocks, points) values of the points between the plates, out of those (p,) of all."""
        blocks, q = len(self.specimen.angles), self.volumes.shape[1]
        return values[: blocks * self.specimen.columns * q].reshape(blocks, -1)

    def displacement(self, unknowns: Array) -> Array:
        """(nodes, 3) displacements [mm] of the nodes."""
        return np.asarray(np.append(unknowns, 0.0)[self.owner].reshape(-1, 3))

    def _pressed(self, state: State) -> Array:
        """(c,) mean stress times volume of the elements, N mm."""
        mean = state.stress[:, :3].sum(axis=1) / 3.0 * np.linalg.det(state.gradient)
        return np.asarray((mean.reshape(self.volumes.shape) * self.volumes).sum(axis=1))

    def _slip(self, state: State, unknowns: Array) -> Array:
        return self.displacement(unknowns - state.unknowns)[self.tool, :2]

    def _gathered(self, forces: Array) -> Array:
        """Forces (n,) on the unknowns of forces (3 nodes,) on the nodes."""
        return np.asarray(np.bincount(self.owner + 1, forces, self.unknowns + 1)[1:], dtype=float)

    def _nodal(self, force: Array) -> Array:
        """Forces (c, 24) of the elements in their ply frames as forces (3 nodes,) of the nodes."""
        turned = force.reshape(-1, 8, 3) @ self.frames.transpose(0, 2, 1)
        return np.asarray(np.bincount(self._places.ravel(), turned.ravel(), 3 * self.specimen.mesh.npoints), dtype=float)

    def _own(self, unknowns: Array) -> Array:
        """Displacements (c, 8, 3) of the nodes of the elements in their ply frames."""
        return np.asarray(self.displacement(unknowns)[self.cells] @ self.frames)

    def _rub(self, last: Array, slip: Array, normal: Array) -> tuple[Array, Array]:
        """Friction (2 m, 2) [N] after a slip [mm] under normal forces [N], elastic up to Coulomb's bound; its derivatives."""
        bound = self.coefficient * normal
        held = last + self._stick * slip
        size = np.hypot(*held.T)
        slides = size > bound
        way = held / np.where(size > 0.0, size, 1.0)[:, None]
        softened = np.where(slides, self._stick * bound / np.where(slides, size, 1.0), self._stick)
        held = np.where(slides[:, None], bound[:, None] * way, held)
        own = softened[:, None, None] * (np.eye(2) - slides[:, None, None] * way[:, :, None] * way[:, None, :])
        return held, own

    def advance(
        self, state: State, dt: float, load: Load, increment: int, depth: float = 0.0, longest: float = math.inf
    ) -> tuple[State | str, int]:
        """The state after an increment that ends in equilibrium; or why there is none; and the iterations.

        Parameters
        ----------
        dt : length of the increment, s.
        load : plate force at its end, by its length.
        depth : where above 0, way of the plate, mm; the length is then what the force needs for it, dt the first guess.
        longest : length [s] at which the search for it ends with `SLOW`.
        """
        unknowns, bound = state.unknowns, TOLERANCE * self.peak / self.specimen.nodes
        if depth:
            unknowns = unknowns - depth / state.moved[-1] * state.moved
        trial = self.trial(state, unknowns, dt, load(dt), increment, self._pressed(state) if depth else None)
        for iteration in range(1, ITERATIONS + 1):
            if isinstance(trial, str):
                return trial, iteration
            if dt > longest:
                return SLOW, iteration
            if np.abs(trial.residual).max() <= bound:
                return self._reached(state, unknowns, trial, dt), iteration
            stiff, mean_slopes = self.stiffness(trial)
            solve = self._border(state, unknowns, dt, load, increment, trial, stiff) if depth else _plain(stiff)
            step, longer = solve(trial.residual)
            size, old = math.hypot(np.linalg.norm(step), depth * longer), trial.inner
            share = min(1.0, FARTHEST / abs(longer)) if longer else 1.0
            foreseen = old.mean + np.einsum("cn,cn->c", mean_slopes, self._own(step).reshape(-1, 24)) - old.expected
            for _ in range(DAMPINGS):
                length = dt * math.exp(share * longer)
                expected = old.expected + share * foreseen
                tried = self.trial(state, unknowns + share * step, length, load(length), increment, expected)
                if not isinstance(tried, str):
                    missed = (tried.inner.mean - tried.inner.expected)[:, None] * (tried.inner.spread - old.spread)
                    left, longer_left = solve(tried.residual - self._gathered(self._nodal(missed)))
                    if math.hypot(np.linalg.norm(left), depth * longer_left) <= size:
                        break
                share /= 3.0
            else:
                return "no damped step makes the correction smaller", iteration
            unknowns, dt, trial = unknowns + share * step, length, tried
        return f"not converged after {ITERATIONS} iterations", ITERATIONS

    def _border(
        self, state: State, unknowns: Array, dt: float, load: Load, increment: int, trial: Trial, stiff: Any
    ) -> Solve:
        """Solve for the displacements at a given place of the plate and the logarithm of the increment's length."""
        later = dt * math.exp(LONGER)
        beside = self.trial(state, unknowns, later, load(later), increment)
        slope = np.zeros(self.unknowns) if isinstance(beside, str) else (beside.residual - trial.residual) / LONGER
        inner, border = factorised(stiff[:-1, :-1]), stiff[-1, :-1].toarray().ravel()
        along = inner(-slope[:-1])
        whole = float(slope[-1] + border @ along)

        def solve(residual: Array) -> tuple[Array, float]:
            step = inner(-residual[:-1])
            longer = -float(residual[-1] + border @ step) / whole if whole else 0.0
            return np.append(step + longer * along, 0.0), longer

        return solve

    def _reached(self, state: State, unknowns: Array, trial: Trial, dt: float) -> State:
        points, gradient = trial.points, trial.at.gradient.reshape(-1, 3, 3)
        return State(
            state.time + dt, unknowns, unknowns - state.unknowns, dt, gradient, points.statev, points.stress, points.energies,
            trial.friction, trial.normal,
        )  # fmt: skip


def _plain(stiff: Any) -> Solve:
    """Solve for the displacements."""
    inner = factorised(stiff)
    return lambda residual: (inner(-residual), 0.0)
