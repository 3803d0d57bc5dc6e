"""All figures, claims and their map of a call, and the files that hold them."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import pandas as pd

from plyflow.case.assumptions import assume
from plyflow.errors import InputError
from plyflow.paper.claims import CLAIMS, Finding, judge
from plyflow.paper.claims_figure import verdict_figure
from plyflow.paper.histories import figure_2b, figure_6b, figure_8
from plyflow.paper.model import Model
from plyflow.paper.output import write_all
from plyflow.paper.paper_figure import STYLE, PaperFigure
from plyflow.paper.parameters import figure_6a, figure_7
from plyflow.paper.thickness import figure_9, figure_10
from plyflow.paper.verdict_map import range_words, verdict_table
from plyflow.paper.widths import figure_2a, figure_11

FIGURES: Mapping[str, Callable[[Model], PaperFigure]] = {
    "2a": figure_2a,
    "2b": figure_2b,
    "6a": figure_6a,
    "6b": figure_6b,
    "7": figure_7,
    "8": figure_8,
    "9": figure_9,
    "10": figure_10,
    "11": figure_11,
}
Step = Callable[[str], None]


@dataclass(frozen=True)
class Report:
    """What a call made: figures, findings by claim, how they fare over the ranges in words (empty without the map)."""

    model: Model
    figures: Sequence[PaperFigure]
    findings: Mapping[str, Finding]
    ranges: Mapping[str, str]

    def assumptions(self) -> list[str]:
        """What all of it rests on."""
        lines = [str(entry) for entry in assume(self.model.settings).values()]
        changed = [f"{name} = {value:g}" for name, value in self.model.settings.items()]
        return lines + ([f"set for this call: {', '.join(changed)}"] if changed else [])

    def command(self, figure: PaperFigure) -> str:
        """Command that makes a figure again."""
        return figure.command + "".join(f" --set {name}={value!r}" for name, value in self.model.settings.items())

    def provenance(self) -> dict[str, Any]:
        """Tools, generated source and settings."""
        made = self.model.umat.provenance.as_dict()
        return made | {"settings": dict(self.model.settings), "load": "ramp-dwell"}

    def claims(self) -> pd.DataFrame:
        """A row a claim: text, source, criterion, verdict, number, in words, over the ranges."""
        rows = []
        for claim in CLAIMS if self.findings else ():
            finding = self.findings[claim.key]
            row = {"claim": claim.key, "text": claim.text, "source": claim.source, "criterion": claim.criterion}
            verdict = {"verdict": finding.verdict.value, "number": finding.number, "words": finding.words}
            rows.append(row | verdict | {"range": self.ranges.get(claim.key, "not computed (--no-map)")})
        return pd.DataFrame(rows)


def make_report(
    settings: Mapping[str, float], only: Sequence[str] = (), with_map: bool = True, step: Step | None = None
) -> Report:
    """Make the figures, and unless only some are wanted the claims.

    Parameters
    ----------
    settings : mapping
        Assumptions and constants of the law by name.
    only : sequence of str
        Numbers of the figures wanted; all and the claims if empty.
    with_map : bool
        Judge the claims over the ranges of gamma_lock and l0/d too.
    step : callable
        Told what is made next.

    Raises
    ------
    InputError
        No such figure, unknown or impossible setting.
    RunError
        A case could not be finished.
    """
    unknown = next((number for number in only if number not in FIGURES), None)
    if unknown is not None:
        raise InputError(f"no figure '{unknown}': choose of {', '.join(FIGURES)}")
    step = step or _silent
    model = Model(dict(settings))
    wanted = [number for number in FIGURES if not only or number in only]
    figures = [_figure(model, number, step) for number in wanted]
    if only:
        return Report(model, figures, {}, {})
    step("claims")
    findings = judge(model.programme)
    if not with_map:
        return Report(model, figures, findings, {})
    step("claims over gamma_lock and l0/d")
    table = verdict_table(settings)
    assumed = assume(settings)
    figures.append(verdict_figure(table, assumed["gamma_lock"].value, assumed["l0_over_d"].value))
    return Report(model, figures, findings, range_words(table))


def report_steps(only: Sequence[str], with_map: bool) -> int:
    """How many times `step` is told something."""
    return len(set(only)) if only else len(FIGURES) + 1 + with_map


def write_report(report: Report, folder: Path) -> list[Path]:
    """Write every figure as PNG, SVG and CSV; with the claims, an index page too.

    Raises
    ------
    OutputError
        The folder cannot be written; nothing is left half written.
    """
    from plyflow.paper.index import html_page, markdown_page  # noqa: PLC0415

    texts: dict[str, str] = {}
    for figure in report.figures:
        texts |= {f"{figure.name}.svg": figure.svg(), f"{figure.name}.csv": figure.csv()}
    images = {f"{figure.name}.png": figure.png() for figure in report.figures}
    made = {"assumptions": report.assumptions(), "provenance": report.provenance()}
    captions = {figure.name: {"caption": figure.caption, "command": report.command(figure)} for figure in report.figures}
    name = "figures.json" if report.findings else "figures-" + "-".join(f.number for f in report.figures) + ".json"
    texts[name] = json.dumps({"figures": captions} | made, indent=2) + "\n"
    if report.findings:
        texts["claims.csv"] = report.claims().to_csv(index=False, lineterminator="\n")
        texts["index.md"] = markdown_page(report)
        texts["index.html"] = html_page(report, images)
    return write_all(folder, texts, images)


def _silent(what: str) -> None:
    """Nobody is told."""


def _figure(model: Model, number: str, step: Step) -> PaperFigure:
    step(f"figure {number}")
    with matplotlib.rc_context(STYLE):
        return FIGURES[number](model)
