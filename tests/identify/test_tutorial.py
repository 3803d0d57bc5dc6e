"""The tutorial: the very commands of the page are run in a shell, and what it prints is compared with the page."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from identify.making import truth

PAGE = Path(__file__).parents[2] / "docs" / "tutorial.md"
NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")
ELISION = "..."
TOLERANCE = 1e-4  # other libraries of mathematics round differently; what the page tells is four digits


@dataclass(frozen=True)
class Part:
    """A command of the page, what the page says it prints, what it did print."""

    command: str
    told: str
    printed: str


def commands(page: str) -> list[tuple[str, str]]:
    """Each `sh` block with the `text` block that follows it."""
    blocks = re.findall(r"^```(\w+)\n(.*?)^```$", page, flags=re.DOTALL | re.MULTILINE)
    kinds = [kind for kind, _ in blocks]
    assert kinds == ["sh", "text"] * (len(kinds) // 2)
    return [(command, told) for (_, command), (_, told) in zip(blocks[::2], blocks[1::2], strict=True)]


def run(command: str, folder: Path) -> str:
    """Standard error and output of a command, with the plyflow that is being tested in the path."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path, "COLUMNS": "80"}
    done = subprocess.run(
        ["/bin/sh", "-eu", "-c", command], cwd=folder, env=environment, capture_output=True, text=True, check=True
    )
    return done.stderr + done.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("tutorial")


@pytest.fixture(scope="module")
def parts(folder: Path) -> list[Part]:
    return [Part(command, told, run(command, folder)) for command, told in commands(PAGE.read_text(encoding="utf-8"))]


def check_printed(printed: str, told: str) -> None:
    """Same lines, words in place of words, numbers within the tolerance; a line of three dots stands for any lines."""
    left = [line.rstrip() for line in printed.strip().splitlines()]
    right = [line.rstrip() for line in told.strip().splitlines()]
    if ELISION in right:
        cut = right.index(ELISION)
        tail = len(right) - cut - 1
        assert len(left) > len(right)
        left, right = left[:cut] + left[len(left) - tail :], right[:cut] + right[cut + 1 :]
    assert [NUMBER.sub("#", line) for line in left] == [NUMBER.sub("#", line) for line in right]
    for ours, page in zip(left, right, strict=True):
        numbers = [float(number) for number in NUMBER.findall(ours)]
        assert numbers == pytest.approx([float(number) for number in NUMBER.findall(page)], rel=TOLERANCE), page


def test_every_command_prints_what_the_page_tells(parts: list[Part]) -> None:
    assert len(parts) == 7
    for part in parts:
        check_printed(part.printed, part.told)


def test_a_number_or_a_word_that_the_page_tells_wrongly_is_noticed(parts: list[Part]) -> None:
    thickness = next(part for part in parts if "2.0721" in part.told)
    for wrong in (thickness.told.replace("2.0721", "2.0729"), thickness.told.replace("my prepreg", "your prepreg")):
        with pytest.raises(AssertionError):
            check_printed(thickness.printed, wrong)


def test_the_numbers_in_the_text_are_those_of_the_files(parts: list[Part], folder: Path) -> None:
    text = " ".join(PAGE.read_text(encoding="utf-8").split())
    found = json.loads((folder / "fit" / "50degC" / "fit.json").read_text())
    true = truth("IM7-8552", 50.0)
    assert f"k = {true['k']:g}, a = {true['a']:g}, b = {true['b_squeeze']:g} and {true['b_bleed']:g}" in text
    for name, value in true.items():
        assert found[name]["interval"][0] <= value <= found[name]["interval"][1]
    assert found["b_squeeze"]["from"] == "b_bleed, tied"
    (own,) = json.loads((folder / "prediction" / "summary.json").read_text())
    assert f"ends {own['thickness_final_mm']:.3f} mm thick" in text
    assert f"widens by {100.0 * (own['width_ratio_final'] - 1.0):.1f} % for the first {own['lock_time']:.0f} s" in text
    command = (
        "plyflow law1d --material IM7-8552 --temperature 65 --layup BP --width 30 --plies 24 --load press.csv --json"
    )
    (paper,) = json.loads(run(command, folder))
    assert f"the paper's own table gives {paper['thickness_final_mm']:.3f} mm" in text
    for law in own["comparison"].values():
        assert law["thickness_ratio_final"] < own["thickness_ratio_limit"]
