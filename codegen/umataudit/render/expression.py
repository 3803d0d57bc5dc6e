"""SymPy expressions as text in the paper's letters: the same syntax as printed formulas, so that one writer serves both."""

from __future__ import annotations

import mpmath as mp
import sympy as sp
from sympy.printing.str import StrPrinter

from umataudit.printed.formula import Value
from umataudit.printed.letters import LETTERS

_NAMES = {letter.symbol.name: letter.name for letter in LETTERS.values() if not letter.shape}
_FUNCTIONS = {"log": "ln", "asin": "arcsin", "atan": "arctan", "Max": "maximum", "Min": "minimum"}
_LONGEST = 700
_LARGEST_DENOMINATOR = 1000


class _PaperPrinter(StrPrinter):  # type: ignore[misc]
    """Symbols by the paper's letters, functions by the names that printed formulas use."""

    def _print_Symbol(self, expr: sp.Symbol) -> str:
        return _NAMES.get(expr.name, str(expr.name))

    def _print_Function(self, expr: sp.Function) -> str:
        name = _FUNCTIONS.get(expr.func.__name__, expr.func.__name__)
        return f"{name}({self.stringify(expr.args, ', ')})"

    _print_Max = _print_Min = _print_Function

    def _print_Float(self, expr: sp.Float) -> str:
        return str(mp.nstr(mp.mpf(expr), 8))


_PRINTER = _PaperPrinter()


def expression_text(expr: sp.Expr) -> str:
    """Text of a scalar expression, readable by `umataudit.printed.Formula`."""
    return str(_PRINTER.doprint(expr))


def value_text(value: Value | None) -> str:
    """Text of a value; "" for tensors (shown as formulas) and for what is too long to read."""
    if value is None or isinstance(value, sp.MatrixBase | sp.NDimArray):
        return ""
    if isinstance(value, sp.Rational) and value.q > _LARGEST_DENOMINATOR:
        return str(mp.nstr(mp.mpf(value.p) / value.q, 8))
    text = expression_text(sp.sympify(value))
    return text if len(text) <= _LONGEST else ""
