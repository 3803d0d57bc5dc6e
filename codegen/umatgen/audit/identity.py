"""Whether two values are equal: the symbolic difference reduced to zero, or shown not to be zero, with a 30-digit witness."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import sympy as sp

from umatgen.audit.points import DIGITS, admissible_points
from umatgen.printed.formula import Value

Point = dict[sp.Symbol, sp.Rational]
_GUARD = 20
_AGREE = sp.Float(10) ** -(DIGITS - 2)


class UndecidedError(ArithmeticError):
    """A difference vanishes at every witness point but was not reduced to zero symbolically."""


@dataclass(frozen=True)
class Witness:
    """The two values at one admissible point: worst component, 30 digits.

    `difference` is relative to the larger of the two.
    """

    point: Point
    printed: sp.Number
    derived: sp.Number
    difference: sp.Float


@dataclass(frozen=True)
class Identity:
    """Outcome of a comparison.

    Parameters
    ----------
    holds : whether the symbolic difference is zero.
    difference : the difference in reduced form (of the worst component when the values are tensors).
    real : whether the printed value is real at every witness point.
    witnesses : one for each point.
    """

    holds: bool
    difference: sp.Expr
    real: bool
    witnesses: tuple[Witness, ...]

    @property
    def largest(self) -> sp.Float:
        """Largest relative difference over the witness points."""
        return max(witness.difference for witness in self.witnesses)


def compare(printed: Value, derived: Value, seed: str) -> Identity:
    """Compare two values.

    Raises
    ------
    UndecidedError
        When symbolic reduction and numeric witness do not agree; names the difference.
    """
    pairs = list(dict.fromkeys(zip(_components(printed), _components(derived), strict=True)))
    symbols = {symbol for pair in pairs for value in pair for symbol in value.free_symbols}
    witnesses, real, worst = [], True, pairs[0]
    for point in admissible_points(symbols, seed):
        values = [(_number(left, point), _number(right, point)) for left, right in pairs]
        real = real and all(left.is_real for left, _ in values)
        scale = max((abs(value) for pair in values for value in pair), default=sp.S.Zero) or sp.S.One
        index = max(range(len(values)), key=lambda n: abs(values[n][0] - values[n][1]))
        left, right = values[index]
        witnesses.append(Witness(point, left, right, sp.Float(abs(left - right) / scale, 5)))
        if witnesses[-1].difference > _AGREE:
            worst = pairs[index]
    if all(witness.difference <= _AGREE for witness in witnesses):
        for left, right in pairs:
            if not reduces_to_zero(left - right):
                raise UndecidedError(f"equal at all witness points, yet not reduced to zero: {left - right}")
        return Identity(True, sp.S.Zero, real, tuple(witnesses))
    return Identity(False, tidy(worst[0] - worst[1]), real, tuple(witnesses))


def reduces_to_zero(difference: sp.Expr) -> bool:
    """Whether SymPy reduces the difference to zero, by expansion, common denominators, powers or logarithms."""
    return any(attempt == 0 for attempt in _attempts(difference))


def _attempts(difference: sp.Expr) -> Iterator[sp.Expr]:
    yield sp.expand(difference)
    if not difference.has(sp.Pow) or all(p.exp.is_Integer for p in difference.atoms(sp.Pow)):
        yield sp.expand(sp.numer(sp.together(difference)))
    yield _by_logarithms(difference)
    yield sp.powsimp(sp.expand_power_base(sp.expand(difference), force=True))
    yield sp.simplify(difference)


def _by_logarithms(difference: sp.Expr) -> sp.Expr:
    """ln of the ratio of the two terms of a two-term difference; the difference itself otherwise."""
    terms = sp.Add.make_args(difference)
    if len(terms) != 2:
        return difference
    ratio = sp.expand_log(sp.log(terms[0]) - sp.log(-terms[1]), force=True)
    return sp.simplify(sp.expand(ratio))


def tidy(expr: sp.Expr) -> sp.Expr:
    """A short form of an expression, for people."""
    candidates = [expr, sp.factor_terms(expr)]
    if sp.count_ops(expr) < 60:
        candidates.append(sp.simplify(expr))
    return min(candidates, key=lambda e: (sp.count_ops(e), str(e)))


def _components(value: Value) -> list[sp.Expr]:
    if isinstance(value, sp.NDimArray):
        return list(sp.flatten(value.tolist()))
    if isinstance(value, sp.MatrixBase):
        return list(value)
    return [sp.sympify(value)]


def _number(expr: sp.Expr, point: Point) -> sp.Number:
    return sp.N(expr.xreplace(point), DIGITS + _GUARD)
