"""SymPy expressions and blocks to Fortran text (one unbroken line a statement; layout breaks them)."""

from __future__ import annotations

import re
from collections.abc import Sequence

import sympy as sp
from sympy.printing.fortran import FCodePrinter

from umatgen.nodes import Assign, Block, Call, Comment, Declare, Statement


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
        super().__init__({"standard": 95, "source_format": "free"})

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


def statement_lines(statement: Statement, prefix: str) -> list[str]:
    """Lines of one statement."""
    if isinstance(statement, Comment):
        return [f"! {statement.text}"]
    if isinstance(statement, Call):
        return [f"CALL {prefix}{statement.name}({', '.join(statement.arguments)})"]
    return [f"{statement.target} = {expression(statement.value)}"]


def declaration_lines(declarations: Sequence[Declare], intent: str) -> list[str]:
    """One declaration of all dummies of an intent, or of local arrays (intent "")."""
    names = [_shaped(d) for d in declarations]
    attribute = f", INTENT({intent.upper()})" if intent else ""
    return [f"DOUBLE PRECISION{attribute} :: {', '.join(names)}"] if names else []


def _shaped(item: Declare) -> str:
    return f"{item.name}({','.join(str(n) for n in item.shape)})" if item.shape else item.name


def _documented(title: str, declarations: Sequence[Declare]) -> list[str]:
    return [f"! {title}", *(f"!   {d.name:<14} {d.note}".rstrip() for d in declarations)]


def _local_scalars(block: Block) -> list[str]:
    known = {d.name for d in (*block.arguments, *block.local_arrays)}
    found: list[str] = []
    for statement in block.body:
        if isinstance(statement, Assign):
            name = re.split(r"\(", statement.target)[0]
            if name not in known and name not in found:
                found.append(name)
    return found


def block_lines(block: Block, prefix: str) -> list[str]:
    """Unbroken lines of a whole procedure."""
    name = prefix + block.name
    ins = [d for d in block.arguments if d.intent == "in"]
    outs = [d for d in block.arguments if d.intent == "out"]
    lines = [
        "!" + "-" * 70,
        f"! {block.title}",
        f"! Equation: {block.equation}",
        *_documented("In:", ins),
        *_documented("Out:", outs),
        f"SUBROUTINE {name}({', '.join(d.name for d in block.arguments)})",
        "IMPLICIT NONE",
        *declaration_lines(ins, "in"),
        *declaration_lines(outs, "out"),
        *declaration_lines(block.local_arrays, ""),
    ]
    scalars = _local_scalars(block)
    if scalars:
        lines.append(f"DOUBLE PRECISION :: {', '.join(scalars)}")
    for statement in block.body:
        lines += statement_lines(statement, prefix)
    return [*lines, f"END SUBROUTINE {name}"]
