"""A start for the least squares where the readings give no straight lines: a coarse search over k, a and b."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from plyflow.identify.model import predicted
from plyflow.identify.specimen import Specimen

FloatArray = NDArray[np.float64]
GAPS = (0.004, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3)
POWERS = (-0.97, -0.94, -0.9, -0.85, -0.78, -0.68, -0.5)
LEAST_B, LARGEST_B, HALVINGS = -80.0, 20.0, 12
TIMES = 40


def coarse_start(specimens: Sequence[Specimen], tie: float) -> FloatArray:
    """Parameters (4,) of the smallest misfit over a grid of k and a, b from the last reading of the longest test.

    Parameters
    ----------
    specimens : sequence of Specimen
        The tests.
    tie : float
        b_squeeze - b_bleed.
    """
    ends = [specimen.k_of_limit(_last_eps(specimen)) for specimen in specimens]
    grid = [(min(ends) * math.exp(-gap), power) for gap in GAPS for power in POWERS]
    trials = np.array([[k, a, 0.0, 0.0] for k, a in grid])
    _meet_end(specimens[0], trials, tie)
    misfit = np.zeros(len(trials))
    for specimen in specimens:
        chosen = np.unique(
            np.searchsorted(specimen.time, np.geomspace(1.0, specimen.time.size, TIMES)).clip(
                max=specimen.time.size - 1
            )
        )
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
