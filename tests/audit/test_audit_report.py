"""The report: JSON entries, a page without network, the command, the same text on every run."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from html import unescape
from pathlib import Path

import pytest
import typer
from rich.console import Console
from selenium.webdriver import Chrome

from browsing import faults_of_report
from plyflow.audit.report import Audit
from plyflow.audit.shown import page, show
from plyflow.cli import main
from plyflow.cli.check import audit as command
from plyflow.errors import RunError
from umataudit import Verdict, audit_relations
from umataudit.printed import PAPER, Book


def test_every_relation_has_an_entry_with_all_fields(audited: Audit) -> None:
    entries = json.loads(json.dumps(audited.entries()))
    assert [entry["id"] for entry in entries] == list(PAPER)
    verdicts = {verdict.value for verdict in Verdict}
    for entry in entries:
        assert entry["verdict"] in verdicts
        assert entry["printed"]
        assert entry["consequence"]
        assert entry["derived"] or entry["verdict"] == Verdict.CANNOT.value, entry["id"]
        assert entry["derived"] or entry["reason"], entry["id"]
        assert entry["chain"]
        assert {"scene", "compiler", "plyflow", "source sha256", "assumptions", "reference"} <= set(entry["made_with"])
        assert "gamma_lock" in entry["made_with"]["assumptions"]
    assert sum(audited.counts.values()) == len(entries)


def test_derivation_steps_and_witness_are_shown(audited: Audit) -> None:
    for row in audited.rows:
        if row.verdict is not Verdict.CANNOT:
            assert row.steps, row.id
            assert row.checks, row.id
            assert row.witness or row.id == "17-push", row.id
    thirteen = next(row for row in audited.rows if row.id == "13")
    values = [line.split()[1] for line in thirteen.witness if line.startswith(("printed", "derived"))]
    assert len(values) == 2
    assert all(len(value.replace("0.", "").lstrip("0")) >= 28 for value in values)


def test_the_page_is_self_contained_and_its_mathematics_well_formed(audited: Audit) -> None:
    text = page(audited).html()
    assert not re.search(r"(src|href)\s*=\s*[\"'](?!#)", text)
    assert "http" not in re.sub(r"http://www\.w3\.org\S*", "", text)
    assert "viewport" in text
    assert "@media print" in text
    found = re.findall(r"<math.*?</math>", text, flags=re.DOTALL)
    assert len(found) > 300
    for markup in found:
        ET.fromstring(markup)


CODE = re.compile(r"(?<![-\w])[a-z]+_\w+|\*\*|\^|\bsqrt\b|\bexp\(|\b(?:eps|psi|Cdot|lambda)\b|[<>]=|\$")
_TAGS = ("math", "code", "svg", "style", "dl", "a", "h3", "th")
_ELSEWHERE = re.compile("|".join(rf"<{tag}[ >].*?</{tag}>" for tag in _TAGS), re.DOTALL)


def ascii_formulas(html: str) -> list[str]:
    """What looks like a formula or a letter in code outside of mathematics, code, names of entries and the table of blocks."""
    text = _ELSEWHERE.sub("", html[html.index("<body>") :])
    text = re.sub(r">Machine code</h2>.*?</table>", "", text, flags=re.DOTALL)
    return CODE.findall(unescape(re.sub(r"<[^>]+>", " ", text)))


def test_no_formula_of_the_page_is_left_in_ascii(audited: Audit) -> None:
    assert ascii_formulas(page(audited).html()) == []
    unset = [replace(audited.rows[0], says="the potential psi_v of exp(eps)"), *audited.rows[1:]]
    assert set(ascii_formulas(page(replace(audited, rows=unset)).html())) == {"psi_v", "exp(", "eps"}


def test_terminal_and_json_have_no_marks(audited: Audit) -> None:
    console = Console(record=True, width=120, file=open(os.devnull, "w"))  # noqa: SIM115
    show(audited, console)
    assert "$" not in console.export_text()
    assert "$" not in json.dumps(audited.entries())
    assert any("$" in row.says for row in audited.rows)


def test_the_cell_of_eq_a1_is_drawn_with_its_table(audited: Audit) -> None:
    shown = page(audited).html()
    entry = shown[shown.index(">A.1</h3>") :]
    entry = entry[: entry.index("</article>")]
    assert "<svg" in entry
    assert entry.count("none, of") == 14


def test_misprints_are_counted_by_what_is_misprinted_and_notes_are_shown(audited: Audit) -> None:
    found = [row for row in audited.rows if row.verdict is Verdict.MISPRINT]
    numbers = [int(part.split()[0]) for part in audited.misprints.split(", ")]
    assert sum(numbers) == len(found)
    shown = page(audited).html()
    for text in (audited.misprints, "misprint (formula)", "misprint (reference)", "if the page has a <math>"):
        assert text in shown
    fewer = replace(audited, rows=[row for row in audited.rows if row.sort != "reference"])
    assert "in cross-references" in audited.misprints
    assert "in cross-references" not in fewer.misprints


def test_the_counts_of_the_readme_are_those_of_the_audit(audited: Audit) -> None:
    readme = Path(__file__).resolve().parents[2] / "README.md"
    assert audited.summary in " ".join(readme.read_text(encoding="utf-8").split())
    assert audited.summary in unescape(page(audited).html())


def test_the_page_has_an_entry_for_each_relation(audited: Audit) -> None:
    assert page(audited).html().count("<article id=") == len(PAPER)


def test_a_disagreement_is_shown_everywhere(audited: Audit) -> None:
    wrong = replace(audited, blocks=[replace(audited.blocks[0], difference=1e-3), *audited.blocks[1:]])
    assert not wrong.agrees
    assert "DIFFERS" in page(wrong).html()
    assert "DIFFERS" not in page(audited).html()
    console = Console(record=True, width=120, file=open(os.devnull, "w"))  # noqa: SIM115
    show(wrong, console)
    assert "DIFFERS" in console.export_text()


@pytest.fixture
def application(audited: Audit, monkeypatch: pytest.MonkeyPatch) -> typer.Typer:
    """The command with the audit of this session."""
    monkeypatch.setattr("plyflow.audit.report.run_audit", lambda scene, seen: audited)
    app = typer.Typer()
    app.callback()(lambda: None)
    app.command("audit")(command)
    return app


def test_the_command_writes_json_and_page(
    application: typer.Typer, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names = {"--json": "a.json", "--html": "a.html"}
    arguments = [text for option, name in names.items() for text in (option, str(tmp_path / name))]
    application(["audit", *arguments], standalone_mode=False)
    assert [entry["id"] for entry in json.loads((tmp_path / "a.json").read_text())] == list(PAPER)
    assert (tmp_path / "a.html").read_text().startswith("<!DOCTYPE html>")
    assert str(tmp_path / "a.json") in capsys.readouterr().out


def test_json_on_standard_output_is_nothing_but_json(
    application: typer.Typer, capsys: pytest.CaptureFixture[str]
) -> None:
    application(["audit", "--json", "-"], standalone_mode=False)
    assert len(json.loads(capsys.readouterr().out)) == len(PAPER)


def test_the_command_fails_when_machine_code_differs(
    application: typer.Typer, audited: Audit, monkeypatch: pytest.MonkeyPatch
) -> None:
    wrong = replace(audited, blocks=[replace(audited.blocks[0], difference=1e-3)])
    monkeypatch.setattr("plyflow.audit.report.run_audit", lambda scene, seen: wrong)
    with pytest.raises(RunError, match="does not agree"):
        application(["audit", "--json", "-"], standalone_mode=False)


BAD_INPUT = {
    "nosuch": ["--scene", "nosuch"],
    "is a folder; give --html": ["--html", "folder"],
    "give --html a file in a folder": ["--html", "file/a.html"],
    "--json and --html name the same file": ["--html", "folder/../a.json"],
}
"""Part of what is said, and the arguments beside a good --json."""


@pytest.mark.parametrize("said", BAD_INPUT)
def test_bad_input_is_one_line_and_nothing_is_written(
    said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    assert main(["audit", "--json", "a.json", *BAD_INPUT[said]]) == 2
    output = capsys.readouterr()
    assert output.out == ""
    assert said in output.err
    assert output.err.strip().count("\n") == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder"]


def test_every_part_is_reported_once_it_is_done() -> None:
    book = Book([PAPER["12-rate"], PAPER["4-strain"]])
    seen: list[str] = []
    audit_relations([], book, seen.append)
    assert seen == ["12-rate", "4-strain"]


SCRIPT = """
from umataudit import judge
from umataudit.render import value_text
from umataudit.printed import PAPER
for key in ("5a", "12-J2", "T1.1", "A.1"):
    finding = judge(PAPER[key], PAPER)
    print(key, finding.verdict, value_text(finding.first.derivation.result), finding.faults, finding.reason)
    for judged in finding.judged:
        print([(c.label, c.identity and (str(c.identity.difference), c.identity.witnesses)) for c in judged.checks])
"""


def test_the_audit_is_the_same_whatever_the_hash_seed() -> None:
    said = []
    for seed in ("1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)}
        run = subprocess.run(
            [sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=True
        )
        said.append(run.stdout)
    assert said[0] == said[1]
    assert "Verdict.MISPRINT" in said[0]


def test_a_reader_sees_the_whole_report(audited: Audit, browser: Chrome, tmp_path: Path) -> None:
    assert faults_of_report(browser, page(audited).html(), tmp_path) == []
