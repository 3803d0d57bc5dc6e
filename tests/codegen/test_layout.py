"""Line layout: plain fixed form, valid with 72 and with 132 columns, and free form."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from emitted import generate
from umatgen.fortran.layout import LayoutError, lay_out
from umatgen.scene import SCENES, Scene


def layout_faults(text: str) -> list[str]:
    """Lines that are not plain fixed form of 72 columns: no `&` but in column 6."""
    lines = text.splitlines()
    return [line for line in lines if len(line) > 72 or not (line[:1] in {"", "!"} or re.fullmatch(r"     [ &][^&]+", line))]


@pytest.mark.parametrize("scene", SCENES.values(), ids=lambda s: s.name)
def test_every_line_is_plain_fixed_form(scene: Scene) -> None:
    assert layout_faults(generate(scene).source) == []


@pytest.mark.parametrize("line", [" " * 6 + "x" * 67, " " * 6 + "x = y +" + " " * 59 + "&", "     & x &"])
def test_a_line_that_is_not_is_seen(line: str) -> None:
    assert layout_faults(line) == [line]


def test_free_form_goes_on_with_an_ampersand_and_has_the_same_statements() -> None:
    fixed, free = generate(Scene()).source, generate(replace(Scene(), form="free")).source
    assert max(map(len, free.splitlines())) <= 100
    joined = [re.sub(r" &\n", "", re.sub(r"(?m)^!.*\n", "", free)), re.sub(r"\n     &", "", re.sub(r"(?m)^!.*\n", "", fixed))]
    words = [re.sub(r"\s", "", text).replace("'//'", "") for text in joined]
    assert words[0] == words[1]


def test_continued_lines_join_to_the_statement() -> None:
    statement = "total = " + " + ".join(f"term_{i}*factor_{i}" for i in range(20))
    lines = lay_out([statement]).splitlines()
    assert all(line[5] == "&" for line in lines[1:])
    joined = "".join(line[6:72] for line in lines)
    assert joined.replace(" ", "") == statement.replace(" ", "")


def test_a_case_is_indented_and_a_paragraph_wrapped() -> None:
    text = lay_out(["! " + "word " * 30, "SELECT CASE (i)", "CASE (1)", "x = 1", "CASE (2)", "x = 2", "END SELECT"])
    assert text.splitlines()[1].startswith("! word")
    assert [len(line) - len(line.lstrip()) for line in text.splitlines()[-6:]] == [6, 6, 8, 6, 8, 6]


def test_a_statement_without_a_place_to_break_is_refused() -> None:
    with pytest.raises(LayoutError, match="no place to break"):
        lay_out(["x" * 200])
