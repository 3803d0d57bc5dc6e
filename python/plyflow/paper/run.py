"""All figures, claims and their map of a call, and the files that hold them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd

from plyflow.case.assumptions import assume
from plyflow.case.materials import known_materials
from plyflow.errors import InputError
from plyflow.files import write_files
from plyflow.paper.claims import CLAIMS, Claim, Finding, judge
from plyflow.paper.claims_map import range_words, verdict_figure, verdict_table
from plyflow.paper.laminates import CLAIMS_OF_LAMINATES, LaminateModel
from plyflow.paper.laminates import FIGURES as OF_LAMINATES
from plyflow.paper.model import SIZES, Model
from plyflow.paper.over_temperature import figure_2a, figure_11, final_thickness
from plyflow.paper.over_time import figure_2b, figure_6b, figure_8
from plyflow.paper.paper_figure import PaperFigure
from plyflow.paper.parameters import figure_6a, figure_7
from plyflow.show.figure import styled, svg
from plyflow.show.page import Note, Page, Picture, Section
from plyflow.show.table import Cell, Column, Table

FIGURES: Mapping[str, Callable[[Model], PaperFigure]] = {
    "2a": figure_2a,
    "2b": figure_2b,
    "6a": figure_6a,
    "6b": figure_6b,
    "7": figure_7,
    "8": figure_8,
    "9": partial(final_thickness, number="9", material="IM7-8552"),
    "10": partial(final_thickness, number="10", material="IMA-M21"),
    "11": figure_11,
}
FOREWORD = (
    "Computed by plyflow from the model of Belnoue, Nixon-Pearson, Ivanov and Hallett, Mechanics of Materials (2016). "
    "The paper's measured points are not published as numbers and none are drawn. A verdict says what the model does "
    "with the assumptions below, by bounds that are ours, because the paper gives none; where only the measurement "
    "could decide, it says so."
)
TONES = {"holds": "good", "does not hold": "bad", "cannot be judged": "warn"}
CLAIM_COLUMNS = (Column("claim", wrap=True), Column("verdict"), Column("number", wrap=True))


@dataclass(frozen=True)
class Report:
    """What a call made: figures, findings by claim, how they fare over the ranges in words (empty without the map)."""

    model: Model
    figures: Sequence[PaperFigure]
    findings: Mapping[str, Finding]
    ranges: Mapping[str, str]
    judged: Sequence[Claim] = CLAIMS

    def assumptions(self) -> list[str]:
        """What all of it rests on."""
        lines = [str(entry) for entry in assume(self.model.settings).values()]
        changed = [f"{name} = {value:g}" for name, value in self.model.settings.items()]
        if isinstance(self.model, LaminateModel):
            lines.append(self.model.words)
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
        for claim in self.judged if self.findings else ():
            finding = self.findings[claim.key]
            row = {"claim": claim.key, "text": claim.text, "source": claim.source, "criterion": claim.criterion}
            verdict = {"verdict": finding.verdict.value, "number": finding.number, "words": finding.words}
            rows.append(row | verdict | {"range": self.ranges.get(claim.key, "not computed (--no-map)")})
        return pd.DataFrame(rows)

    def page(self) -> str:
        """Claims and figures as one HTML page."""
        verdicts = self.claims()["verdict"].value_counts(sort=False)
        counts = ", ".join(f"{verdict}: {count}" for verdict, count in verdicts.items()) + "."
        columns = [*CLAIM_COLUMNS, Column("over gamma_lock and l0/d", wrap=True)]
        table = Table(columns, map(_claim_row, self.claims().to_dict("records")))
        figures = [self._section(figure) for figure in self.figures]
        sections = [Section("Claims", [counts, table]), Section("Figures", figures)]
        page = Page("Figures and claims", FOREWORD, sections, assumptions=self.assumptions(), provenance=self.provenance())
        return page.html()

    def _section(self, figure: PaperFigure) -> Section:
        heading = f"Fig. {figure.number}: {figure.original}" if figure.number in FIGURES else "Verdicts over the assumptions"
        said = f"Data {figure.name}.csv, drawing {figure.name}.svg and {figure.name}.png, command {self.command(figure)}"
        return Section(heading, [Picture(svg(figure.figure), figure.caption), Note(said)], figure.name)


def claims_table(report: Report) -> Table:
    """Verdicts and numbers for the terminal."""
    rows = [(row["text"], Cell(row["verdict"], TONES[row["verdict"]]), row["words"]) for row in report.claims().to_dict("records")]
    return Table(CLAIM_COLUMNS, rows, "the paper's claims by the model")


def make_report(
    settings: Mapping[str, float],
    only: Sequence[str] = (),
    with_map: bool = True,
    step: Callable[[str], object] = lambda what: None,
    laminates: LaminateModel | None = None,
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
    laminates : LaminateModel or None
        Cases of finite elements in the place of the UMAT's; only the figures that show them, and the claims by them.

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
    if laminates is not None:
        return _of_laminates(laminates, settings, only, step)
    model = Model(dict(settings))
    figures = []
    for number in (number for number in FIGURES if not only or number in only):
        step(f"figure {number}")
        figures.append(styled(FIGURES[number])(model))
    if only:
        return Report(model, figures, {}, {})
    step("claims")
    findings = judge(model.programme)
    if not with_map:
        return Report(model, figures, findings, {})
    step("claims over gamma_lock and l0/d")
    table = verdict_table(settings)
    figures.append(verdict_figure(table, model.locking_angles, assume(settings)["l0_over_d"].value))
    return Report(model, figures, findings, range_words(table))


def _of_laminates(
    model: LaminateModel, settings: Mapping[str, float], only: Sequence[str], step: Callable[[str], object]
) -> Report:
    other = next((number for number in only if number not in OF_LAMINATES), None)
    if other is not None:
        raise InputError(f"figure {other} is none of section 5: with laminates choose of {', '.join(OF_LAMINATES)}")
    if settings:
        raise InputError(f"--set {next(iter(settings))}: the laminates are those of the file; sweep them with that setting")
    kinds = ("material", "layup", "width")
    kept = set(model.driven[list(kinds)].itertuples(index=False, name=None))
    for kind in itertools.product(known_materials(), ("BP", "CP"), SIZES):
        if kind not in kept:
            label = " ".join(str(part) for part in kind[:2]) + f" {kind[2]:g} mm"
            raise InputError(f"no laminate of {label} in the file: the figures take both materials, BP and CP, 15 and 30 mm")
    figures = []
    for number in (number for number in OF_LAMINATES if not only or number in only):
        step(f"figure {number}")
        figures.append(styled(FIGURES[number])(model))
    findings = {} if only or model.missing else judge(model.claims_table(), CLAIMS_OF_LAMINATES)
    return Report(model, figures, findings, {}, CLAIMS_OF_LAMINATES)


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
    files = {name: content for figure in report.figures for name, content in figure.files().items()}
    captions = {figure.name: {"caption": figure.caption, "command": report.command(figure)} for figure in report.figures}
    name = "figures.json" if report.findings else "figures-" + "-".join(f.number for f in report.figures) + ".json"
    files[name] = {"figures": captions, "assumptions": report.assumptions(), "provenance": report.provenance()}
    if report.findings:
        files |= {"claims.csv": report.claims(), "index.html": report.page()}
    return write_files(folder, files)


def _claim_row(claim: Mapping[Any, Any]) -> list[Any]:
    said = f"[{claim['claim']}] {claim['source']}; criterion: {claim['criterion']}"
    return [Cell(claim["text"], small=said), Cell(claim["verdict"], TONES[claim["verdict"]]), claim["words"], claim["range"]]
