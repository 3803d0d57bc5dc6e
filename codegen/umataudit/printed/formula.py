"""Formulas as text in Python's syntax, kept as printed: evaluated with SymPy, and taken apart factor by factor.

SymPy reorders and combines what it is given; the text keeps the printed arrangement, from which `umataudit.render`
makes LaTeX. Tensors are 3x3 matrices; `C4[I,J,K,L]` is index notation with repeated indices summed.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, TypeAlias

import sympy as sp

from umataudit.printed.letters import LETTERS
from umataudit.printed.tensors import double_contraction, dyad, factors, has_indices, index_sum, symmetric_identity

Value: TypeAlias = Any  # a SymPy expression, matrix or array


class FormulaError(ValueError):
    """A formula uses a name or a construction that is not known."""


FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    "sqrt": sp.sqrt, "exp": sp.exp, "ln": sp.log, "sin": sp.sin, "cos": sp.cos, "tan": sp.tan, "arcsin": sp.asin,
    "arctan": sp.atan, "maximum": sp.Max, "minimum": sp.Min, "diag": sp.diag, "ddot": double_contraction, "dyad": dyad,
    "tr": lambda matrix: matrix.trace(), "det": lambda matrix: matrix.det(), "transpose": lambda matrix: matrix.T,
    "inv": lambda matrix: matrix.adjugate() / matrix.det(),
}  # fmt: skip
CONSTANTS: Mapping[str, Value] = {"pi": sp.pi, "identity": sp.eye(3), "identity4": symmetric_identity()}
OPERATORS: Mapping[type[ast.operator], Callable[[Value, Value], Value]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.MatMult: operator.mul,
    ast.Div: operator.truediv, ast.Pow: operator.pow,
}  # fmt: skip


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
        return [_value(node) for node in factors(self.tree)]

    def terms(self) -> list[sp.Expr]:
        """The terms of a top-level sum, in printed order, with their signs."""
        return [_value(node) for node in _signed_terms(self.tree)]


@cache
def _evaluated(text: str) -> Value:
    return _value(ast.parse(text, mode="eval").body)


def _signed_terms(node: ast.expr) -> list[ast.expr]:
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
        last = node.right if isinstance(node.op, ast.Add) else ast.UnaryOp(ast.USub(), node.right)
        return [*_signed_terms(node.left), last]
    return [node]


def _value(node: ast.expr) -> Value:
    match node:
        case ast.Constant(value=number) if isinstance(number, int | float):
            return sp.Rational(repr(number))
        case ast.Name(id=name) if name in CONSTANTS:
            return CONSTANTS[name]
        case ast.Name(id=name) if name in LETTERS:
            return LETTERS[name].value
        case ast.Name(id=name):
            raise FormulaError(f"'{name}' is not a letter of the paper; add it to umataudit/printed/letters.toml")
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_value(inner)
        case ast.Call(func=ast.Name(id=name), args=arguments):
            if name not in FUNCTIONS:
                raise FormulaError(f"function '{name}' is not known; known are {', '.join(FUNCTIONS)}")
            return FUNCTIONS[name](*map(_value, arguments))
        case ast.BinOp() if has_indices(node):
            return index_sum(node, _value)
        case ast.BinOp(op=operation) if type(operation) in OPERATORS:
            return OPERATORS[type(operation)](_value(node.left), _value(node.right))
    raise FormulaError(f"'{ast.unparse(node)}' cannot be read as a formula")
