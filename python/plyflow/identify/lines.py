"""Section 3.2: k such that the points of both stages fall on straight lines, a and b of each by regression.

The diagram is that of Fig. 6a:  ln(pressure / (rate eta_ply eta_micro)) = b + a ln(rate), for k fixed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from plyflow.errors import InputError
from plyflow.identify.rates import CreepPoints, creep_points
from plyflow.identify.specimen import SMALLEST_K, TRIAL_A, Specimen, names_of, trial_law
from plyflow.law import LawParameters, Stage
from plyflow.law.equations import log_eta_micro, log_eta_ply, log_viscosity_slope

FloatArray = NDArray[np.float64]
FEWEST_POINTS = 4
FEWEST_ON_LINE = 3


@dataclass(frozen=True)
class Line:
    """Straight line of one stage: a, b, standard error of a, number of points, coefficient of determination."""

    a: float
    b: float
    a_error: float
    points: int
    r_squared: float


@dataclass(frozen=True)
class DiagramPoints:
    """Points (n,) of the diagram of one stage: ln(rate), ln(pressure/(rate eta_ply eta_micro)), weights."""

    log_rate: FloatArray
    log_ratio: FloatArray
    weight: FloatArray


@dataclass(frozen=True)
class LineFit:
    """k, the lines by stage, the points they go through, the pooled 1 - R^2 that k makes least."""

    k: float
    lines: dict[Stage, Line]
    points: dict[Stage, DiagramPoints]
    misfit: float


def fit_lines(specimens: Sequence[Specimen]) -> LineFit:
    """Choose k and fit the lines over all specimens.

    Raises
    ------
    InputError
        Too few points whose rate can be told from the noise.
    """
    points = [creep_points(specimen) for specimen in specimens]
    total = sum(group.size for group in points)
    if total < FEWEST_POINTS:
        raise InputError(
            f"{names_of(specimens)}: {total} stretches of readings have a rate that stands out of the noise, {FEWEST_POINTS} "
            "are needed for straight lines"
        )
    largest = _largest_k(specimens, points)

    def misfit(k: float) -> float:
        return _pooled_misfit(diagram(specimens, points, k))

    trials = np.linspace(SMALLEST_K, largest, 120)[:-1]
    best = int(np.argmin([misfit(k) for k in trials]))
    low, high = trials[max(best - 1, 0)], trials[best + 1] if best + 1 < trials.size else largest * (1.0 - 1e-9)
    k = float(minimize_scalar(misfit, bounds=(low, high), method="bounded", options={"xatol": 1e-9}).x)
    diagrams = diagram(specimens, points, k)
    lines = {stage: _line(group) for stage, group in diagrams.items()}
    return LineFit(k, lines, diagrams, misfit(k))


def diagram(specimens: Sequence[Specimen], points: Sequence[CreepPoints], k: float) -> dict[Stage, DiagramPoints]:
    """Points of the diagram by stage, of stages with enough points for a line."""
    parts: dict[Stage, list[FloatArray]] = {stage: [] for stage in Stage}
    for specimen, group in zip(specimens, points, strict=True):
        law = trial_law(specimen.geometry, specimen.eps_lock(k), specimen.l0_over_d, specimen.chi_ratio, k)
        for stage in Stage:
            chosen = group.take((group.eps > law.eps_lock) == (stage is Stage.SQUEEZE))
            if chosen.size:
                parts[stage].append(_stage_points(law, stage, chosen))
    joined = {stage: np.concatenate(part, axis=1) for stage, part in parts.items() if part}
    return {stage: DiagramPoints(*rows) for stage, rows in joined.items() if rows.shape[1] >= FEWEST_ON_LINE}


def _stage_points(law: LawParameters, stage: Stage, points: CreepPoints) -> FloatArray:
    log_rate = np.log(points.rate)
    log_eta = log_eta_ply(points.eps, law, stage) + log_eta_micro(points.eps, law, stage)
    log_ratio = np.log(points.pressure) - log_rate - log_eta
    slope = log_viscosity_slope(points.eps, law, stage)
    variance = ((1.0 + TRIAL_A) * points.log_rate_error) ** 2 + (slope * points.eps_error) ** 2
    return np.array([log_rate, log_ratio, 1.0 / (variance + 1e-12)])


def _line(points: DiagramPoints) -> Line:
    share = points.weight / points.weight.sum()
    x, y = points.log_rate, points.log_ratio
    x_mean, y_mean = float(share @ x), float(share @ y)
    spread = float(share @ (x - x_mean) ** 2)
    a = float(share @ ((x - x_mean) * (y - y_mean))) / spread
    residual = y - y_mean - a * (x - x_mean)
    scatter = float(share @ residual**2)
    freedom = max(x.size - 2, 1)
    return Line(
        a=a,
        b=y_mean - a * x_mean,
        a_error=math.sqrt(scatter / spread / freedom),
        points=x.size,
        r_squared=1.0 - scatter / float(share @ (y - y_mean) ** 2),
    )


def _pooled_misfit(diagrams: dict[Stage, DiagramPoints]) -> float:
    """1 - R^2, over the stages in proportion to their points."""
    lines = [_line(group) for group in diagrams.values()]
    return sum((1.0 - line.r_squared) * line.points for line in lines) / sum(line.points for line in lines)


def _largest_k(specimens: Sequence[Specimen], points: Sequence[CreepPoints]) -> float:
    """Value of k at which the first point would lie on the compaction limit."""
    return min(
        specimen.k_of_limit(float(group.eps.min())) if group.size else specimen.largest_k
        for specimen, group in zip(specimens, points, strict=True)
    )
