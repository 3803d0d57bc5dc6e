"""Formulas as LaTeX."""

from __future__ import annotations

from typing import ClassVar

from umataudit.render.writer import Writer


class LatexWriter(Writer):
    """LaTeX."""

    _OPERATORS: ClassVar[dict[str, str]] = {
        "dyad": r" \otimes ",
        "times": r" \cdot ",
        "": r" \, ",
        ":": " : ",
        "+": " + ",
        "-": " - ",
    }

    def number(self, text: str) -> str:
        """A number; powers of ten written out."""
        mantissa, _, exponent = text.partition("e")
        return f"{mantissa} \\cdot 10^{{{int(exponent)}}}" if exponent else mantissa

    def letter(self, latex: str) -> str:
        """As it is."""
        return latex

    def word(self, text: str) -> str:
        """Upright."""
        return rf"\operatorname{{{text}}}"

    def row(self, *parts: str) -> str:
        """Side by side."""
        return "".join(self._OPERATORS.get(part, part) for part in parts)

    def fraction(self, above: str, below: str) -> str:
        """A fraction."""
        return rf"\frac{{{above}}}{{{below}}}"

    def power(self, base: str, exponent: str) -> str:
        """A power."""
        return rf"{{{base}}}^{{{exponent}}}"

    def root(self, inner: str) -> str:
        """A square root."""
        return rf"\sqrt{{{inner}}}"

    def parentheses(self, inner: str) -> str:
        """Round brackets that grow."""
        return rf"\left({inner}\right)"

    def braces(self, inner: str) -> str:
        """Curly brackets that grow."""
        return rf"\left\{{{inner}\right\}}"

    def listed(self, parts: list[str]) -> str:
        """With commas."""
        return r",\; ".join(parts)


def latex(text: str) -> str:
    """LaTeX of a formula given as text."""
    return LatexWriter().write(text)
