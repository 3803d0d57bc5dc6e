"""The map of the house is true: the files of its last table exist and define their terms, and its rooms are the rooms."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "architecture.md"


def places(text: str) -> list[tuple[str, str]]:
    """File and term of each row of the table "Where do I change"."""
    table = text.split("## Where do I change")[1]
    return re.findall(r"^\| [^|]+ \| `([^`]+)` \| `([^`]+)` \|$", table, flags=re.MULTILINE)


def missing(path: str, term: str) -> bool:
    """Whether a file of the repository is absent or does not define a term."""
    file, defined = ROOT / path, rf"^(?:def )?{re.escape(term)}\b"
    return not file.is_file() or not re.search(defined, file.read_text(encoding="utf-8"), flags=re.MULTILINE)


def test_the_table_answers_ten_questions() -> None:
    assert len(places(PAGE.read_text(encoding="utf-8"))) == 10


@pytest.mark.parametrize(("path", "term"), places(PAGE.read_text(encoding="utf-8")))
def test_each_file_of_the_table_defines_its_term(path: str, term: str) -> None:
    assert not missing(path, term)


def test_a_wrong_answer_is_noticed() -> None:
    assert missing("codegen/umatgen/model/nowhere.py", "factor_f")
    assert missing("codegen/umatgen/model/viscous.py", "factor")


def test_the_rooms_on_the_page_are_the_rooms_in_their_order() -> None:
    table = PAGE.read_text(encoding="utf-8").split("| room | what it has |")[1].split("\n\n")[0]
    named = re.findall(r"^\| `(\w+)` \|", table, flags=re.MULTILINE)
    assert set(named) == {p.parent.name for p in (ROOT / "python" / "plyflow").glob("*/__init__.py")}
    imports = (ROOT / "tests" / "codegen" / "test_import_directions.py").read_text(encoding="utf-8")
    (order,) = re.findall(r"^ORDER = \((.*?)^\)", imports, flags=re.DOTALL | re.MULTILINE)
    assert named == re.findall(r'"(\w+)"', order)
