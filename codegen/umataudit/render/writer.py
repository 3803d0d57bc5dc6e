"""Walk through the syntax tree of a formula, in the arrangement of the text; LaTeX and MathML are subclasses."""

from __future__ import annotations

import ast
from abc import ABC, abstractmethod

from umataudit.printed.letters import LETTERS

_SUM, _PRODUCT, _POWER, _ATOM = 1, 2, 3, 4
_WORDS = {"exp", "ln", "sin", "cos", "tan", "arcsin", "arctan", "tr", "det", "diag"}
_CONSTANTS = {"pi": r"\pi", "identity": r"\mathbf 1", "identity4": r"\mathbb I", "delta": r"\delta"}
_BY_SYMBOL = {letter.symbol.name: letter for letter in LETTERS.values() if not letter.shape}


def letter_latex(name: str) -> str:
    """LaTeX of a letter, of a component of a tensor letter ("Cdot_12"), or of a name of a derivation ("G", "e_11")."""
    letter = LETTERS.get(name) or _BY_SYMBOL.get(name)
    if letter is not None:
        return letter.math
    if name in _CONSTANTS:
        return _CONSTANTS[name]
    base, _, index = name.rpartition("_")
    if base and index:
        known = LETTERS[base].math if base in LETTERS else base
        plain = known.replace(r"\mathbf ", " ").replace(r"\boldsymbol", "").strip()
        inner = f"({plain})" if "frac" in plain else f"{{{plain}}}"
        return f"{inner}_{{{index}}}"
    return name


def _without_leading_minus(node: ast.expr) -> ast.expr | None:
    """A product or quotient that begins with a minus, without it; None when it does not."""
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return node.operand
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div | ast.MatMult):
        left = _without_leading_minus(node.left)
        return None if left is None else ast.BinOp(left, node.op, node.right)
    return None


def _begins_with_a_number(node: ast.expr) -> bool:
    """Whether the text of a factor begins with a digit, so that it needs a dot before it."""
    while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.MatMult | ast.Pow):
        node = node.left
    return isinstance(node, ast.Constant)


class Writer(ABC):
    """Walks a formula; what a construction looks like is left to the subclass."""

    def write(self, text: str) -> str:
        """Text of a formula (Python syntax) in the writer's language."""
        return self._node(ast.parse(text, mode="eval").body)[0]

    def _node(self, node: ast.expr) -> tuple[str, int]:
        """What a node looks like, and how tightly it binds."""
        match node:
            case ast.Constant(value=value):
                return self.number(str(value)), _ATOM
            case ast.Name(id=name):
                return self.letter(letter_latex(name)), _ATOM
            case ast.UnaryOp(operand=inner):
                return self.row("-", self._at_least(inner, _PRODUCT)), _SUM
            case ast.BinOp(left=left, op=operator, right=right):
                positive = _without_leading_minus(node)
                if positive is not None:
                    return self.row("-", self._at_least(positive, _PRODUCT)), _SUM
                return self._binary(operator, left, right)
            case ast.Call(func=ast.Name(id=name), args=arguments):
                return self._call(name, arguments)
            case ast.Subscript(value=ast.Name(id=name), slice=indices):
                letters = ast.unparse(indices).strip("()").replace(", ", "")
                base = letter_latex(name).replace(r"\mathbf ", "").replace(r"\boldsymbol", "")
                return self.letter(f"{{{base}}}_{{{' '.join(letters)}}}"), _ATOM
        return self.word(ast.unparse(node)), _ATOM

    def _at_least(self, node: ast.expr, binding: int) -> str:
        text, bound = self._node(node)
        return text if bound >= binding else self.parentheses(text)

    def _binary(self, operator: ast.operator, left: ast.expr, right: ast.expr) -> tuple[str, int]:
        match operator:
            case ast.Add():
                if isinstance(right, ast.UnaryOp):
                    return self.row(self._node(left)[0], "-", self._at_least(right.operand, _PRODUCT)), _SUM
                return self.row(self._node(left)[0], "+", self._node(right)[0]), _SUM
            case ast.Sub():
                return self.row(self._node(left)[0], "-", self._at_least(right, _PRODUCT)), _SUM
            case ast.Div():
                return self.fraction(self._node(left)[0], self._node(right)[0]), _PRODUCT
            case ast.Pow():
                return self._power(left, right)
        return self._product(left, right), _PRODUCT

    def _product(self, left: ast.expr, right: ast.expr) -> str:
        between = "times" if _begins_with_a_number(right) else ""
        return self.row(self._at_least(left, _PRODUCT), between, self._at_least(right, _PRODUCT))

    def _power(self, base: ast.expr, exponent: ast.expr) -> tuple[str, int]:
        if isinstance(base, ast.Call) and isinstance(base.func, ast.Name) and base.func.id in {"exp", "sqrt"}:
            return self.power(self.parentheses(self._node(base)[0]), self._exponent(exponent)), _POWER
        if isinstance(base, ast.Name) and "^" in letter_latex(base.id):
            return self.power(self.parentheses(self._node(base)[0]), self._exponent(exponent)), _POWER
        return self.power(self._at_least(base, _ATOM), self._exponent(exponent)), _POWER

    def _exponent(self, node: ast.expr) -> str:
        """An exponent, quotients in one line."""
        positive = _without_leading_minus(node)
        if positive is not None:
            return self.row("-", self._exponent(positive))
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Div):
            return self.row(self._at_least(node.left, _PRODUCT), "/", self._at_least(node.right, _POWER))
        return self._node(node)[0]

    def _call(self, name: str, arguments: list[ast.expr]) -> tuple[str, int]:
        inner = [self._node(argument)[0] for argument in arguments]
        match name:
            case "sqrt":
                return self.root(inner[0]), _ATOM
            case "transpose":
                return self.power(self._at_least(arguments[0], _POWER), self.letter("T")), _POWER
            case "inv":
                return self.power(self._at_least(arguments[0], _ATOM), self.row("-", self.number("1"))), _POWER
            case "ddot" | "dyad":
                sides = [self._at_least(argument, _PRODUCT) for argument in arguments]
                return self.row(sides[0], ":" if name == "ddot" else "dyad", sides[1]), _PRODUCT
            case "maximum" | "minimum":
                return self.row(self.word(name[:3]), self.braces(self.listed(inner))), _ATOM
        word = self.word(name) if name in _WORDS else self.letter(letter_latex(name))
        return self.row(word, self.parentheses(self.listed(inner))), _ATOM

    @abstractmethod
    def number(self, text: str) -> str:
        """A number."""

    @abstractmethod
    def letter(self, latex: str) -> str:
        """A letter given in LaTeX."""

    @abstractmethod
    def word(self, text: str) -> str:
        """A function name or other upright word."""

    @abstractmethod
    def row(self, *parts: str) -> str:
        """Parts side by side; "+", "-", "/", ":", "dyad", "times" and "" are operators."""

    @abstractmethod
    def fraction(self, above: str, below: str) -> str:
        """A fraction."""

    @abstractmethod
    def power(self, base: str, exponent: str) -> str:
        """A power."""

    @abstractmethod
    def root(self, inner: str) -> str:
        """A square root."""

    @abstractmethod
    def parentheses(self, inner: str) -> str:
        """Round brackets."""

    @abstractmethod
    def braces(self, inner: str) -> str:
        """Curly brackets."""

    @abstractmethod
    def listed(self, parts: list[str]) -> str:
        """Parts with commas."""
