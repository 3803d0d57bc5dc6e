"""One stage of many laws by quadrature: the clock reading theta at which each compaction is reached.

The law separates:  theta(eps) = integral over -eps of (eta exp(b) / p_peak)^m.  With y = ln(eps - eps_limit)
the logarithm of the integrand is smooth and nearly straight, so panels over which it rises by about one and
six Gauss points in each give theta to rounding. Everything is kept as a logarithm: the integrand spans
tens of orders of magnitude.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plyflow.errors import RunError
from plyflow.law.equations import LawBatch, Stage, log_viscosity, log_viscosity_slope

FloatArray = NDArray[np.float64]
ABSCISSAE, WEIGHTS = np.polynomial.legendre.leggauss(6)
POINTS, LOG_WEIGHTS = 0.5 * (ABSCISSAE + 1.0), np.log(0.5 * WEIGHTS)
FEWEST_PANELS, MOST_PANELS, RISE_A_PANEL = 8, 50_000, 1.0
HALLEY_STEPS = 1
MOST_EXTENSIONS = 60
ESTIMATE_STEPS = 6
SMALLEST_THETA = 1e-300


@dataclass(frozen=True)
class StageCurve:
    """Compaction against clock reading for n laws within one stage.

    law: constants (n,); log_peak (n,) = ln p_peak [ln MPa]; y (n, panels + 1) falls from the start of the stage;
    log_theta (n, panels + 1) [ln s] rises from -inf there.
    """

    law: LawBatch
    stage: Stage
    log_peak: FloatArray
    y: FloatArray
    log_theta: FloatArray

    def eps_at(self, theta: FloatArray) -> FloatArray:
        """Compaction (n, t) [-] at clock readings (n, t) [s] since the start of the stage."""
        log_wanted = np.minimum(np.log(np.maximum(theta, SMALLEST_THETA)), self.log_theta[:, -1:])
        panel = np.empty(log_wanted.shape, dtype=np.intp)
        for row, marks in enumerate(self.log_theta):
            panel[row] = np.searchsorted(marks, log_wanted[row], side="right") - 1
        panel = np.clip(panel, 0, self.y.shape[1] - 2)
        start, end = (np.take_along_axis(self.y, place, axis=1) for place in (panel, panel + 1))
        passed = np.take_along_axis(self.log_theta, panel, axis=1)
        y = np.clip(self._first_guess(log_wanted, panel, start, end), end, start)
        for _ in range(HALLEY_STEPS):
            y = np.clip(self._halley(y, log_wanted, passed, start), end, start)
        return np.asarray(self.law.against(1).eps_limit + np.exp(y), dtype=float)

    def _first_guess(
        self, log_wanted: FloatArray, panel: NDArray[np.intp], start: FloatArray, end: FloatArray
    ) -> FloatArray:
        """Cubic through both ends of the panel in the variable w = ln(1 + theta / theta_0)."""
        log_theta_0 = (
            self._log_integrand(self.y[:, :1, None])[:, 0] - np.log(_rise(self.law, self.stage, self.y[:, 0]))[:, None]
        )
        w = np.logaddexp(0.0, self.log_theta - log_theta_0)
        slopes = -np.exp(log_theta_0 + w - self._log_integrand(self.y[..., None])[..., 0])
        low, high = (np.take_along_axis(w, place, axis=1) for place in (panel, panel + 1))
        width = high - low
        place = (np.logaddexp(0.0, log_wanted - log_theta_0) - low) / width
        rest = 1.0 - place
        first, last = (width * np.take_along_axis(slopes, side, axis=1) for side in (panel, panel + 1))
        return np.asarray(
            (start * (1.0 + 2.0 * place) + first * place) * rest**2
            + (end * (1.0 + 2.0 * rest) - last * rest) * place**2,
            dtype=float,
        )

    def _halley(self, y: FloatArray, log_wanted: FloatArray, passed: FloatArray, start: FloatArray) -> FloatArray:
        """One step of third order of theta(y) = wanted; the integrand's slope is known."""
        log_theta = np.logaddexp(passed, self._log_integral(start, y))
        reach = np.exp(log_theta - self._log_integrand(y[..., None])[..., 0])
        step = -reach * np.expm1(np.minimum(log_wanted - log_theta, 1.0))
        slope = 1.0 - _rise(self.law.against(1), self.stage, y)
        return np.asarray(y + step / np.maximum(1.0 + 0.5 * step * slope, 0.5), dtype=float)

    def _log_integral(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """Logarithm of the integral of the integrand from end up to start, arrays (n, t)."""
        length = start - end
        terms = self._log_integrand(start[..., None] - length[..., None] * POINTS) + LOG_WEIGHTS
        largest = terms.max(axis=-1)
        with np.errstate(divide="ignore"):
            return np.asarray(
                largest + np.log(np.exp(terms - largest[..., None]).sum(axis=-1)) + np.log(length), dtype=float
            )

    def _log_integrand(self, y: FloatArray) -> FloatArray:
        """Logarithm of -d theta/d y, y (n, t, q)."""
        law = self.law.against(2)
        resistance = log_viscosity(law.eps_limit + np.exp(y), law, self.stage) - self.log_peak[:, None, None]
        return np.asarray(law.rate_exponent * resistance + y, dtype=float)


def curve_to(law: LawBatch, stage: Stage, log_peak: FloatArray, start: FloatArray, end: FloatArray) -> StageCurve:
    """Tabulate a stage of n laws between y = start (n,) and y = end (n,) < start, under peak pressures (n,) [ln MPa].

    Raises
    ------
    RunError
        A law rises by so much within the stage that it is of no ply.
    """
    rise = float(np.max(_steepness(law, stage, start) * (start - end)))
    if not rise <= MOST_PANELS * RISE_A_PANEL:
        raise RunError(
            f"the one-dimensional law cannot be followed: among its constants are a down to {np.min(law.a):.6g}, k up to "
            f"{np.max(law.k):.6g} and b_bleed from {np.min(law.b_bleed):.6g} to {np.max(law.b_bleed):.6g}"
        )
    panels = max(FEWEST_PANELS, int(np.ceil(rise / RISE_A_PANEL)))
    y = start[:, None] - (start - end)[:, None] * np.linspace(0.0, 1.0, panels + 1)
    empty = StageCurve(law, stage, log_peak, y, np.full_like(y, -np.inf))
    gains = empty._log_integral(y[:, :-1], y[:, 1:])
    log_theta = np.concatenate([np.full((len(y), 1), -np.inf), np.logaddexp.accumulate(gains, axis=1)], axis=1)
    return StageCurve(law, stage, log_peak, y, log_theta)


def curve_until(
    law: LawBatch, stage: Stage, log_peak: FloatArray, start: FloatArray, log_theta: FloatArray
) -> StageCurve:
    """Tabulate a stage from y = start (n,) until the clock shows at least log_theta (n,) [ln s].

    Raises
    ------
    RunError
        A law could not be followed so far.
    """
    end = start - _depth(law, stage, log_peak, start, log_theta)
    for _ in range(MOST_EXTENSIONS):
        curve = curve_to(law, stage, log_peak, start, end)
        missing = log_theta - curve.log_theta[:, -1]
        if np.all(missing <= 0.0):
            return curve
        # The logarithm of the clock reading rises at least by 2 m - 1 for each unit of y.
        slowest = np.maximum(2.0 * law.rate_exponent - 1.0, 1e-2)
        end = np.where(missing > 0.0, end - (missing + 0.1) / slowest, end)
    raise RunError("the one-dimensional law could not be followed to the end of the load")


def _depth(law: LawBatch, stage: Stage, log_peak: FloatArray, start: FloatArray, log_theta: FloatArray) -> FloatArray:
    """Estimate how far below start (n,) the clock shows log_theta (n,): where integrand / slope does."""
    one = StageCurve(law, stage, log_peak, start[:, None], start[:, None])
    y = start - 0.1 / _steepness(law, stage, start)
    for _ in range(ESTIMATE_STEPS):
        slope = _steepness(law, stage, y)
        missing = log_theta - (one._log_integrand(y[:, None, None])[:, 0, 0] - np.log(slope))
        y = np.minimum(y + np.maximum(-missing, -40.0) / slope, start - 0.02 / slope)
    return np.asarray(start - y + 0.2 / _steepness(law, stage, y), dtype=float)


def _steepness(law: LawBatch, stage: Stage, y: FloatArray) -> FloatArray:
    """Slope (n,) of the integrand's logarithm by -y, largest at the start of the stage; at least one."""
    return np.maximum(_rise(law, stage, y), 1.0)


def _rise(law: LawBatch, stage: Stage, y: FloatArray) -> FloatArray:
    """Rise (n,) of m ln(eta exp(b)) by -y."""
    gap = np.exp(y)
    return np.asarray(-law.rate_exponent * log_viscosity_slope(law.eps_limit + gap, law, stage) * gap, dtype=float)
