"""Formulas as presentation MathML."""

from __future__ import annotations

import re
from html import escape
from typing import ClassVar

from umataudit.render.marks import mark
from umataudit.render.writer import Writer


class MathmlWriter(Writer):
    """Presentation MathML, without the outer element."""

    _OPERATORS: ClassVar[dict[str, str]] = {
        "dyad": "<mo>\u2297</mo>", "times": "<mo>\u00b7</mo>", "": "<mo>&#x2062;</mo>", ":": "<mo>:</mo>", "+": "<mo>+</mo>",
        "-": "<mo>\u2212</mo>", "/": "<mo>/</mo>",
    }  # fmt: skip

    def number(self, text: str) -> str:
        """A number; powers of ten written out."""
        mantissa, _, exponent = text.partition("e")
        if not exponent:
            return f"<mn>{mantissa}</mn>"
        power = str(int(exponent)).replace("-", "\u2212")
        ten = f"<msup><mn>10</mn><mn>{power}</mn></msup>"
        return f"<mrow><mn>{mantissa}</mn><mo>\u00b7</mo>{ten}</mrow>"

    def letter(self, latex: str) -> str:
        """Translated."""
        return mark(latex)

    def word(self, text: str) -> str:
        """Upright."""
        return f'<mi mathvariant="normal">{escape(text)}</mi><mo>&#x2061;</mo>'

    def row(self, *parts: str) -> str:
        """Side by side."""
        return f"<mrow>{''.join(self._OPERATORS.get(part, part) for part in parts)}</mrow>"

    def fraction(self, above: str, below: str) -> str:
        """A fraction."""
        return f"<mfrac><mrow>{above}</mrow><mrow>{below}</mrow></mfrac>"

    def power(self, base: str, exponent: str) -> str:
        """A power; beside the index when the base is an indexed letter."""
        if base.startswith("<msub>") and base.count("<msub>") == 1 and base.endswith("</msub>"):
            return f"<msubsup>{base.removeprefix('<msub>').removesuffix('</msub>')}<mrow>{exponent}</mrow></msubsup>"
        return f"<msup><mrow>{base}</mrow><mrow>{exponent}</mrow></msup>"

    def root(self, inner: str) -> str:
        """A square root."""
        return f"<msqrt>{inner}</msqrt>"

    def parentheses(self, inner: str) -> str:
        """Round brackets, sized here because they grow by themselves only where a mathematics font is installed."""
        depth = _fraction_depth(inner)
        left, right = (_bracket(mark_, depth) for mark_ in "()")
        return f"<mrow>{left}{inner}{right}</mrow>"

    def braces(self, inner: str) -> str:
        """Curly brackets that grow."""
        return f"<mrow><mo>{{</mo>{inner}<mo>}}</mo></mrow>"

    def listed(self, parts: list[str]) -> str:
        """With commas."""
        return '<mo>,</mo><mspace width="0.3em"/>'.join(parts)


def mathml(text: str) -> str:
    """MathML of a formula given as text, as one inline element."""
    return f'<math displaystyle="true">{MathmlWriter().write(text)}</math>'


def _fraction_depth(markup: str) -> int:
    """How deeply fractions are nested."""
    depth = deepest = 0
    for tag in re.findall(r"</?mfrac>", markup):
        depth += -1 if tag.startswith("</") else 1
        deepest = max(deepest, depth)
    return deepest


def _bracket(mark_: str, depth: int) -> str:
    """A bracket around fractions of a given depth."""
    if depth == 0:
        return f"<mo>{mark_}</mo>"
    size, drop = ("1.9em", "-0.2em") if depth == 1 else ("2.7em", "-0.3em")
    return f'<mpadded voffset="{drop}"><mo stretchy="false" style="font-size:{size}">{mark_}</mo></mpadded>'
