"""Line layout: one text valid as fixed and as free form."""

from __future__ import annotations

import re

import pytest

from umatgen.fortran.layout import LayoutError, lay_out
from umatgen.pipeline import generate
from umatgen.scene import SCENES, Scene


def layout_faults(text: str) -> list[str]:
    """Lines that are not valid in both forms."""
    faults = []
    for line in text.splitlines():
        comment = line.startswith("!") or not line
        code = re.fullmatch(r"(     &|      )[^&]{1,66}(&)?", line.rstrip()) and (len(line) <= 72 or line[72] == "&")
        if not (comment and len(line) <= 72) and not code:
            faults.append(line)
    return faults


@pytest.mark.parametrize("scene", SCENES.values(), ids=lambda s: s.name)
def test_every_line_is_valid_in_both_forms(scene: Scene) -> None:
    assert layout_faults(generate(scene).source) == []


def test_a_line_one_column_too_long_is_seen() -> None:
    assert layout_faults(" " * 6 + "x" * 67) != []


def test_continued_lines_join_to_the_statement() -> None:
    statement = "total = " + " + ".join(f"term_{i}*factor_{i}" for i in range(20))
    lines = lay_out([statement]).splitlines()
    assert all(line[72] == "&" for line in lines[:-1]) and all(line[5] == "&" for line in lines[1:])
    joined = "".join(line[6:72] for line in lines)
    assert joined.replace(" ", "") == statement.replace(" ", "")


def test_a_statement_without_a_place_to_break_is_refused() -> None:
    with pytest.raises(LayoutError, match="no place to break"):
        lay_out(["x" * 200])
