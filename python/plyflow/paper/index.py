"""The index page of figures and claims: one HTML file that needs nothing else, and the same in Markdown."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from importlib import resources
from typing import TYPE_CHECKING, Any

import jinja2

if TYPE_CHECKING:
    from plyflow.paper.run import Report

FOREWORD = (
    "Computed by plyflow from the model of Belnoue, Nixon-Pearson, Ivanov and Hallett, Mechanics of Materials (2016). "
    "The paper's measured points are not published as numbers and none are drawn. A verdict says what the model does "
    "with the assumptions below, by bounds that are ours, because the paper gives none; where only the measurement "
    "could decide, it says so."
)


def html_page(report: Report, images: Mapping[str, bytes]) -> str:
    """The page as HTML with the images in it."""
    sources = {name: base64.b64encode(image).decode("ascii") for name, image in images.items()}
    return _render("index.html.j2", report, sources, autoescape=True)


def markdown_page(report: Report) -> str:
    """The page as Markdown with links to the images beside it."""
    return _render("index.md.j2", report, {}, autoescape=False)


def _render(name: str, report: Report, sources: Mapping[str, str], autoescape: bool) -> str:
    template = (resources.files("plyflow") / "paper" / name).read_text(encoding="utf-8")
    environment = jinja2.Environment(
        autoescape=autoescape, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True,
        keep_trailing_newline=True,
    )  # fmt: skip
    provenance: dict[str, Any] = report.provenance()
    for key in ("scene", "settings"):
        provenance[key] = ", ".join(f"{field} = {value}" for field, value in provenance[key].items()) or "none"
    claims = report.claims().to_dict("records")
    return environment.from_string(template).render(
        foreword=FOREWORD,
        figures=report.figures,
        commands={figure.name: report.command(figure) for figure in report.figures},
        sources=sources,
        claims=claims,
        counts={verdict: sum(claim["verdict"] == verdict for claim in claims) for verdict in _verdicts(claims)},
        assumptions=report.assumptions(),
        provenance=provenance,
    )


def _verdicts(claims: list[dict[Any, Any]]) -> list[str]:
    return list(dict.fromkeys(str(claim["verdict"]) for claim in claims))
