"""Line layout valid as fixed and as free form at once: code in columns 7-72, `&` in 73 and, on the next line, in 6."""

from __future__ import annotations

import re
from collections.abc import Iterable

FIRST, LAST = 7, 72
WIDTH = LAST - FIRST + 1
_BREAK_AFTER = re.compile(r"(,\s|\.(?:AND|OR)\.\s|\s[-+*/]\s|(?<!\*)\*(?!\*)|/(?![/=])|\s=\s|\((?!\d))")
_LITERAL = re.compile(r"'[^']*'")
_LONGEST_LITERAL = 40
_INDENT = 2


class LayoutError(ValueError):
    """A statement has no place where it can be broken."""


def lay_out(lines: Iterable[str], both_forms: bool = True) -> str:
    """Text of the source file from unbroken lines: comments in column 1, statements broken and indented by nesting.

    Without `both_forms` there is no `&` in column 73: plain fixed form, also valid where the site extends lines to column 132.
    """
    text = "\n".join(_laid_out(lines)) + "\n"
    return text if both_forms else re.sub(r" *&$", "", text, flags=re.MULTILINE)


def _laid_out(lines: Iterable[str]) -> list[str]:
    result: list[str] = []
    depth = 0
    for line in lines:
        stripped = line.strip()
        if not stripped:
            result.append("")
            continue
        if stripped.startswith("!"):
            result += _comment(stripped)
            continue
        code = stripped
        if _closes(code):
            depth = max(depth - 1, 0)
        result += _statement(code, depth)
        if _opens(code):
            depth += 1
    return result


def _opens(code: str) -> bool:
    upper = code.upper()
    return (
        upper.startswith(("SUBROUTINE ", "DO ", "ELSE", "CONTAINS"))
        or bool(re.match(r"IF \(.*\) THEN$", upper))
        or bool(re.match(r"(LOGICAL |DOUBLE PRECISION |PURE )*FUNCTION ", upper))
    )


def _closes(code: str) -> bool:
    return code.upper().startswith(("END ", "ELSE", "CONTAINS"))


def _comment(text: str) -> list[str]:
    """Comment lines of at most 72 columns, broken at blanks."""
    lines = []
    while len(text) > LAST:
        cut = text.rfind(" ", 0, LAST)
        if cut <= 4:
            break
        lines.append(text[:cut].rstrip())
        text = "!     " + text[cut:].strip()
    return [*lines, text]


def _statement(code: str, depth: int) -> list[str]:
    indent = " " * min(_INDENT * depth, 12)
    code = _LITERAL.sub(_split_literal, code)
    pieces = _pieces(code, WIDTH - len(indent), WIDTH - len(indent) - _INDENT)
    lines = []
    for number, piece in enumerate(pieces):
        head = " " * 6 if number == 0 else " " * 5 + "&"
        text = head + indent + ("" if number == 0 else " " * _INDENT) + piece
        lines.append(text if number == len(pieces) - 1 else text.ljust(LAST) + "&")
    return lines


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
