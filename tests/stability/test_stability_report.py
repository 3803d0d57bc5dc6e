"""The table as a page and as JSON, and the command."""

import json
from pathlib import Path

import pytest
import typer
from rich.console import Console
from selenium.webdriver import Chrome
from typer.testing import CliRunner

from browsing import faults_of_report
from planting import ERRORS
from plyflow.cli.report import stability as command
from plyflow.errors import OutputError, RunError
from plyflow.evidence.stability import run
from plyflow.evidence.stability.cells import Verdict
from plyflow.evidence.stability.matrix import Matrix, all_tasks, run_matrix
from plyflow.evidence.stability.report import number, to_html, to_json
from plyflow.evidence.stability.subject import Subject

TWO = ("Input without an answer", "Rates and time increments")


@pytest.fixture
def application() -> typer.Typer:
    app = typer.Typer()
    app.callback()(lambda: None)
    app.command("stability")(command)
    return app


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two groups only."""
    monkeypatch.setattr(run, "all_tasks", lambda subject: all_tasks(subject, TWO))


def test_page_needs_nothing_but_itself(matrix: Matrix) -> None:
    page = to_html(matrix)
    for outside in ("<script", "<link", "<iframe", "<object", "<img", "src=", "@import", "url("):
        assert outside not in page


@pytest.mark.parametrize("render", [to_html, to_json])
def test_every_check_and_claim_is_in_the_table(matrix: Matrix, render: object) -> None:
    text = render(matrix) if callable(render) else ""
    plain = text.replace("&lt;", "<").replace("&gt;", ">").replace("&#39;", "'")
    for cell in matrix.cells:
        assert cell.check.name in plain and cell.check.measures in plain and cell.check.claim in plain


def test_json_has_a_verdict_a_reason_and_a_number_in_every_cell(matrix: Matrix) -> None:
    content = json.loads(to_json(matrix))
    assert len(content["cells"]) == len(matrix.cells)
    assert sum(content["summary"][str(verdict)] for verdict in Verdict) == len(matrix.cells)
    for cell in content["cells"]:
        assert cell["verdict"] in {str(verdict) for verdict in Verdict}
        assert cell["measured"] is not None or cell["reason"]
        assert isinstance(cell["bound"], int | float)


def test_provenance_names_inputs_assumptions_compiler_and_versions(matrix: Matrix) -> None:
    made = json.loads(to_json(matrix))["provenance"]
    assert "GNU Fortran" in made["compiler"]
    assert made["generator_version"] and made["plyflow_version"]
    assert any("gamma_lock" in line for line in made["assumptions"])
    assert set(made["materials"]) == {"IM7-8552", "IMA-M21"}
    assert all(len(digest) == 64 for digest in made["sources_sha256"].values())
    page = to_html(matrix)
    assert made["compiler"] in page and "gamma_lock" in page


def test_two_runs_give_the_same_numbers() -> None:
    cells = []
    for _ in range(2):
        subject = Subject(quick=True)
        cells.append([cell.as_dict() for cell in run_matrix(subject, all_tasks(subject, TWO)).cells])
    assert cells[0] == cells[1]


@pytest.mark.usefixtures("short")
def test_command_writes_the_tables_and_the_json(application: typer.Typer, tmp_path: Path) -> None:
    further = tmp_path / "further" / "cells.json"
    arguments = ["stability", "--quick", "-o", str(tmp_path / "out"), "--json", str(further)]
    result = CliRunner().invoke(application, arguments, catch_exceptions=False)
    assert result.exit_code == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"stability.html", "stability.json"}
    written = json.loads((tmp_path / "out" / "stability.json").read_text(encoding="utf-8"))
    assert json.loads(further.read_text(encoding="utf-8")) == written
    assert "claim" in result.output and "cells in" in result.output


@pytest.mark.usefixtures("short")
def test_run_that_fails_says_so_after_its_report_is_written(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    edit = ERRORS["a stress that is not turned"]
    monkeypatch.setattr(run, "Subject", lambda quick: Subject(quick, edit=edit))
    with pytest.raises(RunError, match=r"of \d+ cells fail, see"):
        run.run_stability(tmp_path, Console(quiet=True), quick=True)
    assert "Cells that fail" in (tmp_path / "stability.html").read_text(encoding="utf-8")


def test_folder_that_cannot_be_written_is_told_before_the_run(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot write"):
        run.run_stability(tmp_path / "file" / "folder", Console(quiet=True), quick=True)


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, ""), (0.0, "0"), (14.0, "14"), (0.0123, "0.0123"), (1.25e-13, "1.2e-13"), (3.7e9, "3.7e9"), (-2.5, "-2.5")],
)
def test_numbers_are_short(value: float | None, text: str) -> None:
    assert number(value) == text


def test_a_reader_sees_the_whole_report(matrix: Matrix, browser: Chrome, tmp_path: Path) -> None:
    assert faults_of_report(browser, to_html(matrix), tmp_path) == []
