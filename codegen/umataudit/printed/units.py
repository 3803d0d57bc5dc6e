"""Units of a printed formula, walked through its text: sums of equal units, numbers in exponents and functions."""

from __future__ import annotations

import ast
from dataclasses import dataclass

import sympy as sp

from umataudit.printed.formula import Formula
from umataudit.printed.letters import LETTERS, sym


class UnitError(ValueError):
    """Units do not fit; says where."""


@dataclass(frozen=True)
class Unit:
    """`unit` of a quantity; `log` the unit of its exponential, for a logarithm of something with a unit."""

    unit: sp.Expr = sp.S.One
    log: sp.Expr = sp.S.One


_BASE = {name: sp.Symbol(name, positive=True) for name in ("MPa", "mm", "s")}
CONSISTENT = "consistent"
_ANGLES = ("sin", "cos", "tan", "arcsin", "arctan")


def letter_unit(name: str) -> Unit:
    """Unit of a letter."""
    letter = LETTERS[name]
    exponents = dict(zip(("a", "n"), sym("a n"), strict=True))
    unit = sp.sympify(letter.unit, locals=_BASE | exponents)
    return Unit(log=unit) if letter.logarithm else Unit(unit)


def unit_of(node: ast.expr) -> Unit:
    """Unit of a formula given as a syntax tree.

    Raises
    ------
    UnitError
        Names the part that does not fit.
    """
    match node:
        case ast.Constant():
            return Unit()
        case ast.Name(id=name):
            return letter_unit(name) if name in LETTERS else Unit()
        case ast.UnaryOp(operand=inner):
            return unit_of(inner)
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            return _power(left, right)
        case ast.BinOp(left=left, op=operator, right=right):
            return _binary(node, operator, unit_of(left), unit_of(right))
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return _call(node, name, [unit_of(argument) for argument in arguments])
    raise UnitError(f"no unit for '{ast.unparse(node)}'")


def _same(first: sp.Expr, second: sp.Expr) -> bool:
    return bool(sp.simplify(sp.expand_log(sp.log(first) - sp.log(second), force=True)) == 0)


def _binary(node: ast.expr, operator: ast.operator, left: Unit, right: Unit) -> Unit:
    if isinstance(operator, ast.Add | ast.Sub):
        if not _same(left.unit, right.unit):
            raise UnitError(f"${ast.unparse(node)}$ adds {_name(left.unit)} and {_name(right.unit)}")
        sign = 1 if isinstance(operator, ast.Add) else -1
        return Unit(left.unit, left.log * right.log**sign)
    if left.log != 1 or right.log != 1:
        raise UnitError(f"${ast.unparse(node)}$ multiplies the logarithm of a quantity that has a unit")
    sign = -1 if isinstance(operator, ast.Div) else 1
    return Unit(sp.powsimp(left.unit * right.unit**sign))


def _power(base: ast.expr, exponent: ast.expr) -> Unit:
    if not _same(unit_of(exponent).unit, sp.S.One):
        raise UnitError(f"the exponent ${ast.unparse(exponent)}$ has a unit")
    power = Formula(ast.unparse(exponent)).value
    return Unit(sp.powsimp(sp.powdenest(unit_of(base).unit ** power, force=True)))


def _call(node: ast.expr, name: str, arguments: list[Unit]) -> Unit:
    first = arguments[0]
    of_any = {"ln": Unit(log=first.unit), "sqrt": Unit(sp.sqrt(first.unit)), "maximum": first}
    of_numbers = {"exp": Unit(first.log), **dict.fromkeys(_ANGLES, Unit())}
    if name not in of_any and not _same(first.unit, sp.S.One):
        raise UnitError(f"the argument of ${ast.unparse(node)}$ has the unit {_name(first.unit)}")
    if name not in of_any | of_numbers:
        raise UnitError(f"no unit for '{name}'")
    return (of_any | of_numbers)[name]


def _name(unit: sp.Expr) -> str:
    return "none" if unit == 1 else f"${unit.subs(_BASE['s'], sp.Symbol('second'))}$"


def check_units(left: str, formula: ast.expr) -> str:
    """Say "consistent", what does not fit, or "" for words, tensors and plain numbers (in the left-hand unit)."""
    names = {node.id for node in ast.walk(formula) if isinstance(node, ast.Name)}
    if not left or not names or LETTERS[left].shape or any(name in LETTERS and LETTERS[name].shape for name in names):
        return ""
    wanted = letter_unit(left)
    try:
        found = unit_of(formula)
    except UnitError as error:
        return str(error)
    if _same(found.unit, wanted.unit) and _same(found.log, wanted.log):
        return CONSISTENT
    units = (_name(unit.unit * unit.log) for unit in (found, wanted))
    return "the right-hand side has the unit {}, the left {}".format(*units)
