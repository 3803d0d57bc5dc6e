"""Words of messages: numbers with their noun, the known name nearest to a mistyped one."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


def count_text(count: int, one: str, many: str) -> str:
    """A count with its noun: 1 ply, 2 plies."""
    return f"{count} {one if count == 1 else many}"


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """The known name nearest to a mistyped one as ", did you mean NAME?"; empty if none is near."""
    by_lower_name = {one.lower(): one for one in known}
    near = get_close_matches(name.lower(), by_lower_name, n=1)
    return f", did you mean {by_lower_name[near[0]]}?" if near else ""


def known_text(name: str, known: Iterable[str]) -> str:
    """What follows "unknown ... 'NAME'": the nearest known name, if one is near, and all of them."""
    listed = list(known)
    near = did_you_mean(name, listed)
    return f"{near} Known are {', '.join(listed)}" if near else f": known are {', '.join(listed)}"
