"""Equilibrium of a specimen at the end of an increment: Newton's method with a damping that is blind to units."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import felupe
import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from plyflow.case.case import property_values, props_vector
from plyflow.driver.points import BatchResult, call_points
from plyflow.errors import InputError
from plyflow.hosts.laminate.element import Array, Forces, Kinematics, deform, forces
from plyflow.hosts.laminate.specimen import Specimen
from plyflow.umat.prepare import Umat

SLIP = 1e-3  # elastic slip of a sticking plate over the width of the specimen
TOLERANCE = 1e-5  # force left at a node over the mean one at the peak of the load
PIVOT = 1e-3  # the stiffness is unsymmetric, its diagonal good enough to keep the order of elimination
ITERATIONS, DAMPINGS = 20, 8


@dataclass(frozen=True)
class State:
    """A specimen at a time.

    Parameters
    ----------
    time : s; unknowns : (n,) displacements, mm, the last one the plate's;
    gradient : (p, 3, 3), statev : (p, s), stress : (p, 6) MPa, energies : (p, 3) MPa at the points, in the ply frames.
    friction : (2 m, 2) force of the plates on the m nodes of the lower and of the upper face, N.
    """

    time: float
    unknowns: Array
    gradient: Array
    statev: Array
    stress: Array
    energies: Array
    friction: Array
    normal: Array


@dataclass(frozen=True)
class Trial:
    """What a trial of the unknowns gives: forces left (n,) [N], their derivatives, points, friction."""

    residual: Array
    stiffness: Any
    at: Kinematics
    points: BatchResult
    friction: Array
    normal: Array
    inner: Forces


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
        self.props = np.array(props_vector(property_values(specimen.case, umat.manifest), umat.manifest))
        region = felupe.RegionHexahedron(specimen.mesh)
        self.frames = specimen.frames
        self.slopes = np.einsum("ajqc,cjk->cqak", region.dhdX, self.frames)
        self.volumes = np.ascontiguousarray(region.dV.T)
        self.map = specimen.unknowns(friction > 0.0)
        self.cells = specimen.mesh.cells
        places = (3 * self.cells[:, :, None] + np.arange(3)).reshape(len(self.cells), 24)
        self._rows, self._columns = np.repeat(places, 24, axis=1).ravel(), np.tile(places, (1, 24)).ravel()
        self._places = places
        self.tool = np.concatenate([specimen.faces(0)[0], specimen.faces(len(specimen.angles) - 1)[1]])
        self._up = np.repeat([1.0, -1.0], specimen.nodes)
        self.peak = specimen.case.load_programme.peak * specimen.case.width**2 * specimen.share
        self._stick = self.coefficient * self.peak / specimen.nodes / (SLIP * specimen.case.width)

    def start(self) -> State:
        """The specimen before the test."""
        p, n = self.volumes.size, self.map.shape[1]
        statev = np.zeros((p, len(self.umat.manifest["statev"])))
        gradient = np.broadcast_to(np.eye(3), (p, 3, 3)).copy()
        friction = np.zeros((len(self.tool), 2))
        return State(0.0, np.zeros(n), gradient, statev, np.zeros((p, 6)), np.zeros((p, 3)), friction, self._areas())

    def _areas(self) -> Array:
        """(2 m,) share of each node in the area of its plate."""
        n = round(self.specimen.nodes**0.5)
        along = np.full(n, 1.0 / (n - 1))
        along[[0, -1]] /= 2.0
        return np.tile(np.outer(along, along).ravel(), 2)

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
        c, q = self.volumes.shape
        inner = forces(at, points.stress.reshape(c, q, 6), points.ddsdde.reshape(c, q, 6, 6), expected)
        turn = self.frames[:, None]
        whole = self._nodal(inner.force)
        blocks = inner.stiff.reshape(c, 8, 3, 8, 3).transpose(0, 1, 3, 2, 4).reshape(c, 64, 3, 3)
        blocks = (turn @ blocks @ turn.transpose(0, 1, 3, 2)).reshape(c, 8, 8, 3, 3).transpose(0, 1, 3, 2, 4)
        stiff = sparse.csr_matrix((blocks.ravel(), (self._rows, self._columns)), shape=(whole.size, whole.size))
        held = state.friction
        if self.coefficient:
            slip = (self.map @ (unknowns - state.unknowns)).reshape(-1, 3)[self.tool, :2]
            held, stiff = self._rub(state.friction, slip, state.normal * force, stiff)
            whole.reshape(-1, 3)[self.tool, :2] += held
        normal = np.maximum(self._up * whole.reshape(-1, 3)[self.tool, 2], 0.0) / force
        residual = self.map.T @ whole
        residual[-1] += force
        return Trial(residual, (self.map.T @ stiff @ self.map).tocsc(), at, points, held, normal, inner)

    def rubbed(self, before: State, after: State) -> float:
        """Work [N mm] against the friction of the plates between two states."""
        slip = (self.map @ (after.unknowns - before.unknowns)).reshape(-1, 3)[self.tool, :2]
        return float(np.sum(0.5 * (before.friction + after.friction) * slip))

    def _nodal(self, force: Array) -> Array:
        """Forces (c, 24) of the elements in their ply frames as forces (3 nodes,) of the nodes."""
        turned = force.reshape(-1, 8, 3) @ self.frames.transpose(0, 2, 1)
        return np.asarray(np.bincount(self._places.ravel(), turned.ravel(), 3 * self.specimen.mesh.npoints), dtype=float)

    def _own(self, unknowns: Array) -> Array:
        """Displacements (c, 8, 3) of the nodes of the elements in their ply frames."""
        return np.asarray((self.map @ unknowns).reshape(-1, 3)[self.cells] @ self.frames)

    def _rub(self, last: Array, slip: Array, normal: Array, stiff: Any) -> tuple[Array, Any]:
        """Friction (2 m, 2) [N] after a slip [mm] under normal forces [N]: elastic up to Coulomb's bound; and the stiffness."""
        bound = self.coefficient * normal
        held = last + self._stick * slip
        size = np.hypot(*held.T)
        slides = size > bound
        way = held / np.where(size > 0.0, size, 1.0)[:, None]
        softened = np.where(slides, self._stick * bound / np.where(slides, size, 1.0), self._stick)
        held = np.where(slides[:, None], bound[:, None] * way, held)
        n, places = stiff.shape[0], 3 * self.tool[:, None] + np.arange(2)
        own = softened[:, None, None] * (np.eye(2) - slides[:, None, None] * way[:, :, None] * way[:, None, :])
        rows, columns = np.repeat(places, 2, axis=1), np.tile(places, (1, 2))
        added = sparse.csr_matrix((own.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n))
        return held, stiff + added

    def advance(self, state: State, dt: float, force: float, increment: int) -> tuple[State | str, int]:
        """The state after an increment [s] that ends under a plate force [N]; or why there is none; and the iterations."""
        unknowns, bound = state.unknowns, TOLERANCE * self.peak / self.specimen.nodes
        trial = self.trial(state, unknowns, dt, force, increment)
        for iteration in range(1, ITERATIONS + 1):
            if isinstance(trial, str):
                return trial, iteration
            if np.abs(trial.residual).max() <= bound:
                return self._reached(state, unknowns, trial, dt), iteration
            factor = splu(trial.stiffness, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=PIVOT, options={"SymmetricMode": True})
            step = -factor.solve(trial.residual)
            size, share, old = np.linalg.norm(step), 1.0, trial.inner
            foreseen = old.mean + np.einsum("cn,cn->c", old.mean_slopes, self._own(step).reshape(-1, 24)) - old.expected
            for _ in range(DAMPINGS):
                expected = old.expected + share * foreseen
                tried = self.trial(state, unknowns + share * step, dt, force, increment, expected)
                if not isinstance(tried, str) and self._correction(factor, old, tried) <= size:
                    break
                share /= 3.0
            else:
                return "no damped step makes the correction smaller", iteration
            unknowns, trial = unknowns + share * step, tried
        return f"not converged after {ITERATIONS} iterations", ITERATIONS

    def _correction(self, factor: Any, old: Forces, tried: Trial) -> float:
        """Size of the next correction at the old stiffness, the mean stress of each element an unknown of its own."""
        missed = (tried.inner.mean - tried.inner.expected)[:, None] * (tried.inner.spread - old.spread)
        return float(np.linalg.norm(factor.solve(tried.residual - self.map.T @ self._nodal(missed))))

    def _reached(self, state: State, unknowns: Array, trial: Trial, dt: float) -> State:
        points, gradient = trial.points, trial.at.gradient.reshape(-1, 3, 3)
        return State(
            state.time + dt, unknowns, gradient, points.statev, points.stress, points.energies, trial.friction, trial.normal
        )
