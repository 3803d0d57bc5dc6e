"""`plyflow doctor` finds what is there, and says of what is not how to get it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from plyflow.cli import main
from plyflow.diagnose.compilers import find_flang
from plyflow.hosts.calculix.build import MARK


def findings(capsys: pytest.CaptureFixture[str]) -> dict[str, dict[str, object]]:
    return {str(entry["name"]): entry for entry in json.loads(capsys.readouterr().out)}


def test_the_compiler_and_the_driver_are_found(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor", "--json"]) == 0
    found = findings(capsys)
    assert "Fortran" in str(found["gfortran"]["found"])
    assert found["driver"]["found"]
    assert all(entry["gives"] and entry["remedy"] for entry in found.values())


def test_without_a_compiler_it_says_what_is_lost_and_returns_1(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("FC", raising=False)
    assert main(["doctor", "--json"]) == 1
    gfortran = findings(capsys)["gfortran"]
    assert gfortran["found"] is None
    assert "apt-get install gfortran" in str(gfortran["remedy"])


def test_calculix_is_found_by_its_external_materials_only(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    ccx = tmp_path / "ccx"
    monkeypatch.setenv("PLYFLOW_CCX", str(ccx))
    for content, expected in ((b"without", None), (b"with " + MARK, str(ccx))):
        ccx.write_bytes(content)
        main(["doctor", "--json"])
        assert findings(capsys)["CalculiX"]["found"] == expected


def test_flang_is_found_by_any_of_its_names_the_newest_first(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert find_flang() is None
    for name in ("flang-16", "flang-new-18", "flang-new-19", "flang-to-external-fc", "flang-20x"):
        (tmp_path / name).write_text("#!/bin/sh\n")
        (tmp_path / name).chmod(0o755)
    assert find_flang() == tmp_path / "flang-new-19"
    (tmp_path / "flang-new-19").chmod(0o644)
    assert find_flang() == tmp_path / "flang-new-18"


def test_the_table_says_what_each_missing_tool_would_give_and_how_to_get_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    for name in ("PLYFLOW_CACHE", "XDG_CACHE_HOME", "PATH"):
        monkeypatch.setenv(name, str(tmp_path))
    monkeypatch.delenv("FC", raising=False)
    monkeypatch.delenv("PLYFLOW_CCX", raising=False)
    monkeypatch.setenv("COLUMNS", "300")
    monkeypatch.setattr("plyflow.hosts.mgis.opengeosys.find_spec", lambda name: None)
    assert main(["doctor"]) == 1
    said = capsys.readouterr().out
    for word in ("gfortran", "flang-19", "plyflow calculix build", "a licensed installation", "finite-element runs"):
        assert word in said
    assert "apt-get install valgrind" in said
    assert said.count("missing: ") == 7
    assert "pip install 'plyflow[hosts]'" in said
    assert "nothing runs without: gfortran" in said


def planted_tools(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).write_text("#!/bin/sh\necho a tool for the test\n")
        (folder / name).chmod(0o755)


def test_valgrind_is_looked_for(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    main(["doctor", "--json"])
    assert findings(capsys)["valgrind"]["found"] is None
    planted_tools(tmp_path, "valgrind")
    main(["doctor", "--json"])
    found = findings(capsys)["valgrind"]
    assert str(found["found"]).startswith(str(tmp_path / "valgrind"))
    assert "scenes --measure" in str(found["gives"])


@pytest.mark.parametrize("columns", ["40", "80"])
def test_a_long_path_is_printed_in_one_piece(
    columns: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    folder = tmp_path / "a long folder name with blanks" / "and-another-that-is-longer-than-a-narrow-terminal-is-wide"
    folder.mkdir(parents=True)
    planted_tools(folder, "valgrind")
    monkeypatch.setenv("PATH", str(folder))
    monkeypatch.setenv("COLUMNS", columns)
    main(["doctor"])
    assert f"{folder}/valgrind: a tool for the test\n" in capsys.readouterr().out


def test_without_abaqus_it_is_said_that_plyflow_itself_lacks_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    assert "needed by plyflow itself: all here" in said
    assert "everything" not in said
