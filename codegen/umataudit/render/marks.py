"""The LaTeX of single letters to MathML: letters, Greek, sub- and superscripts, accents, roots, fractions, text."""

from __future__ import annotations

import re
from html import escape

_TOKEN = re.compile(r"\\[A-Za-z]+|\\.|[{}_^']|[^\\{}_^'\s]|\s+")
_GREEK = {
    name: chr(code)
    for name, code in {
        "alpha": 0x3B1, "beta": 0x3B2, "gamma": 0x3B3, "delta": 0x3B4, "eta": 0x3B7, "theta": 0x3B8, "kappa": 0x3BA,
        "lambda": 0x3BB, "mu": 0x3BC, "nu": 0x3BD, "pi": 0x3C0, "sigma": 0x3C3, "tau": 0x3C4, "varepsilon": 0x3B5,
        "chi": 0x3C7, "psi": 0x3C8, "Delta": 0x394, "partial": 0x2202, "nabla": 0x2207,
    }.items()
}  # fmt: skip
_ACCENTS = {"dot": "\u0307", "bar": "\u0304"}  # combining marks: an accent element needs a mathematics font
_DOUBLE_STRUCK = {"C": "\u2102", "I": "\U0001d540"}


def mark(latex: str) -> str:
    """MathML of a letter given in LaTeX."""
    return _Reader(latex).row()


class _Reader:
    """Recursive descent over the few constructions that letters use."""

    def __init__(self, latex: str) -> None:
        self._tokens: list[str] = [token for token in _TOKEN.findall(latex) if not token.isspace() or "\\text" in latex]
        self._next = 0

    def row(self, until: str = "") -> str:
        """Everything up to a closing token."""
        parts = []
        while self._next < len(self._tokens) and self._tokens[self._next] != until:
            parts.append(self._scripted())
        self._next += 1
        return parts[0] if len(parts) == 1 else f"<mrow>{''.join(parts)}</mrow>"

    def _scripted(self) -> str:
        base = self._one()
        scripts: dict[str, str] = {}
        while self._next < len(self._tokens) and self._tokens[self._next] in "_^'":
            kind = self._take()
            scripts["^" if kind == "'" else kind] = "<mo>\u2032</mo>" if kind == "'" else self._one()
        if len(scripts) == 2:
            return f"<msubsup>{base}{scripts['_']}{scripts['^']}</msubsup>"
        if "_" in scripts:
            return f"<msub>{base}{scripts['_']}</msub>"
        return f"<msup>{base}{scripts['^']}</msup>" if scripts else base

    def _take(self) -> str:
        self._next += 1
        return self._tokens[self._next - 1]

    def _one(self) -> str:
        token = self._take()
        if token == "{":
            return self._group()
        if token.startswith("\\"):
            return self._command(token[1:])
        if token.isdigit():
            return f"<mn>{token}</mn>"
        return f"<mi>{escape(token)}</mi>" if token.isalpha() else f"<mo>{escape(token)}</mo>"

    def _group(self) -> str:
        """A group of several plain letters is a word (upright), anything else a row."""
        end, word = self._next, ""
        while end < len(self._tokens) and self._tokens[end].isalpha() and len(self._tokens[end]) == 1:
            word += self._tokens[end]
            end += 1
        if len(word) > 2 and self._tokens[end] == "}":
            self._next = end + 1
            return f"<mi>{word}</mi>"
        return self.row("}")

    def _command(self, name: str) -> str:
        if name in _ACCENTS:
            marked = self._one().replace("</mi>", f"{_ACCENTS[name]}</mi>", 1)
            return marked.replace("<mi>", '<mi style="font-style:italic">', 1)
        match name:
            case "mathbb":
                return f"<mi>{_DOUBLE_STRUCK[self._take()]}</mi>"
            case "mathbf" | "boldsymbol":
                return f'<mrow style="font-weight:bold">{self._one()}</mrow>'
            case "sqrt":
                return f"<msqrt>{self._one()}</msqrt>"
            case "frac":
                return f"<mfrac>{self._one()}{self._one()}</mfrac>"
            case "text":
                return self._words()
        return f"<mi>{_GREEK.get(name, escape(name))}</mi>"

    def _words(self) -> str:
        self._take()
        words = []
        while (token := self._take()) != "}":
            words.append(token)
        return f"<mtext>{escape(''.join(words))}</mtext>"
