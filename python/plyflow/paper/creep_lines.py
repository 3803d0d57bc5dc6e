"""Section 3.2 on the UMAT's own increments: points of the log-log diagram, k by straightness, a and b of each stage."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from plyflow.case.case import Case, law_parameters, state_place
from plyflow.errors import RunError
from plyflow.law import LawParameters, LoadProgramme, Stage
from plyflow.law.equations import log_eta_micro, log_eta_ply
from plyflow.sweep.umat_cases import driven
from plyflow.umat.prepare import Umat

FloatArray = NDArray[np.float64]
# Smaller compactions of an increment are not told from the volume change that the penalty allows (p/kappa = 3e-6).
SMALLEST_COMPACTION = 1e-5
FEWEST_POINTS = 3
REFINEMENT = 16.0  # at 30 degC the first ramp passes the squeeze stage in a few increments
SMALLEST_K = 0.3
K_TOLERANCE = 1e-10


@dataclass(frozen=True)
class StageLine:
    """Points (n,) of one stage, rate [1/s] and ratio = p/(rate eta_ply eta_micro) [MPa s^(a+1)], and their line."""

    rate: FloatArray
    ratio: FloatArray
    a: float
    b: float
    r_squared: float


@dataclass(frozen=True)
class CreepLines:
    """What section 3.2 finds: k and the line of each stage, beside the law the UMAT was run with."""

    case: Case
    law: LawParameters
    k: float
    lines: Mapping[Stage, StageLine]

    def found(self) -> LawParameters:
        """The law with what was found in place of what was put in; `a` is that of the bleed stage."""
        squeeze, bleed = self.lines[Stage.SQUEEZE], self.lines[Stage.BLEED]
        return replace(self.law, k=self.k, a=bleed.a, b_squeeze=squeeze.b, b_bleed=bleed.b)

    def table(self) -> pd.DataFrame:
        """Points with their stage and the ratio on the line."""
        tables = []
        for stage, line in self.lines.items():
            drawn = {"rate_1_s": line.rate, "ratio_MPa_s": line.ratio, "line_MPa_s": np.exp(line.b) * line.rate**line.a}
            tables.append(pd.DataFrame({"stage": stage.name.lower(), **drawn}))
        return pd.concat(tables, ignore_index=True)


@dataclass(frozen=True)
class _Points:
    """Increments of one stage: compaction at the end, rate [1/s] in it, pressure [MPa] at the end."""

    eps: FloatArray
    rate: FloatArray
    pressure: FloatArray


def creep_lines(case: Case, umat: Umat) -> CreepLines:
    """Drive the UMAT through a case and evaluate its increments as section 3.2 evaluates a test.

    Raises
    ------
    InputError
        The case cannot be set up.
    RunError
        The driver could not finish, or a stage has too few increments for a line.
    """
    load = case.load_programme
    values, history = driven(case, load, umat, REFINEMENT)
    law = law_parameters(values)
    state = {name: history.statev[:, state_place(umat.manifest, name)] for name in ("eps", "eps_rate", "locked")}
    points = _points(history.time, state, load)
    for stage, group in points.items():
        if group.eps.size < FEWEST_POINTS:
            raise RunError(f"{case.label}: {group.eps.size} increments in the {stage.name.lower()} stage make no line")
    k = _straightest_k(law, points)
    return CreepLines(case, law, k, {stage: _line(group, replace(law, k=k), stage) for stage, group in points.items()})


def _points(time: FloatArray, state: Mapping[str, FloatArray], load: LoadProgramme) -> dict[Stage, _Points]:
    """Increments by stage, without the one that passes the lock: its rate counts from the width at the lock."""
    pressure, rate = load.pressure(time), -state["eps_rate"]
    compaction = -np.diff(state["eps"], prepend=0.0)
    locked = state["locked"] >= 0.5
    bled = np.concatenate([[False], locked[:-1]])
    usable = (compaction > SMALLEST_COMPACTION) & (rate > 0.0) & (pressure > 0.0)
    chosen = {Stage.SQUEEZE: usable & ~locked, Stage.BLEED: usable & bled}
    return {stage: _Points(state["eps"][rows], rate[rows], pressure[rows]) for stage, rows in chosen.items()}


def _line(points: _Points, law: LawParameters, stage: Stage) -> StageLine:
    x = np.log(points.rate)
    y = np.log(points.pressure) - x - log_eta_ply(points.eps, law, stage) - log_eta_micro(points.eps, law, stage)
    a, b = np.polynomial.polynomial.polyfit(x, y, 1)[::-1]
    scatter, spread = float(np.sum((y - b - a * x) ** 2)), float(np.sum((y - y.mean()) ** 2))
    return StageLine(points.rate, np.exp(y), float(a), float(b), 1.0 - scatter / spread)


def _straightest_k(law: LawParameters, points: Mapping[Stage, _Points]) -> float:
    """The k that brings the coefficients of determination of both lines closest to 1."""

    def misfit(k: float) -> float:
        lines = [_line(group, replace(law, k=k), stage) for stage, group in points.items()]
        return sum(1.0 - line.r_squared for line in lines)

    deepest = min(float(group.eps.min()) for group in points.values())
    largest = math.exp(deepest - law.eps_lock) / math.sqrt(law.chi_ratio)
    trials = np.linspace(SMALLEST_K, min(largest, law.chi_ratio**-0.5), 60)[:-1]
    best = int(np.argmin([misfit(k) for k in trials]))
    upper = trials[best + 1] if best + 1 < trials.size else min(largest, law.chi_ratio**-0.5) * (1.0 - 1e-9)
    bounds = (trials[max(best - 1, 0)], upper)
    return float(minimize_scalar(misfit, bounds=bounds, method="bounded", options={"xatol": K_TOLERANCE}).x)
