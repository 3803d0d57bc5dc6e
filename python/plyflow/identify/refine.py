"""Least squares on the whole thickness curve, with confidence intervals.

Between the stages b is known to be tied: in every column of the paper's tables b_squeeze - b_bleed = 2 ln(l0/d) to the
last printed digit. Where the readings cannot tell b_squeeze (a specimen that locks before the second reading), the tie
is used and said; where they can, all four parameters are fitted.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import lmfit
import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from plyflow.errors import InputError, RunError
from plyflow.identify.lines import LineFit
from plyflow.identify.model import A_BOUNDS, NAMES, residuals, sensitivities, steps_over_kinks
from plyflow.identify.specimen import LARGEST_STEP, Specimen, names_of
from plyflow.identify.start import LARGEST_B_ERROR, TIE_ROUNDING, first_values, readings_tell, straight_lines

FloatArray = NDArray[np.float64]
CONFIDENCE = 0.95
Best = tuple[lmfit.Minimizer, lmfit.minimizer.MinimizerResult]
FEWEST_COMPARED = 10
ORDER = ("k", "a", "b_bleed", "b_squeeze")  # of the covariance; the last one only if it is fitted
TIES = ("auto", "always", "never")
INTERVALS = ("covariance", "profile")
# How MINPACK says that it has converged, can get no closer, or (5) creeps along a kink of the misfit after many trials.
CONVERGED, MOST_TRIALS = (1, 2, 3, 4, 5, 6, 7, 8), 80


@dataclass(frozen=True)
class Estimate:
    """A parameter: value, standard error, ends of its interval; with 95 % confidence those of a fit all hold at once."""

    value: float
    error: float
    low: float
    high: float


@dataclass(frozen=True)
class Fit:
    """Parameters of some specimens.

    estimates by name (k, a, b_squeeze, b_bleed); covariance and correlation (3, 3) of k, a and b_bleed; tied: whether
    b_squeeze follows from the tie; scatter [mm] of the readings about the curves; lines: section 3.2, None where the
    readings give none; notes; offsets of the thickness [mm] by specimen, if fitted: the readings here are without them.
    """

    specimens: tuple[Specimen, ...]
    estimates: dict[str, Estimate]
    covariance: FloatArray
    tied: bool
    scatter: float
    lines: LineFit | None
    notes: tuple[str, ...]
    offsets: tuple[Estimate, ...] = ()

    @property
    def values(self) -> FloatArray:
        """Parameters (4,) in the order of `NAMES`."""
        return np.array([self.estimates[name].value for name in NAMES])

    @property
    def correlation(self) -> FloatArray:
        """Correlations (3, 3) of k, a and b_bleed."""
        deviation = np.sqrt(np.diag(self.covariance))
        return np.asarray(self.covariance / np.outer(deviation, deviation), dtype=float)


def fit(specimens: Sequence[Specimen], tie: str = "auto", intervals: str = "covariance", offset: bool = False) -> Fit:
    """Fit the parameters of one material at one temperature.

    Parameters
    ----------
    specimens : sequence of Specimen
        Fitted together.
    tie : str
        Whether b_squeeze follows from b_bleed: "auto" (where the readings cannot tell it), "always", "never".
    intervals : str
        "covariance" (from the curvature at the optimum) or "profile" (from the misfit with each parameter held, lmfit's
        conf_interval: slower, and right in a curved valley too).
    offset : bool
        Whether each specimen's thickness has an offset, the same for all its readings, to be fitted too.

    Raises
    ------
    InputError
        Nothing to fit, an unknown choice, specimens of several temperatures.
    RunError
        The least squares did not converge, or no law comes near the readings.
    """
    _check(specimens, tie, intervals)
    try:
        return _fit(specimens, tie, intervals, offset)
    except InputError:
        raise
    except (RunError, ArithmeticError, ValueError, np.linalg.LinAlgError) as error:
        reason = str(error).partition("!")[0].partition("\n")[0]
        raise RunError(
            f"{names_of(specimens)}: no parameters of the law come near these readings ({reason}); look at the curve of "
            f"thickness over time, the geometry and the units{'' if offset else '; or try --offset, for a zero error of the sensor'}"
        ) from error


def _fit(specimens: Sequence[Specimen], tie: str, intervals: str, centred: bool) -> Fit:
    offset = 2.0 * math.log(specimens[0].l0_over_d)
    lines, notes = straight_lines(specimens)
    solver = _Solver(specimens, offset, centred)
    best = solver.run(first_values(specimens, lines, offset, centred), free=tie == "never")
    free = tie == "never" or (tie == "auto" and readings_tell(specimens, values_of(best), centred))
    if free and tie != "never":
        best = solver.run(values_of(best), free=True)
    if free:
        best = _around_kinks(solver, best)
    if free and tie == "auto" and math.sqrt(solver.covariance(best, free)[3, 3]) > LARGEST_B_ERROR:
        best, free = solver.run(values_of(best), free=False), False  # a kink had made b_squeeze look known
    covariance, estimates = solver.estimates(best, free, intervals)
    scatter = math.sqrt(solver.variance(best))
    offsets = solver.offsets(best, free, covariance, scatter) if centred else ()
    fitted = tuple(
        replace(one, thickness=one.thickness - found.value) for one, found in zip(specimens, offsets, strict=True)
    ) if centred else solver.specimens  # fmt: skip
    return Fit(fitted, estimates, covariance[:3, :3], not free, scatter, lines, notes, offsets)


def _around_kinks(solver: _Solver, best: Best) -> Best:
    """The best of restarts with another b_squeeze: where the lock passes a reading the misfit has a kink."""
    error = math.sqrt(solver.covariance(best, free=True)[3, 3])
    step = np.where(np.array(NAMES) == "b_squeeze", error, 0.0)
    trials = [best, *(solver.run(values_of(best) + side * step, free=True) for side in (-1.0, 1.0))]
    return min(trials, key=lambda trial: float(trial[1].chisqr))


def _check(specimens: Sequence[Specimen], tie: str, intervals: str) -> None:
    if not specimens:
        raise InputError("no specimens to fit: give at least one file")
    for name, value, choices in (("tie", tie, TIES), ("intervals", intervals, INTERVALS)):
        if value not in choices:
            raise InputError(f"unknown --{name} '{value}': choose one of {', '.join(choices)}")
    temperatures = sorted({specimen.geometry.temperature for specimen in specimens})
    if len(temperatures) > 1:
        listed = ", ".join(f"{temperature:g}" for temperature in temperatures)
        raise InputError(
            f"specimens of {listed} degC cannot be fitted together: the parameters are those of one temperature"
        )
    compared = sum(int(np.count_nonzero(specimen.resolved)) for specimen in specimens)
    if compared < FEWEST_COMPARED:
        raise InputError(
            f"{names_of(specimens)}: only {compared} readings follow a load that changed by less than {LARGEST_STEP:.0%} of "
            f"its peak since the reading before, {FEWEST_COMPARED} are needed: give more readings a second, or a file with "
            "all of them"
        )


class _Solver:
    """Least squares by lmfit over k, a, b_bleed and, if free, b_squeeze."""

    def __init__(self, specimens: Sequence[Specimen], offset: float, centred: bool = False) -> None:
        self.specimens = tuple(specimens)
        self.offset = float(offset)
        self.centred = centred
        self.steps: FloatArray | None = None

    def run(self, start: FloatArray, free: bool) -> Best:
        self.steps = steps_over_kinks(self.specimens, start)
        parameters = lmfit.Parameters()
        largest = (1.0 - 1e-6) * min(specimen.largest_k for specimen in self.specimens)
        parameters.add("k", value=min(start[0], 0.999 * largest), min=0.01, max=largest)
        parameters.add("a", value=start[1], min=A_BOUNDS[0], max=A_BOUNDS[1])
        parameters.add("b_bleed", value=start[3])
        if free:
            parameters.add("b_squeeze", value=start[2])
        else:
            parameters.add("b_squeeze", expr=f"b_bleed + {self.offset!r}")
        minimizer = lmfit.Minimizer(self._residual, parameters)
        minimizer.kws["maxfev"] = MOST_TRIALS  # MINPACK's own bound keeps the best trial, lmfit's the last one
        minimizer._err_max_evals = "{:d} trials"  # lmfit's own text has a format code that Python does not know
        result = minimizer.leastsq(Dfun=self._slopes, col_deriv=True, ftol=1e-9, xtol=1e-9, gtol=0.0)
        if result.ier not in CONVERGED or not np.all(np.isfinite(result.residual)):
            raise RunError(f"the least squares did not converge: {result.message}")
        return minimizer, result

    def estimates(self, best: Best, free: bool, intervals: str) -> tuple[FloatArray, dict[str, Estimate]]:
        """Covariance in the order of `ORDER`, and every parameter with its interval."""
        covariance = self.covariance(best, free)
        values = dict(zip(NAMES, values_of(best), strict=True))
        errors = dict(zip(ORDER, np.sqrt(np.diag(covariance)), strict=False))
        # Bonferroni: k, a and b are used together, so all intervals shall hold at once.
        confidence = 1.0 - (1.0 - CONFIDENCE) / len(errors)
        if intervals == "profile":
            bounds = _profile(best, errors, confidence)
        else:
            quantile = float(student.ppf(0.5 + 0.5 * confidence, self.freedom(best)))
            bounds = {n: (values[n] - quantile * error, values[n] + quantile * error) for n, error in errors.items()}
        if not free:
            errors["b_squeeze"] = math.hypot(errors["b_bleed"], TIE_ROUNDING / math.sqrt(3.0))
            low, high = bounds["b_bleed"]
            bounds["b_squeeze"] = low + self.offset - TIE_ROUNDING, high + self.offset + TIE_ROUNDING
        found = {name: Estimate(*map(float, (values[name], errors[name], *bounds[name]))) for name in NAMES}
        return covariance, found

    def covariance(self, best: Best, free: bool) -> FloatArray:
        """Covariance of the fitted parameters, from the sensitivities."""
        slopes = self._by_name(values_of(best), tied=not free)
        rows = np.array([slopes[name] for name in (ORDER if free else ORDER[:3])])
        return np.asarray(np.linalg.inv(rows @ rows.T) * self.variance(best), dtype=float)

    def freedom(self, best: Best) -> int:
        """Degrees of freedom: an offset takes one of each specimen."""
        return int(best[1].nfree) - (len(self.specimens) if self.centred else 0)

    def variance(self, best: Best) -> float:
        """Variance [mm2] of the readings about the curves."""
        return float(best[1].chisqr) / self.freedom(best)

    def offsets(self, best: Best, free: bool, covariance: FloatArray, scatter: float) -> tuple[Estimate, ...]:
        """Offset of each specimen: the mean of what its readings are above the curve, 95 % by itself."""
        found, values = [], values_of(best)
        for specimen in self.specimens:
            excess = -residuals([specimen], values[None])[0]
            slopes = dict(zip(NAMES, sensitivities([specimen], values, self.steps).mean(axis=1), strict=True))
            slopes["b_bleed"] += 0.0 if free else slopes["b_squeeze"]
            mean = np.array([slopes[name] for name in (ORDER if free else ORDER[:3])])
            error = math.sqrt(scatter**2 / excess.size + float(mean @ covariance @ mean))
            reach = float(student.ppf(0.5 + 0.5 * CONFIDENCE, self.freedom(best))) * error
            value = float(excess.mean())
            found.append(Estimate(value, error, value - reach, value + reach))
        return tuple(found)

    def _residual(self, parameters: lmfit.Parameters) -> FloatArray:
        return np.asarray(residuals(self.specimens, _vector(parameters)[None], self.centred)[0], dtype=float)

    def _slopes(self, parameters: lmfit.Parameters) -> FloatArray:
        slopes = self._by_name(_vector(parameters), tied=parameters["b_squeeze"].expr is not None)
        return np.array([slopes[name] for name in parameters if parameters[name].vary])

    def _by_name(self, values: FloatArray, tied: bool) -> dict[str, FloatArray]:
        """Derivatives (N,) of the thickness by each parameter; if b is tied, b_bleed takes b_squeeze along."""
        slopes = dict(zip(NAMES, sensitivities(self.specimens, values, self.steps, self.centred), strict=True))
        return slopes | ({"b_bleed": slopes["b_bleed"] + slopes["b_squeeze"]} if tied else {})


def values_of(best: Best) -> FloatArray:
    """Parameters (4,) of the least squares in the order of `NAMES`."""
    return _vector(best[1].params)


def _vector(parameters: lmfit.Parameters) -> FloatArray:
    return np.array([parameters[name].value for name in NAMES])


def _profile(best: Best, errors: dict[str, float], confidence: float) -> dict[str, tuple[float, float]]:
    minimizer, result = best
    for name, error in errors.items():
        result.params[name].stderr = error
    found = lmfit.conf_interval(minimizer, result, p_names=list(errors), sigmas=[confidence])
    return {name: (found[name][0][1], found[name][-1][1]) for name in errors}
