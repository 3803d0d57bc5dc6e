"""The account of a whole matrix: every call and every increment is looked at, whatever its cell asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from plyflow.driver.drive import History
from plyflow.evidence.stability.tensors import (
    EPSILON,
    Array,
    compaction_stretch,
    elastic_stress,
    green,
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
        self, result: CallResult, ends: tuple[Array, Array], values: Mapping[str, float], before: Array
    ) -> None:
        """Look at one answer of the UMAT; `before` is the stress it was given."""
        self.calls += 1
        if result.messages or result.stopped:
            self.refusals += 1
            self._audit_refusal(result, before)
            return
        if not np.isfinite(ends).all():
            self.incidents["wrong-sided"].append(f"answered F0 = {_short(ends[0])}, F1 = {_short(ends[1])}")
            return
        numbers = (result.stress, result.ddsdde, result.statev, [result.sse, result.scd])
        if not all(np.isfinite(part).all() for part in numbers):
            self.incidents["not finite"].append(f"answer to F1 = {_short(ends[1])}")
            return
        with np.errstate(over="ignore", invalid="ignore"):
            stress = second_piola(result.stress, ends[1])
            self._audit_side(stress[None], np.array(ends), result.statev[5:6], values)
        if result.scd < 0.0:
            self.incidents["wrong-sided"].append(f"dissipation {result.scd:.3g} MPa at F1 = {_short(ends[1])}")

    def audit_history(self, history: History, values: Mapping[str, float], start: int = 0) -> None:
        """Look at every accepted increment of a programme."""
        self.increments += history.increments
        if not history.completed:
            self.refusals += 1
            if not history.message.strip():
                self.incidents["unsaid"].append("a programme ended without a message")
        arrays = (history.deformation_gradient, history.stress, history.statev, history.energies)
        if not all(np.isfinite(part[start:]).all() for part in arrays):
            self.incidents["not finite"].append("a state of an accepted increment")
            return
        stress = second_piola(history.stress, history.deformation_gradient)
        right = green(history.deformation_gradient)
        volume = np.linalg.det(history.deformation_gradient)
        stress = stress - (history.pressure * volume)[:, None, None] * np.linalg.inv(right)
        self._audit_side(stress[1:], history.deformation_gradient, history.statev[1:, 5], values)
        falls = np.diff(history.energies[:, 2])
        if falls.size and falls.min() < 0.0:
            self.incidents["wrong-sided"].append(f"dissipation falls by {-falls.min():.3g} MPa in an increment")

    def _audit_refusal(self, result: CallResult, before: Array) -> None:
        if not result.messages.strip() or not (result.stopped or result.pnewdt < 1.0):
            self.incidents["unsaid"].append(f"message {result.messages!r}, PNEWDT {result.pnewdt:g}")
        if not np.array_equal(result.stress, before):
            self.incidents["wrong-sided"].append(f"a refused call changed the stress: {result.messages}")

    def _audit_side(self, stress: Array, gradients: Array, pressure: Array, values: Mapping[str, float]) -> None:
        """Refuse a stress beyond the compaction limit, and a viscous stress that drives what it should resist.

        stress : (n, 3, 3) S at the ends; gradients : (n + 1, 3, 3); pressure : (n,) of the constraint.
        """
        limit = values["k"] * np.sqrt(values["chi_ratio"]) * np.exp(values["eps_lock"])
        beyond = compaction_stretch(gradients[1:]) <= limit * (1.0 - LIMIT_ROUNDING)
        for index in np.flatnonzero(beyond)[:3]:
            self.incidents["wrong-sided"].append(
                f"stress beyond the compaction limit at F1 = {_short(gradients[index + 1])}"
            )
        power, allowed = viscous_work(stress, gradients, pressure, values)
        for index in np.flatnonzero(power < -allowed)[:3]:
            self.incidents["wrong-sided"].append(
                f"viscous work {power[index]:.3g} MPa at F1 = {_short(gradients[index + 1])}"
            )


def viscous_work(stress: Array, gradients: Array, pressure: Array, values: Mapping[str, float]) -> tuple[Array, Array]:
    """Work (n,) in MPa of the viscous stress over each increment, and what rounding may take from it.

    The viscous stress is what an independent elastic law and the constraint's pressure leave of S; the work
    S_v : (C1 - C0)/2 is exact for the backward difference.
    """
    right = green(gradients)
    volume = np.linalg.det(gradients[1:])[:, None, None]
    constraint = -pressure[:, None, None] * volume * np.linalg.inv(right[1:])
    flow = stress - elastic_stress(right[1:], values) - constraint
    strain = 0.5 * np.diff(right, axis=0)
    stiffness = values["E_L"] + values["E_T"] + values["G_LT"] + values["kappa"]
    size = np.abs(stress).max(axis=(1, 2)) + np.abs(pressure) + stiffness
    moved = size * np.abs(strain).sum(axis=(1, 2)) + np.abs(flow).sum(axis=(1, 2))  # C itself is rounded too
    allowed = ROUNDING_SHARE * moved
    return np.asarray((flow * strain).sum(axis=(1, 2))), allowed


def _short(gradient: Array) -> str:
    return "[" + ", ".join(f"{value:.4g}" for value in np.ravel(gradient)) + "]"
