"""The account of a whole matrix: every call and every increment is looked at, whatever its cell asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from plyflow.driver.drive import History
from plyflow.evidence.stability.tensors import (
    EPSILON,
    Array,
    compaction_stretch,
    elastic_stress,
    green,
    limit_stretch,
    second_piola,
)
from plyflow.umat.library import CallResult

LIMIT_ROUNDING = 8 * EPSILON
ROUNDING_SHARE = 16 * EPSILON


@dataclass
class Ledger:
    """Counts over a run; an incident is what must never happen.

    calls, increments : answers of the UMAT that were used, and accepted increments of the driver.
    refusals : calls and programmes that were refused, each with a message.
    incidents : one line each: not finite, wrong-sided, dissipation that falls, refusal without a message.
    """

    calls: int = 0
    increments: int = 0
    refusals: int = 0
    incidents: dict[str, list[str]] = field(
        default_factory=lambda: {name: [] for name in ("not finite", "wrong-sided", "unsaid", "uncaught")}
    )

    @property
    def total(self) -> int:
        """Number of incidents."""
        return sum(len(lines) for lines in self.incidents.values())

    def marks(self) -> dict[str, int]:
        """How many incidents of each kind there are, for `lines`."""
        return {kind: len(lines) for kind, lines in self.incidents.items()}

    def lines(self, since: Mapping[str, int] | None = None) -> list[str]:
        """Incidents in the order of their kinds, all or those since some marks."""
        first = since or {}
        return [f"{kind}: {line}" for kind, lines in self.incidents.items() for line in lines[first.get(kind, 0) :]]

    def audit_call(
        self, result: CallResult, ends: tuple[Array, Array], values: Mapping[str, float], before: Array, statev: Array
    ) -> None:
        """Look at one answer of the UMAT; `before` and `statev` are the stress and the state it was given."""
        self.calls += 1
        if result.messages or result.stopped:
            self.refusals += 1
            self._audit_refusal(result, before)
            return
        if not np.isfinite(ends).all():
            self._enter(f"answered F0 = {np.ravel(ends[0])}", ends[1])
            return
        numbers = (result.stress, result.ddsdde, result.statev, [result.sse, result.scd])
        if not all(np.isfinite(part).all() for part in numbers):
            self._enter("answer", ends[1], "not finite")
            return
        with np.errstate(over="ignore", invalid="ignore"):
            stress = second_piola(result.stress, ends[1])
            self._audit_side(stress[None], np.array(ends), np.array([statev, result.statev]), values)
        if result.scd < 0.0:
            self._enter(f"dissipation {result.scd:.3g} MPa", ends[1])

    def audit_history(self, history: History, values: Mapping[str, float]) -> None:
        """Look at every accepted increment of a programme."""
        self.increments += history.increments
        if not history.completed:
            self.refusals += 1
            if not history.message.strip():
                self.incidents["unsaid"].append("a programme ended without a message")
        gradients = history.deformation_gradient
        arrays = (gradients, history.stress, history.statev, history.energies)
        if not all(np.isfinite(part).all() for part in arrays):
            self.incidents["not finite"].append("a state of an accepted increment")
            return
        stress = second_piola(history.stress, gradients) - multiplier_stress(history)
        self._audit_side(stress[1:], gradients, history.statev, values)
        falls = np.diff(history.energies[:, 2])
        if falls.size and falls.min() < 0.0:
            self.incidents["wrong-sided"].append(f"dissipation falls by {-falls.min():.3g} MPa in an increment")

    def _audit_refusal(self, result: CallResult, before: Array) -> None:
        if not result.messages.strip() or not (result.stopped or result.pnewdt < 1.0):
            self.incidents["unsaid"].append(f"message {result.messages!r}, PNEWDT {result.pnewdt:g}")
        if not np.array_equal(result.stress, before):
            self.incidents["wrong-sided"].append(f"a refused call changed the stress: {result.messages}")

    def _audit_side(self, stress: Array, gradients: Array, statev: Array, values: Mapping[str, float]) -> None:
        """Refuse a stress beyond the compaction limit, and a viscous stress that drives what it should resist.

        stress : (n, 3, 3) S at the ends; gradients : (n + 1, 3, 3); statev : (n + 1, n_statev).
        """
        beyond = compaction_stretch(gradients[1:]) <= limit_stretch(values) * (1.0 - LIMIT_ROUNDING)
        power, allowed = viscous_work(stress, gradients, statev, values)
        for index in np.flatnonzero(beyond)[:3]:
            self._enter("stress beyond the compaction limit", gradients[index + 1])
        for index in np.flatnonzero(power < -allowed)[:3]:
            self._enter(f"viscous work {power[index]:.3g} MPa", gradients[index + 1])

    def _enter(self, what: str, end: Array, kind: str = "wrong-sided") -> None:
        self.incidents[kind].append(f"{what} at F1 = [{', '.join(f'{value:.4g}' for value in np.ravel(end))}]")


def multiplier_stress(history: History) -> Array:
    """S (n, 3, 3) in MPa of the driver's multiplier."""
    gradients = history.deformation_gradient
    return np.asarray((history.pressure * np.linalg.det(gradients))[:, None, None] * np.linalg.inv(green(gradients)))


def viscous_stress(stress: Array, gradient: Array, pressure: ArrayLike, values: Mapping[str, float]) -> Array:
    """Viscous part (..., 3, 3) in MPa of S (..., 3, 3): what an independent elastic law and the constraint's pressure leave."""
    right = green(gradient)
    constraint = (-np.asarray(pressure) * np.linalg.det(gradient))[..., None, None] * np.linalg.inv(right)
    return np.asarray(stress - elastic_stress(right, values) - constraint)


def rate_starts(gradients: Array, statev: Array, values: Mapping[str, float]) -> Array:
    """C (n, 3, 3) that the rate of each increment is counted from: in the one that locks with the width at the lock."""
    locking = np.diff(statev[:, 4]) > 0.0
    widening = np.maximum(compaction_stretch(gradients[:-1]) / np.exp(values["eps_lock"]), 1.0)
    scale = np.ones((len(locking), 3))
    scale[:, 1] = np.where(locking, widening, 1.0)
    return np.asarray(scale[:, :, None] * green(gradients[:-1]) * scale[:, None, :])


def viscous_work(stress: Array, gradients: Array, statev: Array, values: Mapping[str, float]) -> tuple[Array, Array]:
    """Work (n,) in MPa of the viscous stress over each increment, and what rounding may take from it.

    The work S_v : (C1 - C0)/2 is exact for the backward difference, with C0 of `rate_starts`.
    """
    pressure = statev[1:, 5]
    flow = viscous_stress(stress, gradients[1:], pressure, values)
    strain = 0.5 * (green(gradients[1:]) - rate_starts(gradients, statev, values))
    stiffness = values["E_L"] + values["E_T"] + values["G_LT"] + values["kappa"]
    size = np.abs(stress).max(axis=(1, 2)) + np.abs(pressure) + stiffness
    moved = size * np.abs(strain).sum(axis=(1, 2)) + np.abs(flow).sum(axis=(1, 2))  # C itself is rounded too
    return np.asarray((flow * strain).sum(axis=(1, 2))), ROUNDING_SHARE * moved
