"""Common mistakes in DDSDDE: what each would return in place of the right (1/J) d tau / d eps.

The order is Abaqus's, 11, 22, 33, 12, 13, 23, with engineering shears.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_NAMES = ("12", "13", "23")


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


@dataclass(frozen=True)
class Mistake:
    """A mistake: one sentence, and the tangent it would give."""

    sentence: str
    tangent: Callable[[Point], Array]


def jaumann_terms(stress: Array) -> Array:
    """(6, 6): (1/2)(d_ik s_jl + d_il s_jk + d_jk s_il + d_jl s_ik)."""
    s, unit = _matrix(stress), np.eye(3)
    return np.array(
        [
            [
                0.5 * (unit[i, k] * s[j, m] + unit[i, m] * s[j, k] + unit[j, k] * s[i, m] + unit[j, m] * s[i, k])
                for k, m in VOIGT
            ]
            for i, j in VOIGT
        ]
    )


def material_tangent(point: Point) -> Array:
    """dS/dE (6, 6), the right tangent pulled back without its Jaumann terms."""
    inverse = np.linalg.inv(point.deformation_gradient)
    bond = np.array(
        [
            [inverse[i, k] * inverse[j, m] + (inverse[i, m] * inverse[j, k] if k != m else 0.0) for k, m in VOIGT]
            for i, j in VOIGT
        ]
    )
    det_f = float(np.linalg.det(point.deformation_gradient))
    return np.asarray(det_f * bond @ (point.right - jaumann_terms(point.stress)) @ bond.T)


def _matrix(stress: Array) -> Array:
    result = np.zeros((3, 3))
    for value, (i, j) in zip(stress, VOIGT, strict=True):
        result[i, j] = result[j, i] = value
    return result


def _det(point: Point) -> float:
    return float(np.linalg.det(point.deformation_gradient))


def _permutation(order: Sequence[int]) -> Array:
    matrix = np.eye(6)
    matrix[3:, 3:] = np.eye(3)[list(order)]
    return matrix


def _shear_columns(factor: float) -> Callable[[Array], Array]:
    return lambda tangent: tangent * np.array([1.0, 1.0, 1.0, factor, factor, factor])


def _shear_block(tangent: Array) -> Array:
    doubled = np.array(tangent)
    doubled[3:, 3:] *= 2.0
    return doubled


_PUSH: tuple[tuple[str, Callable[[Point], Array]], ...] = (
    ("", lambda p: p.right),
    ("no 1/J: it is the derivative of the Kirchhoff stress, J times too large", lambda p: _det(p) * p.right),
    (
        "no Jaumann terms: (1/2)(d_ik s_jl + d_il s_jk + d_jk s_il + d_jl s_ik) is missing",
        lambda p: p.right - jaumann_terms(p.stress),
    ),
    (
        "neither 1/J nor Jaumann terms: it is the Kirchhoff stress's tangent for the Truesdell (Oldroyd) rate",
        lambda p: _det(p) * (p.right - jaumann_terms(p.stress)),
    ),
    (
        "derivative of the Cauchy stress: s_ij d_kl is missing, what is wanted is that of the Kirchhoff stress over J",
        lambda p: p.right - np.outer(p.stress, [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]),
    ),
    ("material tangent dS/dE, not pushed forward", material_tangent),
    ("transposed: DDSDDE(j,i) in place of DDSDDE(i,j)", lambda p: p.right.T),
    ("symmetrised: only the symmetric part of an unsymmetric tangent", lambda p: (p.right + p.right.T) / 2),
)


def _layouts() -> list[tuple[str, Callable[[Array], Array]]]:
    """What can go wrong in writing the components down."""
    result: list[tuple[str, Callable[[Array], Array]]] = [
        ("", lambda tangent: tangent),
        ("tensor for engineering shear: the shear columns are twice too large", _shear_columns(2.0)),
        ("tensor for engineering shear: the shear stiffnesses are twice too large", _shear_block),
        ("half the shear columns: engineering shears are taken for tensor components", _shear_columns(0.5)),
    ]
    for order in itertools.permutations(range(3)):
        if order == (0, 1, 2):
            continue
        named, matrix = ", ".join(_NAMES[i] for i in order), _permutation(order)
        result.append(
            (
                f"Voigt order of the tangent: shears are in the order {named}, Abaqus wants 12, 13, 23",
                lambda tangent, matrix=matrix: matrix @ tangent @ matrix.T,  # type: ignore[misc]
            )
        )
        result.append(
            (
                f"Voigt order of stress and tangent: shears are in the order {named}, Abaqus wants 12, 13, 23",
                lambda tangent, matrix=matrix: tangent @ matrix.T,  # type: ignore[misc]
            )
        )
    return result


def catalogue() -> list[Mistake]:
    """All mistakes looked for: of the rate, of the components, and one of each together."""
    found = []
    for (rate, push), (written, lay) in itertools.product(_PUSH, _layouts()):
        sentence = "; and ".join(text for text in (rate, written) if text)
        if sentence:
            found.append(Mistake(sentence, lambda p, push=push, lay=lay: lay(push(p))))  # type: ignore[misc]
    return found


def difference(tangent: Array, given: Array) -> float:
    """Largest difference relative to the largest component of `given`."""
    scale = float(np.abs(given).max())
    return float(np.abs(tangent - given).max()) / scale if scale > 0.0 else float(np.abs(tangent).max() > 0.0)
