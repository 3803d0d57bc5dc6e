"""Combinations of generators and fourth-order tensors to components in Abaqus's order 11, 22, 33, 12, 13, 23."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import sympy as sp

from umatgen.lower.assign import Assignment, element
from umatgen.model.generators import C_INVERSE, C_RATE, FIBRE, FIBRE_C, ONE, VOIGT, Generator, odot
from umatgen.model.stress import Combination
from umatgen.model.tangent import FourthOrder
from umatgen.notation import sym


def component(generator: Generator, index: int) -> sp.Expr:
    """Voigt component (0-based) of the spatial form of a generator: an array element, or 0/1 of the unit tensor."""
    if generator == C_INVERSE:
        return sp.Integer(1 if index < 3 else 0)
    return element(f"{generator.key}({index + 1})")


def material_component(generator: Generator, index: int, fibre: tuple[int, int, int]) -> sp.Expr:
    """Voigt component (0-based) of the material form; `fibre` are the axes (1-based) of n, p2, p3."""
    i, j = (axis + 1 for axis in VOIGT[index])
    n, m2, _ = fibre
    if generator == ONE:
        return sp.Integer(int(i == j))
    if generator == FIBRE:
        return sp.Integer(int(i == j == n))
    if generator == C_RATE:
        return element(f"{C_RATE.key.replace('y_rate', 'cdot')}({index + 1})")
    if generator == FIBRE_C and n in (i, j):
        other = j if i == n else i
        return 2 * sym("i4")[0] if other == n else sym("c12" if other == m2 else "c13")[0]
    return sp.S.Zero


def matrix(array: str) -> sp.Matrix:
    """3x3 matrix of array elements of a symmetric tensor in Voigt order."""
    result = sp.zeros(3, 3)
    for index, (i, j) in enumerate(VOIGT):
        result[i, j] = result[j, i] = element(f"{array}({index + 1})")
    return result


def combination(target: str, terms: Mapping[Generator, sp.Expr], scale: sp.Expr = sp.S.One) -> list[Assignment]:
    """Assignments target(1..6) = scale * sum of coefficient * generator."""
    return [
        Assignment(
            f"{target}({index + 1})",
            sp.Add(*(scale * coefficient * component(generator, index) for generator, coefficient in terms.items())),
        )
        for index in range(6)
    ]


def right_factors(tensor: FourthOrder, scale: sp.Expr) -> tuple[dict[Generator, str], list[Assignment]]:
    """One array per left generator that holds all it is multiplied with: sum of dyads = sum of left (x) right array."""
    names: dict[Generator, str] = {}
    body: list[Assignment] = []
    for left, row in tensor.dyads.items():
        names[left] = f"right_{left.key}"
        body += combination(names[left], row, scale)
    return names, body


def grouped_products(tensor: FourthOrder) -> dict[Generator, Combination]:
    """The products A (.) B with those that share a factor brought together: A (.) (sum of coefficient * B)."""
    counts: dict[Generator, int] = {}
    for pair in tensor.products:
        for generator in set(pair):
            counts[generator] = counts.get(generator, 0) + 1
    groups: dict[Generator, Combination] = {}
    for (first, second), coefficient in tensor.products.items():
        shared, other = (first, second) if counts[first] >= counts[second] else (second, first)
        row = groups.setdefault(shared, {})
        row[other] = row.get(other, sp.S.Zero) + coefficient
    return groups


def symmetric_part(
    products: Mapping[Generator, str], dyads: Mapping[Generator, str], target: str = "ddsdde"
) -> list[Assignment]:
    """Upper triangle of sum of 2 A (.) B_array + sum of left (x) right_array (a symmetric total).

    The arrays hold half of B: most components of A (.) B are then sums of plain products.
    """
    body: list[Assignment] = []
    factors = {g: (_factor_matrix(g), 2 * matrix(name)) for g, name in products.items()}
    for row, (i, j) in enumerate(VOIGT):
        for column in range(row, 6):
            k, m = VOIGT[column]
            terms = [odot(a, b, i, j, k, m) for a, b in factors.values()]
            terms += [component(left, row) * element(f"{name}({column + 1})") for left, name in dyads.items()]
            body.append(Assignment(f"{target}({row + 1},{column + 1})", _halves_together(sp.Add(*terms))))
    return body


def _factor_matrix(generator: Generator) -> sp.Matrix:
    return sp.eye(3) if generator == C_INVERSE else matrix(generator.key)


def _halves_together(expr: sp.Expr) -> sp.Expr:
    """Terms with the factor 1/2 gathered in one bracket."""
    half = sp.Rational(1, 2)
    halves = [t for t in sp.Add.make_args(expr) if t.as_coeff_Mul()[0] == half]
    if len(halves) < 2:
        return expr
    return sp.Add(expr - sp.Add(*halves), sp.Mul(half, 2 * sp.Add(*halves), evaluate=False), evaluate=False)


def with_dyad(upper: Iterable[Assignment], left: str, right: str, symmetric: bool, target: str = "ddsdde") -> list[Assignment]:
    """Both triangles from the upper one, with left (x) right added, which need not be symmetric, or its symmetric part."""
    body: list[Assignment] = []
    for assignment in upper:
        row, column = (int(n) for n in assignment.target[len(target) + 1 : -1].split(","))
        dyad, turned = (element(f"{left}({i})") * element(f"{right}({j})") for i, j in ((row, column), (column, row)))
        if symmetric:
            dyad = turned = (dyad + turned) / 2
        if row == column:
            body.append(Assignment(assignment.target, assignment.expr + dyad))
            continue
        shared = f"both_{row}{column}"
        body.append(Assignment(shared, assignment.expr + (dyad if symmetric else 0)))
        body += [
            Assignment(assignment.target, element(shared) + (0 if symmetric else dyad)),
            Assignment(f"{target}({column},{row})", element(shared) + (0 if symmetric else turned)),
        ]
    return body
