"""`plyflow identify`: JSON, files, a material that the other commands take, several temperatures, errors."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import pandas as pd
import pytest

from identify.making import RAMP_DWELL, Test, synthetic, truth
from plyflow.case.materials import find_material
from plyflow.cli import main
from plyflow.errors import InputError
from plyflow.identify import valley
from plyflow.identify.model import NAMES


@pytest.fixture(autouse=True)
def few_points(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(valley, "POINTS", 5)


def write(folder: Path, name: str, temperature: float, test: Test = RAMP_DWELL[0]) -> str:
    path = folder / f"{name}.csv"
    path.write_text(synthetic("IM7-8552", temperature, test).text())
    return str(path)


def test_json_gives_every_parameter_with_its_interval(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["identify", write(tmp_path, "cp", 70.0), write(tmp_path, "bp", 70.0, RAMP_DWELL[1]), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    for name in NAMES:
        assert found[name]["value"] == pytest.approx(truth("IM7-8552", 70.0)[name], abs=1e-4)
        low, high = found[name]["interval"]
        assert low <= found[name]["value"] <= high
    assert found["temperature"] == 70.0
    assert [one["name"] for one in found["specimens"]] == ["cp", "bp"]
    assert found["notes"][0].startswith("cp: width grew to 1.0397, Eq. 6 lets it grow to 1.0397")


def test_the_material_file_is_taken_like_the_paper_s_tables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    files = [write(tmp_path, f"cp{t:g}", t) for t in (60.0, 70.0, 90.0)]
    assert main(["identify", *files, "-o", str(tmp_path / "out")]) == 0
    path = tmp_path / "out" / "material.toml"
    material = find_material(str(path))
    assert material.name == "IM7-8552, fitted"
    assert material.table.temperature == (60.0, 70.0, 90.0)
    assert material.at(70.0).k == pytest.approx(0.813, abs=1e-6)
    capsys.readouterr()
    case = ("--temperature", "70", "--layup", "BP", "--json")
    assert main(["run", "--material", str(path), *case]) == 0
    own = json.loads(capsys.readouterr().out)
    assert main(["run", "--material", "IM7-8552", *case]) == 0
    paper = json.loads(capsys.readouterr().out)
    assert own["thickness_ratio_final"] == pytest.approx(paper["thickness_ratio_final"], abs=1e-5)
    path.write_text(path.read_text().replace("k = [", "k = [0.84, 0.82, 0.81] # [").replace("# k", "#"))
    assert main(["run", "--material", str(path), *case]) == 0  # a file with another k is noticed
    other = json.loads(capsys.readouterr().out)
    assert abs(other["thickness_ratio_final"] - paper["thickness_ratio_final"]) > 1e-3
    assert main(["law1d", "--material", str(path), "--temperature", "80", "--layup", "CP"]) == 0
    scene = tmp_path / "warm.toml"
    scene.write_text(f'table = "{path}"\n')
    assert main(["generate", str(scene), "-o", str(tmp_path)]) == 0
    assert json.loads((tmp_path / "warm.json").read_text())["scene"]["table"]
    assert {one.name for one in (tmp_path / "out" / "70degC").iterdir()} >= {"fit.json", "correlation.svg", "lines.svg"}


def test_pictures_and_tables_hold_the_fit_under_any_name(tmp_path: Path) -> None:
    strange, out = 'Härter "B"\\1\tnew\nline', tmp_path / "out"
    assert main(["identify", write(tmp_path, "cp", 70.0), "--name", strange, "-o", str(out)]) == 0
    assert find_material(str(out / "material.toml")).name == strange
    curves = pd.read_csv(out / "curves.csv")
    assert len(curves) == 1201
    assert (curves["fitted_mm"] - curves["thickness_mm"]).abs().max() < 1e-6
    assert set(pd.read_csv(out / "correlation.csv")["first"]) == {"k", "a"}
    for name in ("curves", "lines", "correlation"):
        assert (out / f"{name}.svg").read_text().startswith("<?xml")


def test_specimens_fitted_apart_get_folders_of_their_own_and_one_file_counts_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "new").mkdir()
    files = [write(tmp_path, "cp", 70.0), write(tmp_path / "new", "cp", 60.0), write(tmp_path, "bp", 70.0, RAMP_DWELL[1])]
    out = tmp_path / "out"
    assert main(["identify", *files, "--apart", "-o", str(out)]) == 0
    for folder, temperature in (("cp", 70.0), ("cp-2", 60.0), ("bp", 70.0)):
        assert find_material(str(out / folder / "material.toml")).table.temperature == (temperature,)
    assert not (out / "material.toml").exists()
    capsys.readouterr()
    assert main(["identify", *files[::2], "--apart", "--json"]) == 0
    assert [one["specimens"][0]["name"] for one in json.loads(capsys.readouterr().out)] == ["cp", "bp"]
    assert main(["identify", files[0], str(tmp_path / "new" / ".." / "cp.csv")]) == 2
    assert "cp.csv is given twice" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "fragment"),
    [
        (("--tie", "maybe"), "unknown --tie 'maybe'"),
        (("--intervals", "wide"), "unknown --intervals 'wide'"),
        (("--layup", "QI"), "layup 'QI' is not known"),
        (("--width", "-1"), "width = -1 must be a finite number above 0"),
        (("--set", "gamma_lock=90"), "gamma_lock = 90 deg"),
        (("--set", "l0_over_d=-1"), "l0_over_d = -1 must be above 0"),
        (("--set", "chi_ratio=0"), "chi_ratio = 0 must be above 0"),
        (("--set", "gamma_lock=0.5"), "gamma_lock = 0.5 deg must be from 3 to below 90: give it in degrees"),
        (("--set", "kappa=1"), "--set kappa: identify knows the assumptions gamma_lock, l0_over_d"),
        (("none.csv",), "none.csv cannot be read"),
    ],
)
def test_every_error_is_one_line_and_status_2(
    options: Sequence[str], fragment: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["identify", write(tmp_path, "cp", 70.0), *options, "-o", str(tmp_path / "out")]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert fragment in error
    assert not (tmp_path / "out").exists()


def test_the_help_says_what_a_file_looks_like_with_all_its_units(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    for command in ("identify", "law1d"):
        assert main([command, "--help"]) == 0
        text = " ".join(capsys.readouterr().out.split())
        assert " ." not in text and " ;" not in text  # a unit swallowed as markup would leave a gap
        assert "degC" in text
    assert main(["identify", "--help"]) == 0
    assert '"time (s);force (N);thickness (mm)"' in " ".join(capsys.readouterr().out.split())


def test_extrapolation_is_refused_unless_the_file_asks_for_it(tmp_path: Path) -> None:
    paper = (Path(__file__).parents[2] / "python/plyflow/data/materials/im7-8552.toml").read_text()
    bold, shy = tmp_path / "bold.toml", tmp_path / "shy.toml"
    bold.write_text(f'extrapolation = "linear"\n{paper}')
    shy.write_text(paper)
    with pytest.raises(InputError, match="95 degC is outside 30 to 90 degC"):
        find_material(str(shy)).at(95.0)
    assert find_material(str(bold)).at(95.0) == find_material(str(shy)).at(95.0, extrapolate=True)
