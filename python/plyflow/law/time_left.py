"""How long a ply takes from where it is to near its compaction limit, which it never reaches, if all stays as it is."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from plyflow.law.equations import LawBatch, Stage
from plyflow.law.integration import LARGEST_LOG
from plyflow.law.stage_curve import curve_to

FloatArray = NDArray[np.float64]
NEAR_LIMIT = 0.01  # of the limit thickness


def time_left(law: LawBatch, eps: FloatArray, locked: NDArray[np.bool_], pressure: FloatArray) -> FloatArray:
    """Time (n,) [s] until a ply is within 1 % of its limit thickness, at the temperature and pressure of the moment.

    0 if it is there, or beyond a limit that cooling has raised; infinite without pressure.

    law: constants (n,) of the moment; eps (n,) [-]; locked (n,); pressure (n,) [MPa].
    """
    near = math.log1p(NEAR_LIMIT)
    left = np.where(eps - law.eps_limit <= near, 0.0, math.inf)
    squeezing = ~locked & (eps > law.eps_lock)
    begin = np.where(squeezing, law.eps_lock, eps)
    for stage, top, bottom in (
        (Stage.SQUEEZE, eps, np.maximum(law.eps_lock, law.eps_limit + near)),
        (Stage.BLEED, begin, law.eps_limit + near),
    ):
        rows = np.flatnonzero((left > 0.0) & (pressure > 0.0) & (squeezing | (stage is Stage.BLEED)) & (top > bottom))
        if not rows.size:
            continue
        own = law.each(lambda values, at=rows: values[at])  # type: ignore[misc]
        start, end = (np.log(one[rows] - own.eps_limit) for one in (top, bottom))
        curve = curve_to(own, stage, np.log(pressure[rows]), start, end)
        before = np.where(np.isinf(left[rows]), 0.0, left[rows])
        left[rows] = before + np.exp(np.minimum(curve.log_theta[:, -1], LARGEST_LOG))
    return left
