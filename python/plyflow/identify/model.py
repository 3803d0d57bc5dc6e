"""What specimens would read if they followed the law: thickness for many trial parameters at once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from plyflow.identify.force import noise_of
from plyflow.identify.specimen import Specimen
from plyflow.law import LawBatch, LawHistory, integrate_batch
from plyflow.law.cycle import integrate_cycle

FloatArray = NDArray[np.float64]
NAMES = ("k", "a", "b_squeeze", "b_bleed")
A_BOUNDS = (-0.9995, 0.99)
COARSE_CHANGE = 0.5  # K a stretch: h/h0 to about 7e-5 while heated, below the noise of a test
STEP = 1e-5
HIDDEN = 4.0
LONGEST = np.array([0.005, 0.01, 0.05, 0.05])
# The coarse search.
GAPS = (0.004, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3)
POWERS = (-0.97, -0.94, -0.9, -0.85, -0.78, -0.68, -0.5)
LEAST_B, LARGEST_B, HALVINGS = -80.0, 20.0, 12
TIMES = 40


def law_batch(specimen: Specimen, parameters: FloatArray) -> LawBatch:
    """The laws of a specimen for parameters (p, 4) in the order of `NAMES`."""
    own = ("l0_over_d", "chi_ratio")
    fixed = {"w0": specimen.geometry.width, "h0": specimen.geometry.h0} | {name: getattr(specimen, name) for name in own}
    columns = {name: np.array(parameters[:, place]) for place, name in enumerate(NAMES)}
    columns["eps_lock"] = np.array([specimen.eps_lock(float(k)) for k in columns["k"]])
    return LawBatch(**columns, **{name: np.full(len(parameters), value) for name, value in fixed.items()})


def predicted(specimen: Specimen, parameters: FloatArray, times: FloatArray | None = None) -> FloatArray:
    """Thickness (p, n) [mm] of a specimen at its readings, or at times (n,) [s]."""
    wanted = specimen.time if times is None else times
    return specimen.geometry.stack * solution(specimen, parameters, wanted).thickness_ratio


def solution(specimen: Specimen, parameters: FloatArray, times: FloatArray) -> LawHistory:
    """The law of a specimen for parameters (p, 4) at times (n,) [s], through a changing temperature where it has one."""
    if specimen.like is None:
        return integrate_batch(law_batch(specimen, parameters), specimen.load, times)
    return integrate_cycle(partial(laws_along, specimen, parameters), specimen.load, times, largest_change=COARSE_CHANGE)


def laws_along(specimen: Specimen, parameters: FloatArray, temperatures: FloatArray) -> LawBatch:
    """The laws (p, t) of a specimen at temperatures (t,) [degC], the parameters moved as in the table of `Specimen.like`."""
    assert specimen.like is not None
    here = vars(specimen.like.at(specimen.geometry.temperature))
    columns = []
    for temperature in temperatures.tolist():
        there, moved = vars(specimen.like.at(temperature)), parameters.copy()
        for place, name in enumerate(NAMES):
            moved[:, place] += there[name] - here[name]
        moved[:, 0] = np.minimum(parameters[:, 0] * there["k"] / here["k"], specimen.largest_k * (1.0 - 1e-9))
        moved[:, 1] = np.clip(moved[:, 1], *A_BOUNDS)
        columns.append(vars(law_batch(specimen, moved)))
    return LawBatch(**{name: np.array([column[name] for column in columns]).T for name in columns[0]})


def residuals(specimens: Sequence[Specimen], parameters: FloatArray, centred: bool = False) -> FloatArray:
    """Predicted less read thickness (p, N) [mm], the resolved readings of all specimens after each other.

    `centred` about the mean of each specimen: what is left when its thickness may have an offset.
    """
    parts = []
    for specimen in specimens:
        used = specimen.resolved
        part = predicted(specimen, parameters, specimen.time[used]) - specimen.thickness[used]
        parts.append(part - part.mean(axis=1, keepdims=True) if centred else part)
    return np.concatenate(parts, axis=1)


def sensitivities(
    specimens: Sequence[Specimen], parameters: FloatArray, steps: FloatArray | None = None, centred: bool = False
) -> FloatArray:
    """Derivatives (4, N) [mm] of the predicted thickness by the parameters (4,), by central differences.

    The thickness is exact to about 1e-13, so the default steps of 1e-5 leave derivatives of eight digits.
    """
    lengths = np.full(len(NAMES), STEP) if steps is None else steps
    moved = np.diag(lengths)
    shifted = residuals(specimens, np.concatenate([parameters + moved, parameters - moved]), centred)
    return np.asarray((shifted[: len(NAMES)] - shifted[len(NAMES) :]) / (2.0 * lengths[:, None]), dtype=float)


def steps_over_kinks(specimens: Sequence[Specimen], parameters: FloatArray) -> FloatArray:
    """Steps (4,) for `sensitivities` as long as the noise hides.

    At the lock the rate jumps, so the thickness read at a given time has a kink in every parameter that moves the lock
    past it; over a step that moves the lock by several readings the kinks average out.
    """
    lengths = np.linalg.norm(sensitivities(specimens, parameters), axis=1)
    hidden = HIDDEN * reading_noise(specimens) / np.maximum(lengths, 1e-30)
    return np.asarray(np.clip(hidden, STEP, LONGEST), dtype=float)


def reading_noise(specimens: Sequence[Specimen]) -> float:
    """Noise of the thickness readings [mm]."""
    return max(noise_of(specimen.thickness) for specimen in specimens)


def squeeze_readings(specimens: Sequence[Specimen], parameters: FloatArray) -> int:
    """Number of readings after the load began and before the ply locked, for parameters (4,)."""
    count = 0
    for specimen in specimens:
        times = specimen.time[specimen.resolved]
        found = solution(specimen, parameters[None], times)
        count += int(np.sum(~found.locked[0] & (found.eps[0] < 0.0)))
    return count


def coarse_start(specimens: Sequence[Specimen], tie: float) -> FloatArray:
    """Parameters (4,) of the smallest misfit over a grid of k and a, b from the last reading of the longest test.

    Parameters
    ----------
    specimens : sequence of Specimen
        The tests.
    tie : float
        b_squeeze - b_bleed.
    """
    widest = min(specimen.k_of_limit(_last_eps(specimen)) for specimen in specimens)
    grid = [(widest * math.exp(-gap), power) for gap in GAPS for power in POWERS]
    trials = np.array([[k, a, 0.0, 0.0] for k, a in grid])
    _meet_end(specimens[0], trials, tie)
    misfit = np.zeros(len(trials))
    for specimen in specimens:
        places = np.searchsorted(specimen.time, np.geomspace(1.0, specimen.time.size, TIMES))
        chosen = np.unique(places.clip(max=specimen.time.size - 1))
        times = specimen.time[chosen]
        misfit += np.sum((predicted(specimen, trials, times) - specimen.thickness[chosen]) ** 2, axis=1)
    return np.asarray(trials[int(np.argmin(misfit))], dtype=float)


def _last_eps(specimen: Specimen) -> float:
    """Compaction at the end, from the last twentieth of the readings."""
    return float(np.mean(specimen.eps[-max(specimen.time.size // 20, 1) :]))


def _meet_end(specimen: Specimen, trials: FloatArray, tie: float) -> None:
    """Set b of trials (p, 4) such that each ends at the thickness read last, by halving."""
    low, high = np.full(len(trials), LEAST_B), np.full(len(trials), LARGEST_B)
    wanted = specimen.geometry.stack * math.exp(_last_eps(specimen))
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        trials[:, 2], trials[:, 3] = middle + tie, middle
        thick = predicted(specimen, trials, np.array([specimen.load.end]))[:, 0] > wanted
        high, low = np.where(thick, middle, high), np.where(thick, low, middle)
