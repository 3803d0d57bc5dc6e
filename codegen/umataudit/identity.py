"""Whether two values are equal: the symbolic difference reduced to zero, or shown not to be zero, with a 30-digit witness."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import mpmath as mp
import sympy as sp

from umataudit.points import DIGITS, admissible_points
from umataudit.printed.formula import Value

Point = dict[sp.Symbol, sp.Rational]
_GUARD = 20
_MANY = 30  # components from which on sharing subexpressions pays
_AGREE = mp.mpf(10) ** -(DIGITS - 2)


class UndecidedError(ArithmeticError):
    """A difference vanishes at every witness point but was not reduced to zero symbolically."""


@dataclass(frozen=True)
class Witness:
    """The two values at one admissible point: worst component, mpmath numbers good to 30 digits.

    `difference` is relative to the largest component.
    """

    point: Point
    printed: Any
    derived: Any
    difference: Any


@dataclass(frozen=True)
class Identity:
    """Outcome of a comparison.

    Parameters
    ----------
    holds : whether the symbolic difference is zero.
    remainder : printed minus derived as it comes out (of the worst component when the values are tensors).
    real : whether the printed value is real at every witness point.
    witnesses : one for each point.
    """

    holds: bool
    remainder: sp.Expr
    real: bool
    witnesses: tuple[Witness, ...]

    @cached_property
    def difference(self) -> sp.Expr:
        """The remainder in a short form, for people."""
        return tidy(self.remainder)

    @property
    def largest(self) -> Any:
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
    evaluate = _evaluator(pairs, sorted(symbols, key=str))
    witnesses: list[Witness] = []
    real, worst = True, pairs[0]
    for point in admissible_points(symbols, seed):
        values = evaluate(point)
        real = real and all(mp.im(left) == 0 for left, _ in values)
        with mp.workdps(DIGITS + _GUARD):
            scale = max(abs(value) for pair in values for value in pair) or mp.mpf(1)
            index = max(range(len(values)), key=lambda n: abs(values[n][0] - values[n][1]))
            left, right = values[index]
            witnesses.append(Witness(point, left, right, abs(left - right) / scale))
        if witnesses[-1].difference > _AGREE:
            worst = pairs[index]
    if all(witness.difference <= _AGREE for witness in witnesses):
        for left, right in pairs:
            if not reduces_to_zero(left, right):
                raise UndecidedError(f"equal at all witness points, yet not reduced to zero: {left - right}")
        return Identity(True, sp.S.Zero, real, tuple(witnesses))
    return Identity(False, worst[0] - worst[1], real, tuple(witnesses))


def reduces_to_zero(left: sp.Expr, right: sp.Expr) -> bool:
    """Whether SymPy reduces left - right to zero: by expansion, common denominators, logarithms or simplification."""
    return any(attempt == 0 for attempt in _attempts(left, right))


def _attempts(left: sp.Expr, right: sp.Expr) -> Iterator[sp.Expr]:
    difference = left - right
    yield sp.expand(difference)
    if all(power.exp.is_Integer for power in difference.atoms(sp.Pow)):
        yield sp.expand(sp.numer(sp.together(difference)))
    sign = -1 if left.is_negative or left.could_extract_minus_sign() else 1
    yield sp.expand(_logarithm(sign * left) - _logarithm(sign * right))
    yield sp.simplify(difference)


def _logarithm(product: sp.Expr) -> sp.Expr:
    """Logarithm of a product as a sum, with the sums inside factored over their common denominator.

    Positive symbols are replaced by squares first, so that what is inside becomes rational.
    """
    positive = [symbol for symbol in product.free_symbols if symbol.is_positive]
    squares = {symbol: sp.Symbol(f"root_of_{symbol.name}", positive=True) ** 2 for symbol in positive}
    total = sp.expand_log(sp.log(sp.powdenest(product.subs(squares), force=True)), force=True)
    for log in sorted(total.atoms(sp.log), key=str):
        total = total.subs(log, sp.expand_log(sp.log(sp.factor(sp.together(log.args[0]))), force=True))
    turned = {log: sp.log(-log.args[0]) + sp.log(-1) for log in total.atoms(sp.log) if _negated(log.args[0])}
    return total.xreplace(turned)


def _negated(argument: sp.Expr) -> bool:
    """Of a sum and its negative exactly one counts as negated, so that both are written the same way."""
    return bool(argument.is_Add and argument.could_extract_minus_sign())


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


def _evaluator(
    pairs: list[tuple[sp.Expr, sp.Expr]], symbols: list[sp.Symbol]
) -> Callable[[Point], list[tuple[Any, Any]]]:
    """Function of a point that evaluates all pairs with mpmath."""
    flat = [value for pair in pairs for value in pair]
    function = sp.lambdify(symbols, flat, modules="mpmath", cse=len(flat) > _MANY)

    def evaluate(point: Point) -> list[tuple[Any, Any]]:
        with mp.workdps(DIGITS + _GUARD):
            values = [mp.mpmathify(v) for v in function(*(mp.mpf(point[s].p) / point[s].q for s in symbols))]
        return list(zip(values[::2], values[1::2], strict=True))

    return evaluate
