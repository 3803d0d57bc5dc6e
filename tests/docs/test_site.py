"""The documentation site: built without a warning, whole, and without anything from outside; README within its length."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from urllib.parse import unquote

import pytest
from selenium.webdriver import Chrome

from browsing import faults
from docs.shown import ROOT

LONGEST_README = 200  # lines
PAGES_BESIDE = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "examples/README.md")


class Page(HTMLParser):
    """Ids of a page, what it links to and what it loads."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what a tag names and refers to."""
        found = {name: value or "" for name, value in attrs}
        self.ids |= {found[name] for name in ("id", "name") if name in found}
        self.links += [found["href"]] if tag == "a" and "href" in found else []
        self.loads += [found[name] for name in ("src", "href") if name in found and tag != "a"]


def broken(pages: dict[Path, Page]) -> list[str]:
    """References of pages to what is not there or comes from outside."""
    found = []
    for path, page in pages.items():
        for link in [*page.links, *page.loads]:
            if re.match(r"(https?:)?//", link):
                found += [f"{path.name} loads {link}"] if link in page.loads else []
                continue
            file, _, anchor = unquote(link).partition("#")
            target = (path.parent / file.partition("?")[0]).resolve() if file else path
            target = target / "index.html" if target.is_dir() else target
            if not target.exists() or (anchor and target in pages and anchor not in pages[target].ids):
                found.append(f"{path.name}: {link}")
    return found


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "-f", str(ROOT / "mkdocs.yml"), "-d", str(folder), "-q"]
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "WARNING" not in done.stdout + done.stderr
    return folder


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Page]:
    files = [path for path in site.rglob("*.html") if path.name != "404.html"]  # that one takes the site for a server's
    return {path: Page(path.read_text(encoding="utf-8")) for path in files}


def test_no_link_is_broken_and_nothing_comes_from_outside(pages: dict[Path, Page]) -> None:
    assert len(pages) > 15
    assert broken(pages) == []


def test_a_broken_link_an_anchor_and_a_script_from_outside_are_noticed(pages: dict[Path, Page]) -> None:
    path = next(iter(pages))
    wrong = Page('<a href="nowhere.html">x</a><a href="#nowhere">y</a><script src="https://example.org/x.js"></script>')
    assert len(broken(pages | {path: wrong})) >= 3


def test_mathematics_is_mathml_in_bold_letters_without_a_script(site: Path) -> None:
    text = (site / "model.html").read_text(encoding="utf-8")
    assert text.count("<math") > 30 and "arithmatex" not in text and "mathvariant" not in text
    assert "\N{MATHEMATICAL BOLD CAPITAL C}" in text


def test_every_command_is_in_the_reference_and_each_example_has_its_picture(site: Path) -> None:
    from plyflow.cli import MODULES

    text = (site / "commands.html").read_text(encoding="utf-8")
    assert [name for name in MODULES if f"<code>plyflow {name}" not in text] == []
    gallery = (site / "gallery.html").read_text(encoding="utf-8")
    for picture in ("thickness-thickness", "fit-correlation", "laminate-thickness"):
        assert f"gallery/{picture}.svg" in gallery and (site / "gallery" / f"{picture}.svg").is_file()


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= LONGEST_README


@pytest.mark.parametrize("name", PAGES_BESIDE)
def test_links_of_the_pages_beside_the_site_lead_somewhere(name: str) -> None:
    page = ROOT / name
    links = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    assert [link for link in links if "://" not in link and not (page.parent / link).exists()] == []


@pytest.fixture(scope="module")
def served(site: Path) -> Iterator[str]:
    """Address of the site, served as it would be elsewhere: its search does not work from the disk."""
    handler = partial(QuietHandler, directory=str(site))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


class QuietHandler(SimpleHTTPRequestHandler):
    """A file server that prints nothing."""

    def log_message(self, *_: object) -> None:
        """Say nothing."""


@pytest.mark.parametrize("page", ["index", "model", "scenes", "gallery", "commands"])
def test_a_reader_sees_the_whole_page_on_a_desk_and_on_a_telephone(page: str, served: str, browser: Chrome) -> None:
    assert faults(browser, f"{served}/{page}.html") == []
