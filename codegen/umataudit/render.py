"""Formulas for people: SymPy expressions as text in the paper's letters, and that text as LaTeX and MathML as printed.

SymPy's own LaTeX printer would reorder factors and merge quotients; the syntax tree of the text has them as printed.
"""

from __future__ import annotations

import ast
import re
from functools import cache

import mpmath as mp
import sympy as sp
from latex2mathml.converter import convert
from markupsafe import Markup, escape
from sympy.printing.str import StrPrinter

from umataudit.printed.formula import Value
from umataudit.printed.letters import BY_SYMBOL, LETTERS

_FUNCTIONS = {"log": "ln", "asin": "arcsin", "atan": "arctan", "Max": "maximum", "Min": "minimum"}
_GREEK = {name: rf"\{name}" for name in ("beta", "eta", "nu", "pi", "delta")}
_CONSTANTS = _GREEK | {
    "identity": r"\mathbf 1", "second": r"\text{s}", "identity4": r"\mathbb I", "i": r"\text{i}", "tau": r"\boldsymbol\tau",
}  # fmt: skip
_WORDS = {"exp", "ln", "sin", "cos", "tan", "arcsin", "arctan", "tr", "det", "diag", "maximum", "minimum"}
_RELATION = {"=": " = ", "<": " < ", ">": " > ", "<=": r" \le ", ">=": r" \ge "}
_CORE = {
    r' mathvariant="bold(?:-italic)?"': ' style="font-weight:bold"',
    r'<mi mathvariant="double-struck">C': "<mi>&#x2102;",
    r'<mi mathvariant="double-struck">I': "<mi>&#x1D540;",
    r"<mover>": '<mover accent="true">',
    r"<mo[^>]*>(&#x002D9;|&#x000AF;)</mo>": r'<mo lspace="0" rspace="0" stretchy="false">\1</mo>',
}
"""For browsers: of the variants they know only the upright one, and without a mathematics font an accent needs its spaces taken."""
_LONGEST, _LARGEST_DENOMINATOR, _WIDE = 700, 1000, 20
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


def typeset(prose: str) -> Markup:
    """Prose as HTML: what stands between dollar signs as MathML, between grave accents as code."""
    parts = re.split(r"\$([^$]+)\$|`([^`]+)`", prose)
    shown = [escape(parts[0])]
    for formula, code, text in zip(parts[1::3], parts[2::3], parts[3::3], strict=True):
        shown += [_inline(formula) if formula else Markup("<code>{}</code>").format(code), escape(text)]
    return Markup("").join(shown)


def plain(prose: str) -> str:
    """Prose for a terminal, without those marks."""
    return re.sub(r"\$([^$]+)\$|`([^`]+)`", r"\1\2", prose)


def _inline(formula: str) -> Markup:
    """A formula of prose: a blank is a product, a colon the double contraction; it may have several sides."""
    text = re.sub(r"(?<=[\w)])\s+(?=[A-Za-z_0-9(])", "*", formula.replace("^", "**")).replace(":", "%")
    first, *rest = re.split(r"\s*(>=|<=|[=<>])\s*", text)
    pieces = _pieces(_tree(first))
    for relation, side in zip(rest[::2], rest[1::2], strict=True):
        start, *others = _pieces(_tree(side))
        pieces += ["{}" + _RELATION[relation] + start, *others]
    return _math(["".join(pieces)] if _width("".join(pieces)) <= _WIDE else pieces)


def latex(text: str) -> str:
    """LaTeX of a formula given as text."""
    return _latex(_tree(text))[0]


def mathml(left: str, right: str) -> Markup:
    """MathML of an equation given as two texts; of the right-hand side alone when there is no left."""
    return _math([*([f"{latex(left)} ="] if left else []), *_pieces(_tree(right))])


def _tree(text: str) -> ast.expr:
    return ast.parse(text.strip(), mode="eval").body


def _math(pieces: list[str]) -> Markup:
    """One <math> for each piece: browsers end no line within one."""
    return Markup("<wbr>").join(map(_piece, pieces))


@cache
def _piece(tex: str) -> Markup:
    markup = str(convert(tex)).replace(' xmlns="http://www.w3.org/1998/Math/MathML" display="inline"', "")
    for found, shown in _CORE.items():
        markup = re.sub(found, shown, markup)
    return Markup(markup)


def _pieces(node: ast.expr) -> list[str]:
    """LaTeX of a formula in pieces between which a line may end: the terms and factors of what is wide."""
    whole = _latex(node)[0]
    if _width(whole) <= _WIDE:
        return [whole]
    match node:
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as op, right=right):
            first, *rest = _bracketed(right) if isinstance(op, ast.Sub) and _is_sum(right) else _pieces(right)
            minus = isinstance(op, ast.Sub) or first.startswith("-")
            return [*_pieces(left), "{} " + ("- " if minus else "+ ") + first.removeprefix("-"), *rest]
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            first, *rest = _bracketed(right)
            return [*_bracketed(left), "{}" + _between(first) + first, *rest]
        case ast.BinOp(left=ast.BinOp(left=one, op=ast.Mult(), right=other), op=ast.Div(), right=right):
            return _pieces(ast.BinOp(one, ast.Mult(), ast.BinOp(other, ast.Div(), right)))
        case ast.BinOp(left=left, op=ast.Div(), right=right) if _is_sum(left):
            return _pieces(ast.BinOp(ast.BinOp(ast.Constant(1), ast.Div(), right), ast.Mult(), left))
        case ast.UnaryOp(operand=inner):
            first, *rest = _bracketed(inner)
            return [f"-{first}", *rest]
        case ast.Call(func=ast.Name(id=name), args=[first_argument, second_argument]) if name in _WORDS:
            inner_pieces = [*_pieces(first_argument), *_pieces(second_argument)]
            inner_pieces[len(_pieces(first_argument)) - 1] += ","
            return _enclosed(inner_pieces, _word(name))
    return [whole]


def _width(tex: str) -> int:
    """About how many signs stand side by side."""
    return len(re.sub(r"\\[A-Za-z]+", "x", re.sub(r"\\left|\\right|\\frac|\\text|\\,|[{}_^\s]", "", tex)))


def _is_sum(node: ast.expr) -> bool:
    return isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub)


def _bracketed(node: ast.expr) -> list[str]:
    """Pieces of a factor."""
    if not _is_sum(node):
        return _pieces(node) if _latex(node)[1] >= _PRODUCT else [_within(node, _PRODUCT)]
    return _enclosed(_pieces(node))


def _enclosed(pieces: list[str], word: str = "") -> list[str]:
    if len(pieces) == 1:
        return [rf"{word}\left({pieces[0]}\right)"]
    return [rf"{word}\left({pieces[0]}\right.", *pieces[1:-1], rf"\left.{pieces[-1]}\right)"]


def _letter(name: str) -> str:
    """LaTeX of a letter, of a component of a tensor letter ("Cdot_12"), or of a name of a derivation ("G", "e_11", "dS", "gap")."""
    if name in LETTERS or name in BY_SYMBOL:
        return (LETTERS.get(name) or BY_SYMBOL[name]).math
    base, _, index = name.rpartition("_")
    if name in _CONSTANTS or len(name) == 1:
        return _CONSTANTS.get(name, name)
    if name[0] == "d" and (name[1:] in LETTERS or name[1:].rpartition("_")[0] in LETTERS):
        return r"\partial " + _letter(name[1:])
    if base:
        return _component(base, index if len(index) == 1 or not index.isalpha() else rf"\text{{{index}}}")
    if name.endswith("dot"):
        return rf"\dot{{\mathbf {name[:-3]}}}"
    return rf"{name[0]}_{{{name[1:]}}}" if name[1:].isdigit() else rf"\text{{{name}}}"


def _component(base: str, index: str) -> str:
    plain_base = _letter(base).replace(r"\mathbf ", " ").replace(r"\boldsymbol", "")
    return f"{{({plain_base})}}_{{{index}}}" if "frac" in plain_base else f"{{{plain_base}}}_{{{index}}}"


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
    raise ValueError(f"'{ast.unparse(node)}' cannot be set as a formula; write products with a sign or a blank")


def _within(node: ast.expr, binding: int) -> str:
    text, bound = _latex(node)
    return text if bound >= binding else rf"\left({text}\right)"


def _between(factor: str) -> str:
    """A dot before a number, a thin space before other factors."""
    return r" \cdot " if factor.lstrip("{")[:1].isdigit() else r" \, "


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
    between = " : " if isinstance(operator, ast.Mod) else _between(second)
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
    return rf"{_word(name)}\left({inner}\right)", _POWER


def _word(name: str) -> str:
    return rf"\operatorname{{{name.removesuffix('imum')}}}" if name in _WORDS else _letter(name)
