"""Formulas for people: SymPy expressions as text in the paper's letters, and that text as LaTeX and MathML as printed.

SymPy's own LaTeX printer would reorder factors and merge quotients; the syntax tree of the text has them as printed.
"""

from __future__ import annotations

import ast
import re
from html import escape

import mpmath as mp
import sympy as sp
from latex2mathml.converter import convert
from sympy.printing.str import StrPrinter

from umataudit.printed.formula import CONSTANTS, FUNCTIONS, Value
from umataudit.printed.letters import BY_SYMBOL, LETTERS

_FUNCTIONS = {"log": "ln", "asin": "arcsin", "atan": "arctan", "Max": "maximum", "Min": "minimum"}
_CONSTANTS = {"pi": r"\pi", "identity": r"\mathbf 1", "identity4": r"\mathbb I", "delta": r"\delta"}
_WORDS = {"exp", "ln", "sin", "cos", "tan", "arcsin", "arctan", "tr", "det", "diag", "maximum", "minimum"}
_CORE = {
    r' mathvariant="bold(?:-italic)?"': ' style="font-weight:bold"',
    r'<mi mathvariant="double-struck">C': "<mi>&#x2102;",
    r'<mi mathvariant="double-struck">I': "<mi>&#x1D540;",
    r"<mover>(?:<mrow>)?(<mi[^>]*>[^<]*)</mi>(?:</mrow>)?<mo[^>]*>&#x002D9;</mo></mover>": r"\1&#x0307;</mi>",
    r"<mover>(?:<mrow>)?(<mi[^>]*>[^<]*)</mi>(?:</mrow>)?<mo[^>]*>&#x000AF;</mo></mover>": r"\1&#x0304;</mi>",
    r"<mi>([^<]+&#x030[47];</mi>)": r'<mi style="font-style:italic">\1',
}
"""For browsers: accents need a mathematics font, combining marks none; of the variants they know only the upright one."""
_LONGEST, _LARGEST_DENOMINATOR = 700, 1000
_SUM, _MINUS, _PRODUCT, _POWER, _ATOM = range(5)
_Bound = tuple[str, int]  # LaTeX, and how tightly it binds


class _PaperPrinter(StrPrinter):  # type: ignore[misc]
    """Symbols by the paper's letters, functions by the names that printed formulas use."""

    def _print_Symbol(self, expr: sp.Symbol) -> str:
        return BY_SYMBOL[expr.name].name if expr.name in BY_SYMBOL else str(expr.name)

    def _print_Function(self, expr: sp.Function) -> str:
        name = _FUNCTIONS.get(expr.func.__name__, expr.func.__name__)
        return f"{name}({self.stringify(expr.args, ', ')})"

    def _print_ImaginaryUnit(self, expr: sp.Expr) -> str:
        return "i"

    _print_Max = _print_Min = _print_Function

    def _print_Float(self, expr: sp.Float) -> str:
        return str(mp.nstr(mp.mpf(expr), 8))


def expression_text(expr: sp.Expr) -> str:
    """Text of a scalar expression, readable by `umataudit.printed.Formula`."""
    return str(_PaperPrinter().doprint(expr))


def value_text(value: Value | None) -> str:
    """Text of a value; "" for tensors (shown as formulas) and for what is too long to read."""
    if value is None or isinstance(value, sp.MatrixBase | sp.NDimArray):
        return ""
    if isinstance(value, sp.Rational) and value.q > _LARGEST_DENOMINATOR:
        return str(mp.nstr(mp.mpf(value.p) / value.q, 8))
    text = expression_text(sp.sympify(value))
    return text if len(text) <= _LONGEST else ""


_TOKEN = re.compile(r"[A-Za-z_][A-Za-z_0-9]*|\d+(?:\.\d+)?(?:e-?\d+)?|\*\*|[-+*/^()=:<>,]|\s+|.")
_WORDS_TOO = {"stress", "number", "ordinate", "duration", "trend", "jaumann", "m", "f", "delta", "identity"}
_KNOWN = {*LETTERS, *FUNCTIONS, *CONSTANTS} - _WORDS_TOO


def typeset(prose: str) -> str:
    """Prose as HTML text, its formulas as MathML: the longest runs of letters, numbers and signs that can be read as one."""
    tokens, parts, start = _TOKEN.findall(prose), [], 0
    while start < len(tokens):
        end = next((end for end in range(_run(tokens, start), start, -1) if _is_formula(tokens[start:end])), start)
        parts.append(_inline(tokens[start:end]) if end > start else escape(tokens[start]))
        start = max(end, start + 1)
    return "".join(parts)


def _run(tokens: list[str], start: int) -> int:
    """End of the run of tokens that may stand in a formula."""
    end = start
    if start and tokens[start - 1] in {"/", "*", "^", "**"}:
        return start
    while end < len(tokens) and (_is_letter(tokens[end]) or not re.match(r"[A-Za-z_.;'\"%&]", tokens[end])):
        end += 1
    return end


def _is_letter(token: str) -> bool:
    return token in _KNOWN or ("_" in token and token not in FUNCTIONS)


def _is_formula(tokens: list[str]) -> bool:
    """Whether tokens are a letter with an index, or an expression or equation with such letters and a sign; no blanks at the ends."""
    if tokens[0].isspace() or tokens[-1].isspace() or not any(map(_is_letter, tokens)):
        return False
    if tokens[-1] in FUNCTIONS:
        return False
    if len(tokens) == 1:
        return len(tokens[0]) > 1 and tokens[0] not in CONSTANTS
    if not any(t in {"+", "-", "*", "/", "^", "**", "=", "("} for t in tokens):
        return False
    try:
        return all(isinstance(ast.parse(side, mode="eval").body, _FORMULA) for side in _sides(tokens))
    except SyntaxError:
        return False


_FORMULA = (ast.BinOp, ast.UnaryOp, ast.Name, ast.Call, ast.Constant)


def _sides(tokens: list[str]) -> list[str]:
    """Both sides of an equation in Python's spelling: a blank between factors is a product."""
    text = "".join(tokens).replace("^", "**")
    text = re.sub(r"(?<=[\w)])\s+(?=[A-Za-z_0-9(])", "*", text)
    return [side.strip() for side in text.split("=")]


def _inline(tokens: list[str]) -> str:
    left, *right = _sides(tokens)
    return mathml(left, right[0], block=False) if len(right) == 1 else mathml("", left, block=False)


def latex(text: str) -> str:
    """LaTeX of a formula given as text."""
    return _latex(ast.parse(text, mode="eval").body)[0]


def mathml(left: str, right: str, *, block: bool = True) -> str:
    """MathML of an equation given as two texts; of the right-hand side alone when there is no left."""
    equation = " = ".join(latex(side) for side in (left, right) if side)
    markup = str(convert(equation, display="block" if block else "inline"))
    for found, shown in _CORE.items():
        markup = re.sub(found, shown, markup)
    return markup


def _letter(name: str) -> str:
    """LaTeX of a letter, of a component of a tensor letter ("Cdot_12"), or of a name of a derivation ("G", "e_11")."""
    letter = LETTERS.get(name) or BY_SYMBOL.get(name)
    base, _, index = name.rpartition("_")
    if letter is not None or name in _CONSTANTS or not (base and index):
        return letter.math if letter is not None else _CONSTANTS.get(name, name)
    return _component(base, index)


def _component(base: str, index: str) -> str:
    plain = (LETTERS[base].math if base in LETTERS else _letter(base)).replace(r"\mathbf ", " ").replace(r"\boldsymbol", "")
    return f"{{({plain})}}_{{{index}}}" if "frac" in plain else f"{{{plain}}}_{{{index}}}"


def _number(text: str) -> str:
    mantissa, _, exponent = text.partition("e")
    return f"{mantissa} \\cdot 10^{{{int(exponent)}}}" if exponent else mantissa


def _latex(node: ast.expr) -> _Bound:
    match node:
        case ast.Constant(value=value):
            return _number(str(value)), _ATOM
        case ast.Name(id=name):
            return _letter(name), _POWER if "^" in _letter(name) else _ATOM
        case ast.UnaryOp(operand=inner):
            return f"-{_within(inner, _PRODUCT)}", _MINUS
        case ast.Subscript(value=ast.Name(id=name), slice=indices):
            return _component(name, " ".join(c for c in ast.unparse(indices) if c.isalpha())), _ATOM
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return _call(name, arguments)
        case ast.BinOp(left=left, op=operator, right=right):
            return _binary(left, operator, right)
    return rf"\text{{{ast.unparse(node)}}}", _ATOM


def _within(node: ast.expr, binding: int) -> str:
    text, bound = _latex(node)
    return text if bound >= binding else rf"\left({text}\right)"


def _binary(left: ast.expr, operator: ast.operator, right: ast.expr) -> _Bound:
    (first, bound), (second, after) = _latex(left), _latex(right)
    match operator:
        case ast.Add():
            return (f"{first} - {second[1:]}" if after == _MINUS else f"{first} + {second}"), _SUM
        case ast.Sub():
            return f"{first} - {_within(right, _PRODUCT)}", _SUM
        case ast.Div():
            sign = "-" if bound == _MINUS else ""
            return rf"{sign}\frac{{{first.removeprefix(sign)}}}{{{second}}}", _MINUS if sign else _PRODUCT
        case ast.Pow():
            return f"{{{_within(left, _ATOM)}}}^{{{second}}}", _POWER
    second = _within(right, _PRODUCT)
    between = r" \cdot " if second.lstrip("{")[:1].isdigit() else r" \, "
    return f"{_within(left, _MINUS)}{between}{second}", min(bound, _PRODUCT) if bound else _PRODUCT


def _call(name: str, arguments: list[ast.expr]) -> _Bound:
    inner = r",\; ".join(_latex(argument)[0] for argument in arguments)
    match name:
        case "sqrt":
            return rf"\sqrt{{{inner}}}", _POWER
        case "transpose":
            return f"{{{_within(arguments[0], _POWER)}}}^{{T}}", _POWER
        case "inv":
            return f"{{{_within(arguments[0], _ATOM)}}}^{{-1}}", _POWER
        case "ddot" | "dyad":
            sides = [_within(argument, _PRODUCT) for argument in arguments]
            return (" : " if name == "ddot" else r" \otimes ").join(sides), _PRODUCT
    word = rf"\operatorname{{{name.removesuffix('imum')}}}" if name in _WORDS else _letter(name)
    return rf"{word}\left({inner}\right)", _POWER
