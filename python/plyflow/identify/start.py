"""Where the least squares start, and whether the readings tell b_squeeze."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from plyflow.errors import InputError
from plyflow.identify.lines import LineFit, fit_lines
from plyflow.identify.model import NAMES, coarse_start, reading_noise, residuals, sensitivities, squeeze_readings
from plyflow.identify.specimen import Specimen
from plyflow.law import Stage

FloatArray = NDArray[np.float64]
# The paper prints b to 0.01, and so is the tie known.
TIE_ROUNDING = 0.01
# b_squeeze is fitted when the readings fix it to better than the tie, or to better than this with enough of them.
LARGEST_B_ERROR, ENOUGH_READINGS = 0.25, 10


def straight_lines(specimens: Sequence[Specimen]) -> tuple[LineFit | None, tuple[str, ...]]:
    """Section 3.2, None where there are too few points or the temperature changes, and a note then."""
    if any(specimen.like is not None for specimen in specimens):
        return None, ("no straight lines through a changing temperature; the least squares started from the table it follows",)
    try:
        return fit_lines(specimens), ()
    except InputError as error:
        return None, (f"{error}; the least squares started from a coarse search",)


def first_values(specimens: Sequence[Specimen], lines: LineFit | None, offset: float, centred: bool) -> FloatArray:
    """The better of the straight lines and the coarse search; the table that a changing temperature follows."""
    for specimen in specimens:
        if specimen.like is not None:
            column = vars(specimen.like.at(specimen.geometry.temperature))
            return np.array([column["k"], column["a"], column["b_bleed"] + offset, column["b_bleed"]])
    starts = [coarse_start(specimens, offset)]
    if lines is not None:
        line = lines.lines.get(Stage.BLEED)
        if line is not None and -1.0 < line.a < 0.9:
            starts.append(np.array([lines.k, line.a, line.b + offset, line.b]))
    misfit = np.sum(residuals(specimens, np.array(starts), centred) ** 2, axis=1)
    return starts[int(np.argmin(misfit))]


def readings_tell(specimens: Sequence[Specimen], values: FloatArray, centred: bool) -> bool:
    """Whether the readings, rather than the tie, should say what b_squeeze is.

    A single reading before the lock does not suffice: the time of the lock is too crooked a function of b_squeeze.
    """
    slopes = sensitivities(specimens, values, centred=centred)
    rows = slopes[[NAMES.index(name) for name in ("b_squeeze", "k", "a", "b_bleed")]]
    rest = rows[0] - rows[1:].T @ np.linalg.lstsq(rows[1:].T, rows[0], rcond=None)[0]
    left = float(np.linalg.norm(rest))
    # The standard error b_squeeze would have if all four parameters were fitted, by the noise of the readings.
    error = reading_noise(specimens) / left if left > 1e-9 * np.linalg.norm(rows[3]) else math.inf
    return error < TIE_ROUNDING or (error < LARGEST_B_ERROR and squeeze_readings(specimens, values) >= ENOUGH_READINGS)
