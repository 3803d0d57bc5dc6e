"""How k, a and b are tied: the misfit over each pair of them, the third at its best.

The misfit is that to the fitted curves, in root-mean-square thickness: the same for every choice of noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.interpolate import RectBivariateSpline
from scipy.stats import chi2

from plyflow.identify.model import NAMES, predicted
from plyflow.identify.refine import CONFIDENCE, Fit

FloatArray = NDArray[np.float64]
TIED = ("k", "a", "b_bleed")
POINTS = 25
# Half width of a picture: standard errors, and the misfit [mm] to be reached at least, readings without noise included.
REACH, REACHED = 15.0, 0.002
FINE = 241
TIMES = 32
STEPS = 4
NUDGE = 1e-4
WIDEST = {"k": 0.1, "a": 0.1, "b_bleed": 3.0}
LOW = {"k": 0.05, "a": -0.9995, "b_bleed": -np.inf}
HIGH = {"k": 1.19, "a": 0.99, "b_bleed": np.inf}


@dataclass(frozen=True)
class Plane:
    """Misfit over two parameters: names, their values (p,), root-mean-square misfit (p, p) [mm] by [second, first]."""

    first: str
    second: str
    first_values: FloatArray
    second_values: FloatArray
    misfit: FloatArray


def region_level(fit: Fit) -> float:
    """Root-mean-square misfit [mm] at the edge of the joint 95 % region of two parameters."""
    return fit.scatter * float(np.sqrt(chi2.ppf(CONFIDENCE, 2))) / _root_readings(fit)


def _root_readings(fit: Fit) -> float:
    """Square root of the number of readings compared."""
    return float(np.sqrt(sum(np.count_nonzero(specimen.resolved) for specimen in fit.specimens)))


def planes(fit: Fit) -> list[Plane]:
    """The misfit over (k, a), (k, b_bleed) and (a, b_bleed); b_squeeze keeps its distance to b_bleed."""
    curves = _Curves(fit)
    return [_plane(fit, curves, first, second) for first, second in combinations(TIED, 2)]


def refined(plane: Plane) -> Plane:
    """The plane on a finer grid, by a cubic spline of the squared misfit, which is smooth where the misfit has its tip."""
    degree = min(3, plane.first_values.size - 1)
    first, second = (np.linspace(values[0], values[-1], FINE) for values in (plane.first_values, plane.second_values))
    spline = RectBivariateSpline(plane.second_values, plane.first_values, plane.misfit**2, kx=degree, ky=degree)
    return replace(
        plane, first_values=first, second_values=second, misfit=np.sqrt(np.maximum(spline(second, first), 0.0))
    )


def planes_table(found: Sequence[Plane]) -> pd.DataFrame:
    """All planes as rows: names and values of the pair, misfit [mm]."""
    tables = []
    for plane in found:
        first, second = np.meshgrid(plane.first_values, plane.second_values)
        columns = {"first": plane.first, "first_value": first.ravel(), "second": plane.second}
        tables.append(pd.DataFrame(columns | {"second_value": second.ravel(), "misfit_mm": plane.misfit.ravel()}))
    return pd.concat(tables, ignore_index=True)


class _Curves:
    """Curves of all specimens at a few times, each standing for the readings around it."""

    def __init__(self, fit: Fit) -> None:
        self.specimens = fit.specimens
        self.offset = fit.estimates["b_squeeze"].value - fit.estimates["b_bleed"].value
        self.times, weights = [], []
        for specimen in fit.specimens:
            read = specimen.time[specimen.resolved]
            places = np.unique(np.geomspace(1.0, read.size, TIMES).astype(int)) - 1
            self.times.append(read[places])
            weights.append(np.diff([0, *(places + 1).tolist()]))
        weight = np.concatenate(weights)
        self.weight = weight / weight.sum()
        self.fitted = self.thickness(fit.values[[NAMES.index(name) for name in TIED]][None])[0]

    def thickness(self, tied: FloatArray) -> FloatArray:
        """Thickness (p, n) [mm] for k, a, b_bleed (p, 3)."""
        parameters = np.empty((len(tied), len(NAMES)))
        for place, name in enumerate(TIED):
            parameters[:, NAMES.index(name)] = tied[:, place]
        parameters[:, NAMES.index("b_squeeze")] = tied[:, 2] + self.offset
        parts = [predicted(one, parameters, times) for one, times in zip(self.specimens, self.times, strict=True)]
        return np.concatenate(parts, axis=1)

    def misfit(self, thickness: FloatArray) -> FloatArray:
        """Root-mean-square distance (p,) [mm] of curves (p, n) to the fitted ones."""
        return np.asarray(np.sqrt((thickness - self.fitted) ** 2 @ self.weight), dtype=float)


def _plane(fit: Fit, curves: _Curves, first: str, second: str) -> Plane:
    (third,) = [name for name in TIED if name not in (first, second)]
    best = np.array([fit.estimates[name].value for name in TIED])
    spread = np.sqrt(np.diag(fit.covariance))
    order = [TIED.index(name) for name in (first, second, third)]
    reach = max(REACH, REACHED * _root_readings(fit) / fit.scatter)
    axes = [
        _axis(name, best[TIED.index(name)], min(reach * spread[TIED.index(name)], WIDEST[name]))
        for name in (first, second)
    ]
    x, y = (values.ravel() for values in np.meshgrid(*axes))
    trials = np.tile(best, (x.size, 1))
    trials[:, order[0]], trials[:, order[1]] = x, y
    # Start where the third would be if the valley were straight.
    information = np.linalg.inv(fit.covariance)
    pull = information[order[2], order[:2]] @ np.array([x - best[order[0]], y - best[order[1]]])
    trials[:, order[2]] = _inside(third, best[order[2]] - pull / information[order[2], order[2]])
    misfit = _settle(curves, trials, order[2], third)
    return Plane(first, second, axes[0], axes[1], misfit.reshape(POINTS, POINTS))


def _settle(curves: _Curves, trials: FloatArray, place: int, name: str) -> FloatArray:
    """Least misfit (p,) over one parameter of trials (p, 3), by Gauss and Newton; a step that fails is shortened."""
    thickness = curves.thickness(trials)
    misfit, length = curves.misfit(thickness), np.ones(len(trials))
    for _ in range(STEPS):
        nudged = trials.copy()
        nudged[:, place] += NUDGE
        slope = (curves.thickness(nudged) - thickness) / NUDGE
        curvature = slope**2 @ curves.weight
        downhill = -((thickness - curves.fitted) * slope) @ curves.weight
        step = np.divide(downhill, curvature, out=np.zeros_like(downhill), where=curvature > 0.0)
        moved = trials.copy()
        moved[:, place] = _inside(name, trials[:, place] + length * step)
        there = curves.thickness(moved)
        better = curves.misfit(there) < misfit
        trials[better], thickness[better] = moved[better], there[better]
        misfit = curves.misfit(thickness)
        length = np.where(better, 1.0, 0.3 * length)
    return misfit


def _axis(name: str, best: float, reach: float) -> FloatArray:
    ends = _inside(name, np.array([best - reach, best + reach]))
    return np.linspace(ends[0], ends[1], POINTS)


def _inside(name: str, values: FloatArray) -> FloatArray:
    return np.clip(values, LOW[name], HIGH[name])
