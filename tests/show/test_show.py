"""What every report is made of: table, page, figure, progress."""

from __future__ import annotations

import io
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest
from markupsafe import Markup
from rich.console import Console
from selenium.webdriver import Chrome

from browsing import faults_of_report
from plyflow.show.figure import panels, png, styled, svg
from plyflow.show.page import Card, Details, Formula, Gallery, Items, Note, Page, Picture, Section, plain
from plyflow.show.progress import progress
from plyflow.show.table import Cell, Column, Table

WIDTH = 60
TABLE = Table(
    [Column("case", key="name"), Column("h/h0", ".3f", "-", key="ratio", over="UMAT"), Column("remark", wrap=True)],
    [
        {"name": "CP", "ratio": 0.75, "remark": "words " * 30},
        {"name": "CP", "ratio": None, "remark": Cell("<b>", tone="bad", small="below")},
        ["BP", Cell("none at all", span=2)],
    ],
    once="name",
)


def printed(table: Table) -> str:
    console = Console(file=io.StringIO(), width=WIDTH)
    console.print(table.rich())
    return str(console.file.getvalue())  # type: ignore[attr-defined]


@styled
def drawing(slope: float = 1.0) -> str:
    figure, (axes,) = panels()
    axes.plot([0.0, 1.0], [0.0, slope], label="line")
    axes.legend()
    assert png(figure).startswith(b"\x89PNG")
    return svg(figure)


@pytest.fixture(scope="module")
def page() -> str:
    figures = Gallery([Picture(drawing(), "first"), Picture(drawing(), "<second>")])
    mathematics = ["see " + Markup("<math><mi>x</mi></math>"), Formula('<math display="block"><mi>y</mi></math>')]
    entry = Section("Eq. 1", [*mathematics, Note("a note"), Details("more", [Items(["one"], ordered=True)])], "r1", ("bad", "bad"))
    return Page(
        "A & B", "lead", [Section("All", [TABLE, figures, entry])], [Card(3, "cases", "good")], ["k = 1"], ["a point"],
        {"plyflow_version": "1", "scene": {"a": 1}},
    ).html()  # fmt: skip


class Tags(HTMLParser):
    """Ids, inner references and tags of a page; every tag must be closed."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.inner: list[str] = []
        self.open: list[str] = []
        self.seen: set[str] = set()
        self.feed(page)
        self.inner += re.findall(r"url\(#([^)]*)\)", page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note a tag, its id and what it points to."""
        self.seen.add(tag)
        self.open += [] if tag in {"meta", "br"} else [tag]
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            elif name in {"href", "xlink:href", "src"}:
                assert (value or "").startswith("#")
                self.inner.append((value or "")[1:])

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """An element without content."""
        self.handle_starttag(tag, attrs)
        if tag not in {"meta", "br"}:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        """Close the tag that is open."""
        assert self.open.pop() == tag


def check_page(page: str) -> Tags:
    tags = Tags(page)
    assert tags.open == []
    assert len(tags.ids) == len(set(tags.ids))
    assert set(tags.inner) <= set(tags.ids)
    assert not {"script", "link", "img", "iframe"} & tags.seen
    return tags


def test_the_page_is_whole_and_two_equal_figures_keep_their_own_ids(page: str) -> None:
    tags = check_page(page)
    assert {"r1", "f1-figure_1", "f2-figure_1"} <= set(tags.ids)
    assert {"math", "table", "svg", "details", "article"} <= tags.seen
    with pytest.raises(AssertionError):
        check_page(page.replace('id="f2-', 'id="f1-'))


def test_words_are_escaped_and_mathematics_passes_through(page: str) -> None:
    for expected in ("A &amp; B", "&lt;second&gt;", "&lt;b&gt;", "see <math><mi>x</mi></math>", "a = 1", "k = 1"):
        assert expected in page
    assert "<b>" not in page.replace("<b class", "")
    for rule in ('name="viewport"', "prefers-color-scheme: dark", "@media print", "max-width: 40rem", ".wide { overflow: auto"):
        assert rule in page


def test_the_same_drawing_gives_the_same_text() -> None:
    assert drawing() == drawing() != drawing(2.0)
    assert "dc:date" not in drawing()


def test_the_terminal_keeps_numbers_whole_and_shows_a_repeated_name_once() -> None:
    text = printed(TABLE)
    assert max(map(len, text.splitlines())) <= WIDTH
    assert "0.750" in text and "none at all" in text and "…" not in text
    assert text.count("CP") == 1


def test_csv_holds_names_and_whole_values() -> None:
    lines = TABLE.csv().splitlines()
    assert lines[0] == "name,ratio,remark"
    assert lines[2] == "CP,,<b>"


def test_plain_words() -> None:
    assert (plain({"a": 1, "b": 2}), plain({}), plain([1, 2]), plain(3)) == ("a = 1, b = 2", "none", "1; 2", "3")


@pytest.mark.parametrize(("lines", "said"), [(0, []), (2, ["4/6 cases, c", "6/6 cases, e"])])
def test_without_a_terminal_progress_is_a_few_lines_or_none(lines: int, said: list[str]) -> None:
    stream = io.StringIO()
    with progress(Console(file=stream), "cases", 6, done=1, lines=lines) as advance:
        for note in "abcde":
            advance(note)
    assert stream.getvalue().splitlines() == said


def test_on_a_terminal_progress_is_a_bar() -> None:
    stream = io.StringIO()
    with progress(Console(file=stream, force_terminal=True, width=100), "cases", 2) as advance:
        advance("first", count=2)
    assert "2/2" in stream.getvalue()


def test_a_reader_sees_the_whole_page(page: str, browser: Chrome, tmp_path: Path) -> None:
    assert faults_of_report(browser, page, tmp_path) == []


WRONG_PAGES = {
    "px wide in": ("<body>", '<body><div style="width: 2000px">wide</div>'),
    "rows missing": ('data-rows="3"', 'data-rows="4"'),
    "figure not shown": ("<body>", '<body><img src="nowhere.png" alt="none">'),
    "not reachable": ('<div class="wide', '<div style="overflow: hidden; height: 3rem; position: fixed; top: -9rem" class="wide'),
    "cells for": ("<tbody>\n<tr>", "<tbody>\n<tr><td></td>"),
    "on hover alone": ("<h1>", '<h1 title="why">'),
    "console": ("<body>", "<body><script>nothing()</script>"),
    "cut on paper": ("@media print {", "@media print { .wide { max-height: 2rem !important; overflow: hidden !important; }"),
    "dark mode": ("prefers-color-scheme: dark", "prefers-color-scheme: none"),
    "says 0.0000": ("lead", "0.0000"),
}


@pytest.mark.parametrize("what", WRONG_PAGES)
def test_what_a_reader_would_miss_is_noticed(what: str, page: str, browser: Chrome, tmp_path: Path) -> None:
    right, wrong = WRONG_PAGES[what]
    assert right in page
    assert any(what in fault for fault in faults_of_report(browser, page.replace(right, wrong), tmp_path))
