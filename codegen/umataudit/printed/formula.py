"""Formulas as text in Python's syntax, kept as printed: evaluated with SymPy, and taken apart factor by factor.

SymPy reorders and combines what it is given; the text keeps the printed arrangement, from which `umataudit.render`
makes MathML and LaTeX. Tensors are 3x3 matrices; `C4[I,J,K,L]` is index notation with repeated indices summed.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, TypeAlias

import sympy as sp

from umataudit.printed import tensors
from umataudit.printed.indices import index_sum
from umataudit.printed.letters import LETTERS

Value: TypeAlias = Any  # a SymPy expression, matrix or array


class FormulaError(ValueError):
    """A formula uses a name or a construction that is not known."""


FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    "sqrt": sp.sqrt,
    "exp": sp.exp,
    "ln": sp.log,
    "sin": sp.sin,
    "cos": sp.cos,
    "tan": sp.tan,
    "arcsin": sp.asin,
    "arctan": sp.atan,
    "maximum": sp.Max,
    "minimum": sp.Min,
    "diag": sp.diag,
    "tr": lambda matrix: matrix.trace(),
    "det": lambda matrix: matrix.det(),
    "inv": lambda matrix: matrix.adjugate() / matrix.det(),
    "transpose": lambda matrix: matrix.T,
    "ddot": tensors.double_contraction,
    "dyad": tensors.dyad,
}
CONSTANTS: Mapping[str, Value] = {"pi": sp.pi, "identity": sp.eye(3), "identity4": tensors.symmetric_identity()}


@dataclass(frozen=True)
class Formula:
    """A formula.

    Parameters
    ----------
    text : Python expression in the names of `LETTERS`, `FUNCTIONS` and `CONSTANTS`; numbers are exact rationals.

    Raises
    ------
    FormulaError
        When it is evaluated and a name or construction is not known; names it.
    """

    text: str

    @cached_property
    def tree(self) -> ast.expr:
        """Syntax tree."""
        return ast.parse(self.text, mode="eval").body

    @cached_property
    def value(self) -> Value:
        """SymPy value, evaluated."""
        return _evaluated(self.text)

    def factors(self) -> list[sp.Expr]:
        """The factors of a top-level product, in printed order."""
        return [_value(node) for node in _operands(self.tree, ast.Mult)]

    def terms(self) -> list[sp.Expr]:
        """The terms of a top-level sum, in printed order, with their signs."""
        return [_value(node) for node in _signed_terms(self.tree)]


@cache
def _evaluated(text: str) -> Value:
    return _value(ast.parse(text, mode="eval").body)


def _operands(node: ast.expr, kind: type[ast.operator]) -> list[ast.expr]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, kind):
        return [*_operands(node.left, kind), node.right]
    return [node]


def _signed_terms(node: ast.expr) -> list[ast.expr]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        last = node.right if isinstance(node.op, ast.Add) else ast.UnaryOp(ast.USub(), node.right)
        return [*_signed_terms(node.left), last]
    return [node]


def _value(node: ast.expr) -> Value:
    match node:
        case ast.Constant(value=number) if isinstance(number, int | float):
            return sp.Rational(repr(number))
        case ast.Name(id=name):
            return _named(name)
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_value(inner)
        case ast.Call(func=ast.Name(id=name), args=arguments):
            if name not in FUNCTIONS:
                raise FormulaError(f"function '{name}' is not known; known are {', '.join(FUNCTIONS)}")
            return FUNCTIONS[name](*(_value(argument) for argument in arguments))
        case ast.BinOp() if _has_indices(node):
            return index_sum(node, _value)
        case ast.BinOp(left=left, op=operator, right=right):
            return _binary(operator, _value(left), _value(right))
    raise FormulaError(f"'{ast.unparse(node)}' cannot be read as a formula")


def _has_indices(node: ast.expr) -> bool:
    return any(isinstance(part, ast.Subscript) for part in ast.walk(node))


def _binary(operator: ast.operator, left: Value, right: Value) -> Value:
    match operator:
        case ast.Add():
            return left + right
        case ast.Sub():
            return left - right
        case ast.Mult():
            return left * right
        case ast.Div():
            return left / right
        case ast.Pow():
            return left**right
        case ast.MatMult():
            return left * right
    raise FormulaError(f"operator '{type(operator).__name__}' is not known")


def _named(name: str) -> Value:
    if name in CONSTANTS:
        return CONSTANTS[name]
    if name not in LETTERS:
        raise FormulaError(f"'{name}' is not a letter of the paper; add it to umataudit/printed/letters.py")
    return LETTERS[name].value
