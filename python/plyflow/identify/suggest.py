"""Which next test would narrow the intervals most: Fisher's information of tests that have not been made.

Derivatives of the thickness are central differences of the quadrature, which is exact to about 1e-13: eight digits of them hold.
The law and the noise are taken as the fit found them; where a test would tell b_squeeze, it is taken as fitted then, as `fit` does.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import t as student

from plyflow.case.programme import LOADS, load_programme, paper_programme, plies_in_block
from plyflow.identify.model import NAMES, predicted, sensitivities, squeeze_readings, steps_over_kinks
from plyflow.identify.refine import CONFIDENCE, ORDER, Fit
from plyflow.identify.specimen import Specimen
from plyflow.identify.start import ENOUGH_READINGS, LARGEST_B_ERROR, TIE_ROUNDING
from plyflow.law import LoadProgramme

FloatArray = NDArray[np.float64]
LENGTHS = (0.5, 1.0, 2.0)  # of the paper's programme
MOST_READINGS = 4000


@dataclass(frozen=True)
class Suggestion:
    """A test not made yet: what it is, and half the joint interval of each fitted parameter before and with it.

    ratio: geometric mean over the parameters of the second to the first; length [s].
    """

    temperature: float
    layup: str
    width: float
    load: str
    length: float
    now: dict[str, float]
    then: dict[str, float]

    @property
    def ratio(self) -> float:
        """How much narrower the intervals become, all parameters together."""
        return math.exp(float(np.mean([math.log(self.then[name] / self.now[name]) for name in self.now])))

    def row(self) -> dict[str, object]:
        """Plain data, a column a number."""
        told = {name: value for name, value in vars(self).items() if name not in ("now", "then")}
        return told | {"ratio": self.ratio} | {f"half_{name}": value for name, value in self.then.items()}


def suggestions(fits: Sequence[Fit]) -> list[Suggestion]:
    """All tests that the paper's specimens and programmes allow, at the temperatures of the fits, the best first."""
    return sorted((one for found in fits for one in _of_fit(found)), key=lambda one: one.ratio)


def suggestion_table(found: Sequence[Suggestion]) -> pd.DataFrame:
    """A row a test."""
    return pd.DataFrame([one.row() for one in found])


def _of_fit(found: Fit) -> Iterator[Suggestion]:
    programme, steps = paper_programme(), steps_over_kinks(found.specimens, found.values)
    readings = sum(int(np.count_nonzero(one.resolved)) for one in found.specimens)
    squeezing = squeeze_readings(found.specimens, found.values)
    now = _half_widths(information(found, found.specimens, steps), readings, found.tied)
    widths = [specimen.width for specimen in programme.specimen]
    for layup, width, load, length in product(programme.plies_per_block, widths, LOADS, LENGTHS):
        if found.specimens[0].geometry.plies % plies_in_block(layup):
            continue
        test = candidate(found, layup, width, load, length * programme.total_time)
        together = [*found.specimens, test]
        both = information(found, together, steps_over_kinks(together, found.values))
        tied = found.tied and not _tells(both, squeezing + squeeze_readings([test], found.values))
        then = _half_widths(both, readings + test.time.size, tied)
        yield Suggestion(test.geometry.temperature, layup, width, load, test.load.end, now, then)


def _tells(known: FloatArray, squeezing: int) -> bool:
    """Whether b_squeeze would be fitted with an information (4, 4) and so many readings before the lock; see `refine.fit`."""
    error = math.sqrt(max(float(np.linalg.pinv(known, rcond=1e-15, hermitian=True)[3, 3]), 0.0))
    return bool(error < TIE_ROUNDING or (error < LARGEST_B_ERROR and squeezing >= ENOUGH_READINGS))


def candidate(found: Fit, layup: str, width: float, load: str, length: float) -> Specimen:
    """A test of a length [s], as the fitted law says that it would read, with readings as often as there are."""
    first = found.specimens[0]
    paper = load_programme(load, width)
    scale = length / paper.end
    slow = LoadProgramme(tuple(time * scale for time in paper.times), paper.pressures)
    every = max(float(np.median(np.diff(first.time))), length / MOST_READINGS)
    geometry = replace(first.geometry, width=width, plies_per_block=float(plies_in_block(layup)))
    times = np.linspace(0.0, slow.end, round(slow.end / every) + 1)
    test = replace(
        first, name=f"{layup} {width:g} mm {load}", geometry=geometry, time=times, thickness=np.zeros(times.size), width=None,
        load=slow, like=None, notes=(),
    )  # fmt: skip
    return replace(test, thickness=predicted(test, found.values[None])[0])


def information(found: Fit, specimens: Sequence[Specimen], steps: FloatArray) -> FloatArray:
    """Fisher's information (4, 4) of readings about the parameters in the order of `ORDER`, none of them tied."""
    slopes = dict(zip(NAMES, sensitivities(specimens, found.values, steps, bool(found.offsets)), strict=True))
    rows = np.array([slopes[name] for name in ORDER])
    return np.asarray(rows @ rows.T / found.scatter**2, dtype=float)


def _half_widths(known: FloatArray, readings: int, tied: bool) -> dict[str, float]:
    """Half the joint interval of k, a and b_bleed for an information (4, 4); `tied`: b_bleed takes b_squeeze along."""
    if tied:
        along = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]])
        known = along.T @ known @ along
    names = ORDER[: len(known)]
    confidence = 1.0 - (1.0 - CONFIDENCE) / len(names)
    reach = float(student.ppf(0.5 + 0.5 * confidence, readings - len(names)))
    spread = np.sqrt(np.maximum(np.diag(np.linalg.pinv(known, rcond=1e-15, hermitian=True)), 0.0))
    return dict(zip(ORDER[:3], (reach * spread[:3]).tolist(), strict=True))
