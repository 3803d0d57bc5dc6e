"""Line layout: plain fixed form (72 columns, continuation in column 6 only), or free form.

The fixed form is valid where a site extends lines to 132 columns (Abaqus does by default) and behind a preprocessor: nothing
stands beyond column 72, and no `&` in column 73 would become part of the statement there.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Form:
    """Columns of a source form: first and last of the code, what ends a line that goes on, what begins the next one."""

    first: int
    last: int
    goes_on: str
    goes_on_from: str


FORMS = {"fixed": Form(7, 72, "", "     &"), "free": Form(1, 100, " &", "")}
_BREAK_AFTER = re.compile(r"(,\s|\.(?:AND|OR)\.\s|\s[-+*/]\s|(?<!\*)\*(?!\*)|/(?![/=])|\s=\s|\((?!\d))")
_LITERAL = re.compile(r"'[^']*'")
_LONGEST_LITERAL = 40
_INDENT = 2


class LayoutError(ValueError):
    """A statement has no place where it can be broken."""


def lay_out(lines: Iterable[str], form: str = "fixed") -> str:
    """Text of the source file from unbroken lines: comments wrapped as paragraphs, statements broken and indented by nesting.

    Raises
    ------
    LayoutError
        A statement has no place to break it.
    """
    shape, result, depth = FORMS[form], list[str](), 0
    for line in lines:
        code = line.strip()
        if not code:
            result.append("")
        elif code.startswith("!"):
            result += _comment(code, shape.last)
        else:
            depth = max(depth - _closes(code, result), 0)
            result += _statement(code, depth, shape)
            depth += _opens(code)
    return "\n".join(result) + "\n"


def _opens(code: str) -> bool:
    """Whether what follows stands one step further in."""
    upper = code.upper()
    return (
        upper.startswith(("SUBROUTINE ", "DO ", "ELSE", "CONTAINS", "CASE ", "ASSOCIATE "))
        or bool(re.match(r"IF \(.*\) THEN$", upper))
        or bool(re.match(r"(LOGICAL |DOUBLE PRECISION |PURE )*FUNCTION ", upper))
    )


def _closes(code: str, before: list[str]) -> bool:
    """Whether a line stands one step further out than the one before; a first CASE does not close another."""
    upper = code.upper()
    first_case = upper.startswith("CASE ") and before[-1].strip().upper().startswith("SELECT CASE")
    return upper.startswith(("END ", "ELSE", "CONTAINS", "CASE ")) and not first_case


def _comment(text: str, last: int) -> list[str]:
    """A paragraph wrapped at blanks; what is indented after the `!` goes on further in."""
    body = text[1:]
    indent = len(body) - len(body.lstrip(" "))
    if len(text) <= last or " " not in body.strip():
        return [text]
    following = " " * (indent if indent < 2 else indent + 2)
    return textwrap.wrap(
        body.strip(), last, initial_indent="!" + " " * indent, subsequent_indent="!" + following,
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip


def _statement(code: str, depth: int, form: Form) -> list[str]:
    indent = " " * min(_INDENT * depth, 12)
    code = _LITERAL.sub(_split_literal, code)
    width = form.last - form.first + 1 - len(indent) - len(form.goes_on)
    head = " " * (form.first - 1) + indent
    pieces = _pieces(code, width, width - _INDENT)
    lines = [head + pieces[0], *(form.goes_on_from.ljust(len(head)) + " " * _INDENT + piece for piece in pieces[1:])]
    return [line + form.goes_on for line in lines[:-1]] + lines[-1:]


def _split_literal(match: re.Match[str]) -> str:
    """A long character constant as a concatenation of short ones, split at blanks."""
    words, parts = re.findall(r"\S*\s*", match.group()[1:-1]), [""]
    for word in words:
        if len(parts[-1]) + len(word) > _LONGEST_LITERAL and parts[-1]:
            parts.append("")
        parts[-1] += word
    return "//".join(f"'{part}'" for part in parts)


def _pieces(code: str, first: int, following: int) -> list[str]:
    pieces = []
    room = first
    while len(code) > room:
        cut = _last_break(code, room)
        pieces.append(code[:cut].rstrip())
        code = code[cut:].lstrip()
        room = following
    return [*pieces, code]


def _last_break(code: str, room: int) -> int:
    quoted = [m.span() for m in _LITERAL.finditer(code)]
    cuts = [
        m.end()
        for m in _BREAK_AFTER.finditer(code)
        if len(code[: m.end()].rstrip()) <= room and not any(a < m.end() < b for a, b in quoted)
    ]
    if not cuts:
        raise LayoutError(f"no place to break the statement within {room} columns: {code[:120]}")
    return cuts[-1]
