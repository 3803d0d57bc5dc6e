"""Material files and layups in cases: own numbers under any name, extrapolation on request, blocks of any size."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from plyflow.case import case as cases
from plyflow.case.case import LAW_MANIFEST, Case
from plyflow.case.materials import Material, find_material, known_materials
from plyflow.cli import main
from plyflow.errors import InputError

OWN = """
name = "IM7-8552"
source = "a test"
ply_thickness = 0.2
[table]
temperature = [60.0, 70.0]
k = [0.85, 0.82]
a = [-0.88, -0.86]
b_squeeze = [-15.2, -14.9]
b_bleed = [-31.9, -31.6]
"""


def own_file(folder: Path) -> str:
    path = folder / "own.toml"
    path.write_text(OWN)
    return str(path)


def check_own_numbers(path: str) -> None:
    values = cases.property_values(Case(path, 70.0, "CP", 15.0), LAW_MANIFEST)
    assert (values["k"], values["h0"]) == (0.82, 0.2)


def test_a_file_keeps_its_numbers_even_under_the_name_of_a_known_material(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = own_file(tmp_path)
    check_own_numbers(path)
    assert Case("im7-8552", 70.0, "CP", 15.0).material == "IM7-8552"

    def by_name(name: str) -> Material:
        return known_materials()[find_material(name).name]

    monkeypatch.setattr(cases, "find_material", by_name)  # the paper's table in place of the file is noticed
    with pytest.raises(AssertionError):
        check_own_numbers(path)


def test_a_case_outside_the_table_runs_on_request_only_and_says_so(tmp_path: Path) -> None:
    path = own_file(tmp_path)
    with pytest.raises(InputError, match=r"temperature 75 degC is outside 60 to 70 degC, .* --extrapolate"):
        Case(path, 75.0, "CP", 15.0)
    case = Case(path, 75.0, "CP", 15.0, extrapolate=True)
    values = cases.property_values(case, LAW_MANIFEST)
    assert values["a"] == pytest.approx(-0.85, rel=1e-14)  # two columns make a straight line
    assert Case(path, 75.0, "CP", 15.0, extrapolate=True).law().a == values["a"]
    assert any("extrapolated as asked" in line for line in cases.assumption_lines(case, values))


def test_run_and_law1d_extrapolate_on_request(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = ("--material", own_file(tmp_path), "--temperature", "75", "--layup", "CP", "--json")
    for command in ("run", "law1d"):
        assert main([command, *case]) == 2
        assert capsys.readouterr().err.count("\n") == 1
        assert main([command, *case, "--extrapolate"]) == 0
        found = json.loads(capsys.readouterr().out)
        lines = found["assumptions"] if isinstance(found, dict) else found[0]["assumptions"]
        assert any("extrapolated as asked" in line for line in lines)


def test_a_layup_may_be_the_number_of_equal_plies_in_a_block() -> None:
    assert Case("IM7-8552", 70.0, "4", 15.0).block_thickness == Case("IM7-8552", 70.0, "BP", 15.0).block_thickness
    assert Case("IM7-8552", 70.0, "3", 15.0).block_thickness == pytest.approx(0.375)
    law = Case("IM7-8552", 70.0, "3", 50.0, plies=24)
    assert law.blocks * law.block_thickness == pytest.approx(3.0)
    for layup in ("0", "-1", "1.5", "\N{SUPERSCRIPT TWO}", ""):
        with pytest.raises(InputError, match="choose one of CP, SB, BP, or give the number of equal plies in a block"):
            Case("IM7-8552", 70.0, layup, 15.0)
    with pytest.raises(InputError, match="plies = 0 must be at least 1"):
        Case("IM7-8552", 70.0, "CP", 15.0, plies=0)
