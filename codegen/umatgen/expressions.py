"""SymPy expressions to Fortran text in double precision."""

from __future__ import annotations

import re

import sympy as sp
from sympy.printing.fortran import FCodePrinter


def decimal(value: float) -> str:
    """Double-precision constant that reads back as `value`."""
    text = repr(value)
    if "e" not in text:
        return f"{text}d0"
    mantissa, exponent = text.split("e")
    return f"{mantissa}{'' if '.' in mantissa else '.0'}d{int(exponent)}"


class ExpressionPrinter(FCodePrinter):  # type: ignore[misc]
    """Double-precision Fortran: decimal constants with d0, small integer powers, square roots, quotients."""

    def __init__(self) -> None:
        super().__init__({"standard": 95, "source_format": "free", "user_functions": {"atanh": "atanh"}})

    def _print_Integer(self, expr: sp.Integer) -> str:
        return f"{int(expr)}.0d0"

    def _print_Rational(self, expr: sp.Rational) -> str:
        value = sp.Float(expr, 17)
        if sp.Rational(str(float(value))) == expr:
            return decimal(float(value))
        return f"{expr.p}.0d0/{expr.q}.0d0"

    def _print_Float(self, expr: sp.Float) -> str:
        return decimal(float(expr))

    def _print_Pow(self, expr: sp.Pow) -> str:
        base, exponent = expr.as_base_exp()
        precedence = sp.printing.precedence.PRECEDENCE["Pow"]
        if exponent == sp.Rational(1, 2):
            return f"sqrt({self._print(base)})"
        if exponent.is_Integer and exponent > 0:
            return f"{self.parenthesize(base, precedence, strict=False)}**{int(exponent)}"
        if exponent.is_number and exponent < 0:
            return f"1.0d0/{self._denominator(base, -exponent)}"
        return f"{self.parenthesize(base, precedence, strict=False)}**({self._print(exponent)})"

    def _denominator(self, base: sp.Expr, exponent: sp.Expr) -> str:
        printed = self._print(base if exponent == 1 else sp.Pow(base, exponent, evaluate=False))
        return printed if exponent == sp.Rational(1, 2) or base.is_Symbol else f"({printed})"


_PRINTER = ExpressionPrinter()


def expression(value: sp.Expr | str) -> str:
    """Fortran text of an expression; text is passed through."""
    if isinstance(value, str):
        return value
    return re.sub(r"(?<![a-z0-9_])\((\d+\.\d+d-?\d+)\)(?=\*)", r"\1", str(_PRINTER._print(value)))
