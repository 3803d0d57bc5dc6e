"""Common mistakes in DDSDDE: what each would return in place of the right (1/J) d tau / d eps.

The order is Abaqus's, 11, 22, 33, 12, 13, 23, with engineering shears.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
COMPONENTS = ("11", "22", "33", "12", "13", "23")
RIGHT = 1e-5  # differences of a smooth stress agree to about 1e-8 of the largest component
FITS = 1e-2
CLEARLY_BETTER = 20.0
AS_GOOD = 3.0


@dataclass(frozen=True)
class Point:
    """What is known where DDSDDE was checked.

    Parameters
    ----------
    deformation_gradient : (3, 3) at the end of the increment.
    stress : (6,) Cauchy stress as the UMAT returned it, MPa.
    right, given : (6, 6) tangent by differences, and DDSDDE as returned, MPa.
    """

    deformation_gradient: Array
    stress: Array
    right: Array
    given: Array

    @property
    def det_f(self) -> float:
        """Volume ratio J."""
        return float(np.linalg.det(self.deformation_gradient))


@dataclass(frozen=True)
class Mistake:
    """A mistake: one sentence, and the tangent it would give."""

    sentence: str
    tangent: Callable[[Point], Array]


def jaumann_terms(stress: Array) -> Array:
    """(6, 6): (1/2)(d_ik s_jl + d_il s_jk + d_jk s_il + d_jl s_ik)."""
    s, unit = np.zeros((3, 3)), np.eye(3)
    for value, (i, j) in zip(stress, VOIGT, strict=True):
        s[i, j] = s[j, i] = value
    return _voigt(
        lambda i, j, k, m: 0.5 * (unit[i, k] * s[j, m] + unit[i, m] * s[j, k] + unit[j, k] * s[i, m] + unit[j, m] * s[i, k])
    )


def material_tangent(point: Point) -> Array:
    """dS/dE (6, 6), the right tangent pulled back without its Jaumann terms."""
    f = np.linalg.inv(point.deformation_gradient)
    bond = _voigt(lambda i, j, k, m: f[i, k] * f[j, m] + (f[i, m] * f[j, k] if k != m else 0.0))
    return np.asarray(point.det_f * bond @ (point.right - jaumann_terms(point.stress)) @ bond.T)


def _voigt(term: Callable[[int, int, int, int], float]) -> Array:
    return np.array([[term(i, j, k, m) for k, m in VOIGT] for i, j in VOIGT])


_RATES: tuple[tuple[str, Callable[[Point], Array]], ...] = (
    ("", lambda p: p.right),
    ("no 1/J: it is the derivative of the Kirchhoff stress, J times too large", lambda p: p.det_f * p.right),
    (
        "no Jaumann terms: (1/2)(d_ik s_jl + d_il s_jk + d_jk s_il + d_jl s_ik) is missing",
        lambda p: p.right - jaumann_terms(p.stress),
    ),
    (
        "neither 1/J nor Jaumann terms: it is the Kirchhoff stress's tangent for the Truesdell (Oldroyd) rate",
        lambda p: p.det_f * (p.right - jaumann_terms(p.stress)),
    ),
    (
        "derivative of the Cauchy stress: s_ij d_kl is missing, what is wanted is that of the Kirchhoff stress over J",
        lambda p: p.right - np.outer(p.stress, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]),
    ),
    ("material tangent dS/dE, not pushed forward", material_tangent),
    ("transposed: DDSDDE(j,i) in place of DDSDDE(i,j)", lambda p: p.right.T),
    ("symmetrised: only the symmetric part of an unsymmetric tangent", lambda p: (p.right + p.right.T) / 2),
)


def _factors(columns: float, block: float) -> Array:
    """Factors on the components: of the shear columns, and of the shear stiffnesses among them."""
    result = np.ones((6, 6))
    result[:3, 3:], result[3:, 3:] = columns, block
    return result


# What can go wrong in writing the components down: factors on them, order of the rows, order of the columns.
_LAYOUTS: list[tuple[str, Array, Sequence[int], Sequence[int]]] = [
    (text, _factors(*factors), range(6), range(6))
    for text, factors in (
        ("", (1.0, 1.0)),
        ("tensor for engineering shear: the shear columns are twice too large", (2.0, 2.0)),
        ("tensor for engineering shear: the shear stiffnesses are twice too large", (1.0, 2.0)),
        ("half the shear columns: engineering shears are taken for tensor components", (0.5, 0.5)),
    )
] + [
    (
        f"Voigt order of {what}: shears are in the order {', '.join(COMPONENTS[i] for i in order)}, Abaqus wants 12, 13, 23",
        np.ones((6, 6)),
        [0, 1, 2, *(order if rows else (3, 4, 5))],
        [0, 1, 2, *order],
    )
    for order in itertools.permutations((3, 4, 5))
    if order != (3, 4, 5)
    for what, rows in (("the tangent", True), ("stress and tangent", False))
]


def _written(push: Callable[[Point], Array], factors: Array, places: tuple[NDArray[Any], ...], point: Point) -> Array:
    return np.asarray((factors * push(point))[places])


def catalogue() -> list[Mistake]:
    """All mistakes looked for: of the rate, of the components, and one of each together."""
    found = []
    for (rate, push), (written, factors, rows, columns) in itertools.product(_RATES, _LAYOUTS):
        sentence = "; and ".join(text for text in (rate, written) if text)
        if sentence:
            found.append(Mistake(sentence, partial(_written, push, factors, np.ix_(rows, columns))))
    return found


def difference(tangent: Array, given: Array) -> float:
    """Largest difference relative to the largest component of `given`."""
    scale = float(np.abs(given).max())
    return float(np.abs(tangent - given).max()) / scale if scale > 0.0 else float(np.abs(tangent).max() > 0.0)


def fitting_mistakes(points: Sequence[Point], as_given: float) -> tuple[list[str], float | None]:
    """Sentences of the mistakes that explain DDSDDE in all points, best first, and what the best leaves.

    Several are named when they cannot be told apart by these points.
    """
    ranked = sorted(
        (max(difference(mistake.tangent(point), point.given) for point in points), number, mistake.sentence)
        for number, mistake in enumerate(catalogue())
    )
    best = ranked[0][0]
    if best > FITS or best * CLEARLY_BETTER > as_given:
        return [], None
    as_good = [sentence for left, _, sentence in ranked if left <= max(AS_GOOD * best, RIGHT)]
    simplest = min(sentence.count("; and ") for sentence in as_good)
    return [sentence for sentence in as_good if sentence.count("; and ") == simplest], best
