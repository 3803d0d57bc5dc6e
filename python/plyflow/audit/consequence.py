"""What a printed form would do, in numbers: stress ratio at a stated state, final thickness of the reference case."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from plyflow.audit.creep import FloatArray, Outcome, Reference, compact, reference_case
from plyflow.law import Stage
from umataudit import Effect, Variant
from umataudit.domain import of_table_4

_STAGES = {Stage.SQUEEZE: "squeeze", Stage.BLEED: "bleed"}
_NAMES = {Stage.SQUEEZE: "squeezing", Stage.BLEED: "bleeding"}
_SAME = 5.0e-5
_RESIN = 1.0e-5  # MPa s, stated where it is used
_OVERFLOW = 300.0


@dataclass(frozen=True)
class VariantResult:
    """Numbers of one variant: log10 of the stress ratio by stage, and how the reference case ends."""

    label: str
    log_ratios: Mapping[Stage, float]
    outcome: Outcome


class Consequences:
    """Evaluates effects for the reference case."""

    def __init__(self, reference: Reference | None = None) -> None:
        self.reference = reference if reference is not None else reference_case()
        self.derived = compact(self.reference)
        law = self.reference.law
        self.states = {Stage.SQUEEZE: law.eps_lock / 2, Stage.BLEED: -0.2}

    @property
    def stated(self) -> str:
        """What the numbers refer to, one sentence."""
        squeeze, bleed = (self.states[stage] for stage in _STAGES)
        return (
            f"Reference case: {self.reference.label}, locks after {self.derived.lock_time:.3g} s, ends "
            f"at $h/h0 = {self.derived.thickness:.4f}$. Stress ratios: printed "
            f"over derived at equal strain and rate, at $eps = {squeeze:.4f}$ (squeezing) and ${bleed:g}$ (bleeding)."
        )

    def text(self, effect: Effect) -> str:
        """Consequence of an effect, one or more sentences."""
        parts = [self._variant_text(self.variant(variant)) for variant in effect.variants]
        parts += [f"{what}: {self._number(expr)}" for what, expr in effect.numbers]
        return "; ".join([*parts, effect.note] if effect.note else parts)

    def variant(self, variant: Variant) -> VariantResult:
        """Stress ratios and final thickness of one variant."""
        settings = {name: float(value) for name, value in variant.settings.items()}
        reference = self.reference
        if "chi_ratio" in settings:
            reference = replace(reference, law=replace(reference.law, chi_ratio=settings["chi_ratio"]))

        def log_factor(eps: FloatArray, stage: Stage) -> FloatArray:
            return self._log(variant.factors.get(_STAGES[stage], sp.S.One), eps, stage)

        outcome = compact(
            reference,
            log_factor,
            limit=None if variant.limit is None else math.log(self._value(variant.limit, 0.0, Stage.BLEED)),
            lock=None if variant.lock is None else float(variant.lock),
            end_time=settings.get("end_time"),
            swapped=variant.swapped,
        )
        ratios = {
            stage: float(log_factor(np.array([eps]), stage)[0]) / math.log(10.0)
            for stage, eps in self.states.items()
            if _STAGES[stage] in variant.factors
        }
        return VariantResult(variant.label, ratios, outcome)

    def _variant_text(self, result: VariantResult) -> str:
        factors = {_NAMES[stage]: _power(log) for stage, log in result.log_ratios.items()}
        if len(factors) == 2 and len(set(factors.values())) == 1:
            factors = {"both stages": factors["squeezing"]}
        said = [f"stress x {factor} in {stage}" for stage, factor in factors.items()]
        return f"{result.label}: {', '.join([*said, *self._outcome_text(result.outcome)])}"

    def _outcome_text(self, outcome: Outcome) -> list[str]:
        """Time of locking where it differs, and the final thickness."""
        said = []
        if abs(outcome.lock_time - self.derived.lock_time) > _SAME * self.derived.lock_time:
            when = f"locks after {outcome.lock_time:.3g} s" if math.isfinite(outcome.lock_time) else "does not lock"
            said.append(f"{when} in place of {self.derived.lock_time:.3g} s")
        if abs(outcome.thickness - self.derived.thickness) < _SAME:
            return [*said, f"final $h/h0$ unchanged ({self.derived.thickness:.4f})"]
        none = " (no compaction)" if outcome.thickness > 1.0 - _SAME else ""
        return [*said, f"final $h/h0 = {outcome.thickness:.4f}$ in place of {self.derived.thickness:.4f}{none}"]

    def _constants(self, eps: Any, stage: Stage) -> dict[str, Any]:
        law = self.reference.law
        closeness = 1.0 / math.expm1(law.eps_lock - law.eps_limit)
        b = law.b_squeeze if stage is Stage.SQUEEZE else law.b_bleed
        return {
            "eps": eps, "k_gap": law.k, "a_rate": law.a, "b_log": b, "w0": law.w0, "h0": law.h0, "eps_lock": law.eps_lock,
            "chi_l": law.chi_lock, "chi_f": law.chi_limit, "X": closeness, "j2": 1.0, "V0": 0.5, "eta_res": _RESIN,
            "b_bar": b - math.log(_RESIN), **_moduli(),
        }  # fmt: skip

    def _log(self, expr: sp.Expr, eps: FloatArray, stage: Stage) -> FloatArray:
        """Natural logarithm of a factor at strains; of its absolute value, as a squared gap is."""
        logarithm = sp.expand_log(sp.log(expr), force=True)
        symbols = sorted(logarithm.free_symbols, key=str)
        constants = self._constants(eps, stage)
        function = sp.lambdify(symbols, logarithm, "numpy")
        with np.errstate(all="ignore"):
            value = function(*(np.asarray(constants[s.name], dtype=complex) for s in symbols))
        return np.asarray(np.broadcast_to(np.real(value), eps.shape), dtype=float)

    def _value(self, expr: sp.Expr, eps: float, stage: Stage) -> float:
        constants = self._constants(eps, stage)
        return float(expr.subs({s: constants[s.name] for s in expr.free_symbols}))

    def _number(self, expr: sp.Expr) -> str:
        return f"{self._value(sp.sympify(expr), self.derived.strain, Stage.BLEED):.4g}"


@cache
def _moduli() -> dict[str, float]:
    """Constants of Eq. 10 from Table 4."""
    return {symbol.name: float(value) for symbol, value in of_table_4().items()}


def _power(log10: float) -> str:
    """A factor given by its decimal logarithm, readable at any size."""
    if abs(log10) < 3.0:
        return f"{10.0**log10:.4g}"
    if abs(log10) > _OVERFLOW:
        return f"10^{log10:.0f}"
    return f"{10.0**log10:.1e}"
