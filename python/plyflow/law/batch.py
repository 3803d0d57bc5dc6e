"""Constants of many one-dimensional laws at once, one array a constant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from plyflow.errors import InputError
from plyflow.law.equations import LawParameters

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class LawBatch:
    """Constants of n laws; units and bounds as in `LawParameters`, each an array of one common shape.

    Build it with `batch`, which has the bounds checked law by law.
    """

    w0: FloatArray
    h0: FloatArray
    l0_over_d: FloatArray
    k: FloatArray
    a: FloatArray
    b_squeeze: FloatArray
    b_bleed: FloatArray
    eps_lock: FloatArray
    chi_ratio: FloatArray

    @property
    def size(self) -> int:
        """Number of laws."""
        return int(self.k.size)

    @property
    def eps_limit(self) -> FloatArray:
        """Compaction limit, as `LawParameters.eps_limit`."""
        return np.asarray(np.log(self.k) + 0.5 * np.log(self.chi_ratio) + self.eps_lock, dtype=float)

    @property
    def rate_exponent(self) -> FloatArray:
        """1/(a+1) (n,)."""
        return np.asarray(1.0 / (self.a + 1.0), dtype=float)

    def take(self, chosen: NDArray[np.intp] | NDArray[np.bool_]) -> LawBatch:
        """The laws at some places."""
        return LawBatch(**{field.name: getattr(self, field.name)[chosen] for field in fields(self)})

    def against(self, axes: int) -> LawBatch:
        """The same laws with so many axes of length 1 appended, to broadcast against arrays (n, ...)."""
        shape = (self.size, *(1 for _ in range(axes)))
        return LawBatch(**{field.name: getattr(self, field.name).reshape(shape) for field in fields(self)})


def batch(laws: Sequence[LawParameters]) -> LawBatch:
    """Collect laws into arrays (n,).

    Raises
    ------
    InputError
        There is none, or one has a >= 1: it would reach the compaction limit in a finite time.
    """
    if not laws:
        raise InputError("no laws given: give at least one")
    steepest = max(law.a for law in laws)
    if steepest >= 1.0:
        raise InputError(f"a = {steepest:g} must be below 1: above, the compaction limit is reached in a finite time")
    names = [field.name for field in fields(LawBatch)]
    return LawBatch(**{name: np.array([getattr(law, name) for law in laws], dtype=float) for name in names})
