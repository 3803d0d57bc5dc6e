"""The one page: a report as a single HTML file without scripts or outside references."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from itertools import count
from typing import Any, ClassVar

import jinja2
from markupsafe import Markup

from plyflow.show.table import Table


@dataclass(frozen=True)
class Card:
    """One number of the summary: value, what it is, tone of the value (see `table.TONES`)."""

    value: Any
    label: str
    tone: str = ""


@dataclass(frozen=True)
class Picture:
    """A figure with its caption; the SVG text is put into the page, its ids made unique there."""

    svg: str
    caption: str
    kind: ClassVar[str] = "picture"


@dataclass(frozen=True)
class Gallery:
    """Pictures side by side where there is room."""

    pictures: Sequence[Picture]
    kind: ClassVar[str] = "gallery"


@dataclass(frozen=True)
class Items:
    """A list: bullets, or numbers if ordered."""

    lines: Sequence[str]
    ordered: bool = False
    kind: ClassVar[str] = "items"


@dataclass(frozen=True)
class Formula:
    """Mathematics in a line of its own, as MathML; within a sentence it is `Markup`."""

    mathml: str
    kind: ClassVar[str] = "formula"


@dataclass(frozen=True)
class Note:
    """A paragraph with a tone: "soft" small and grey, the others with a bar at the side."""

    text: str
    tone: str = "soft"
    kind: ClassVar[str] = "note"


@dataclass(frozen=True)
class Details:
    """Blocks that open at a click, and on paper."""

    summary: str
    blocks: Sequence[Block]
    kind: ClassVar[str] = "details"


@dataclass(frozen=True)
class Section:
    """Blocks under a heading, with an anchor to link to, and a chip (words, tone) beside the heading.

    A section within a section is a framed entry.
    """

    heading: str
    blocks: Sequence[Block]
    anchor: str = ""
    chip: tuple[str, str] | None = None
    kind: ClassVar[str] = "section"


Block = str | Table | Picture | Gallery | Items | Formula | Note | Details | Section  # str: a paragraph, Markup kept


@dataclass(frozen=True)
class Page:
    """A report.

    Parameters
    ----------
    title : str
        Title and first heading.
    lead : str
        What it is, in a few sentences.
    blocks : sequence
        Sections, and paragraphs, tables and figures outside of any.
    cards : sequence of Card
        The summary in numbers.
    assumptions, limits : sequence of str
        What the results rest on, what they do not say.
    provenance : mapping
        What it was made with; see `plain` for the values.
    """

    title: str
    lead: str
    blocks: Sequence[Block]
    cards: Sequence[Card] = ()
    assumptions: Sequence[str] = ()
    limits: Sequence[str] = ()
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def html(self) -> str:
        """The page as HTML text; what is not `Markup` is escaped."""
        numbers = count(1)
        return _template().render(page=self, inline=lambda svg: Markup(_inline(svg, next(numbers))))


def plain(value: Any) -> str:
    """A value in words: "name = value, ..." of a mapping, the entries of a list with semicolons, "none" if empty."""
    if isinstance(value, Mapping):
        return ", ".join(f"{name} = {entry}" for name, entry in value.items()) or "none"
    return "; ".join(map(str, value)) or "none" if isinstance(value, list | tuple) else str(value)


def _inline(svg: str, number: int) -> str:
    """The <svg> element alone, its ids and the references to them marked by a number."""
    element = svg[svg.index("<svg") :]
    element = re.sub(r"<metadata>.*?</metadata>\s*", "", element, flags=re.DOTALL)
    return re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>f{number}-", element)


@cache
def _template() -> jinja2.Template:
    folder = resources.files("plyflow") / "show"
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    environment.filters["plain"] = plain
    environment.globals["style"] = Markup((folder / "style.css").read_text(encoding="utf-8"))
    return environment.from_string((folder / "page.html.j2").read_text(encoding="utf-8"))
