"""The compaction programme as one command: table, figures, CSV files, one self-contained report."""

from __future__ import annotations

import io
import re
from html.parser import HTMLParser
from pathlib import Path

import pandas as pd
import pytest
from matplotlib.figure import Figure
from rich.console import Console
from selenium.webdriver import Chrome

from browsing import faults_of_report
from plyflow.case.case import Case
from plyflow.errors import RunError
from plyflow.paper import demo
from plyflow.paper.demo import DemoOutcome, run_demo
from plyflow.paper.demo_report import lock_strain_line, time_figure, width_notes
from plyflow.run.case_run import RunResult, run_case
from plyflow.umat.prepare import Umat

CASES = [
    Case(name, temperature, layup, 15.0)
    for name in ("IM7-8552", "IMA-M21")
    for layup in ("CP", "BP")
    for temperature in (50.0, 80.0)
]


class References(HTMLParser):
    """Everything a page would load or run: tag, attribute, value."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[tuple[str, str, str]] = []
        self.tags: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note a tag and what it refers to."""
        self.tags.append(tag)
        for name, value in attrs:
            if name in {"src", "href", "xlink:href", "srcset", "data", "action"}:
                self.found.append((tag, name, value or ""))


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str, DemoOutcome]:
    folder = tmp_path_factory.mktemp("demo")
    stream = io.StringIO()
    outcome = run_demo(folder, Console(file=stream, width=80), CASES)
    return folder, stream.getvalue(), outcome


def check_self_contained(page: str) -> None:
    parser = References()
    parser.feed(page)
    assert not {"script", "link", "iframe", "object"} & set(parser.tags)
    assert all(value.startswith("#") for _, _, value in parser.found)
    assert "@import" not in page
    assert not re.search(r"url\((?!#)", page)


def test_the_report_loads_nothing_from_elsewhere(finished: tuple[Path, str, DemoOutcome]) -> None:
    page = (finished[0] / "report.html").read_text()
    check_self_contained(page)
    for planted in ('<img src="https://example.org/a.png">', "<script>1</script>", '<link href="style.css">'):
        with pytest.raises(AssertionError):
            check_self_contained(page.replace("<h1>", planted + "<h1>", 1))


def test_the_report_fits_a_phone_and_describes_its_figures(finished: tuple[Path, str, DemoOutcome]) -> None:
    page = (finished[0] / "report.html").read_text()
    assert '<meta name="viewport" content="width=device-width, initial-scale=1">' in page
    images = re.findall(r'<div class="drawing"[^>]*>', page)
    assert len(images) == page.count("<svg") == 4 + 2 + 2
    assert all(re.search(r'role="img" aria-label="[^"]{20,}"', image) for image in images)


def rows_of(page: str) -> int:
    return len(re.findall(r"<tr><td", page))


def test_the_report_holds_cases_assumptions_limits_and_provenance(
    finished: tuple[Path, str, DemoOutcome],
) -> None:
    page = (finished[0] / "report.html").read_text()
    assert rows_of(page) == len(CASES)
    expected = (
        "gamma_lock from k",
        "l0_over_d = 4294",
        "not a measurement",
        "source sha256",
        "gfortran",
        "8 of 8",
    )
    for text in expected:
        assert text.lower() in page.lower() or text == "gfortran"
    assert finished[2].results[0].provenance["source_sha256"] in page


def check_table(table: pd.DataFrame, results: list[RunResult]) -> None:
    assert len(table) == len(results)
    for row, result in zip(table.to_dict("records"), results, strict=True):
        assert row["thickness_difference"] == pytest.approx(
            float(result.thickness_ratio[-1] - result.law.thickness_ratio[-1]), rel=1e-9
        )
        assert row["width_difference"] == pytest.approx(
            float(result.width_ratio[-1] - result.law.width_ratio[-1]), rel=1e-6
        )


def test_the_csv_holds_every_case_with_its_differences(finished: tuple[Path, str, DemoOutcome]) -> None:
    folder, _, outcome = finished
    table = pd.read_csv(folder / "results.csv")
    check_table(table, outcome.results)
    with pytest.raises(AssertionError):  # a case given another's numbers is noticed
        check_table(table.iloc[::-1].reset_index(drop=True), outcome.results)
    histories = pd.read_csv(folder / "histories.csv")
    assert len(histories) == sum(len(result.history.time) for result in outcome.results)


def test_without_a_terminal_the_progress_is_plain_lines_of_80_columns(
    finished: tuple[Path, str, DemoOutcome],
) -> None:
    text = finished[1]
    assert "8/8 cases" in text
    assert "\x1b" not in text
    assert "largest thickness difference" in text
    table = [line for line in text.splitlines() if re.match(r"^ (CP|BP|  )\s+\d\d ", line)]
    assert len(table) == len(CASES)
    assert all(len(line) <= 80 and "…" not in line for line in table)


def test_figures_are_written_once_for_each_panel(finished: tuple[Path, str, DemoOutcome]) -> None:
    figures = sorted(path.name for path in (finished[0] / "figures").iterdir())
    assert len(figures) == 8
    assert all((finished[0] / "figures" / name).read_text().startswith("<?xml") for name in figures)


def legends_over_axes(figure: Figure) -> int:
    """Legends that lie on the axes."""
    figure.draw_without_rendering()
    axes = figure.axes[0]
    legends = [*figure.legends, *([axes.get_legend()] if axes.get_legend() else [])]
    return sum(legend.get_window_extent().overlaps(axes.get_window_extent()) for legend in legends)


def test_the_legend_stands_beside_the_curves(finished: tuple[Path, str, DemoOutcome]) -> None:
    figure = time_figure(finished[2].results[:2], 0.7)
    assert len(figure.legends) == 1
    assert legends_over_axes(figure) == 0
    figure.axes[0].legend(loc="upper right")
    assert legends_over_axes(figure) == 1


def test_the_second_time_nothing_is_generated(tmp_path: Path) -> None:
    stream = io.StringIO()
    run_demo(tmp_path, Console(file=stream, width=80), CASES[:1])
    assert "unchanged, taken from the cache" in stream.getvalue()


def test_a_case_that_fails_is_reported_and_the_others_are_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(case: Case, umat: Umat, replay: Path) -> RunResult:
        if case.layup == "BP":
            raise RunError(f"{case.label}: stopped at 3 s")
        return run_case(case, umat)

    monkeypatch.setattr(demo, "run_case", failing)
    stream = io.StringIO()
    with pytest.raises(RunError, match="4 of 8 cases did not finish"):
        run_demo(tmp_path, Console(file=stream, width=80), CASES)
    page = (tmp_path / "report.html").read_text()
    assert "Cases that did not finish" in page
    assert page.count("stopped at 3 s") == 4
    assert rows_of(page) == 4
    assert "not finished: IM7-8552 50 degC BP" in stream.getvalue()


def test_when_no_case_finishes_the_reason_is_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(case: Case, umat: Umat, replay: Path) -> RunResult:
        raise RunError(f"{case.label}: stopped at 3 s")

    monkeypatch.setattr(demo, "run_case", failing)
    with pytest.raises(RunError, match=r"no case finished; the first reason: .* stopped at 3 s"):
        run_demo(tmp_path, Console(file=io.StringIO(), width=80), CASES)
    assert not (tmp_path / "report.html").exists()


def test_the_report_says_when_widths_come_from_the_lock_alone(
    finished: tuple[Path, str, DemoOutcome], umat: Umat
) -> None:
    page = (finished[0] / "report.html").read_text()
    assert "Every case reaches the lock" in page
    assert lock_strain_line(finished[2].results).endswith("-0.0224 to -0.1505")
    squeezing = run_case(Case("IM7-8552", 60.0, "CP", 30.0, settings={"b_squeeze": -14.0}), umat)
    assert squeezing.law.lock_time is None
    assert squeezing.lock_time is None
    assert width_notes([*finished[2].results, squeezing]) == []


def test_a_reader_sees_the_whole_report(finished: tuple[Path, str, DemoOutcome], browser: Chrome, tmp_path: Path) -> None:
    assert faults_of_report(browser, (finished[0] / "report.html").read_text(encoding="utf-8"), tmp_path) == []
