"""`plyflow law1d`: tables, JSON, synthetic tests, errors."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from plyflow.case.case import Case
from plyflow.case.measured_file import read_measured
from plyflow.case.programme import load_programme
from plyflow.cli import main
from plyflow.identify.specimen import read_specimen
from plyflow.law import integrate

LAW = ("law1d", "--material", "IM7-8552", "--temperature", "70", "--layup", "CP")


def run_json(arguments: Sequence[str], capsys: pytest.CaptureFixture[str]) -> list[dict[str, float]]:
    assert main([*arguments, "--json"]) == 0
    return list(json.loads(capsys.readouterr().out))


def test_every_combination_is_run_and_agrees_with_the_stepwise_integrator(capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--temperature", "50", "--layup", "bp", "--width", "15", "--width", "30")
    done = run_json((*LAW, *options), capsys)
    assert [(one["temperature"], one["layup"], one["width"]) for one in done] == [
        (t, layup, w) for t in (70.0, 50.0) for layup in ("CP", "BP") for w in (15.0, 30.0)
    ]
    for one in done:
        case = Case("IM7-8552", one["temperature"], str(one["layup"]), one["width"])
        reference = integrate(case.law(), load_programme("ramp-dwell", case.width), [1200.0])
        assert one["thickness_ratio_final"] == pytest.approx(float(reference.thickness_ratio[0]), rel=1e-10)
        assert one["width_ratio_final"] == pytest.approx(float(reference.width_ratio[0]), rel=1e-10)


def check_history(table: pd.DataFrame) -> None:
    volume = table["thickness_ratio"] * table["width_ratio"] * table["fibre_fraction"]
    np.testing.assert_allclose(volume, 0.5, rtol=1e-12)
    np.testing.assert_allclose(table["thickness_mm"], 2.0 * table["thickness_ratio"], rtol=1e-12)
    np.testing.assert_allclose(table["width_mm"], table["width_ratio"] * 30.0, rtol=1e-12)
    changes = np.flatnonzero(table["stage"].to_numpy()[1:] != table["stage"].to_numpy()[:-1])
    assert len(changes) == 1
    assert table["stage"].iloc[0] == "squeeze"
    assert table["stage"].iloc[-1] == "bleed"


def test_the_history_keeps_the_fibres_and_changes_its_stage_once(tmp_path: Path) -> None:
    assert main([*LAW, "--width", "30", "--every", "2", "-o", str(tmp_path)]) == 0
    table = pd.read_csv(tmp_path / "history.csv")
    assert table["time_s"].tolist() == np.arange(0.0, 1201.0, 2.0).tolist()
    check_history(table)
    with pytest.raises(AssertionError):  # a fibre fraction that ignores the widening is noticed
        check_history(table.assign(fibre_fraction=0.5 / table["thickness_ratio"]))
    assert (tmp_path / "thickness.svg").read_text().startswith("<?xml")
    assert json.loads((tmp_path / "summary.json").read_text())[0]["layup"] == "CP"


def test_geometry_and_constants_can_be_set(capsys: pytest.CaptureFixture[str]) -> None:
    (four,) = run_json((*LAW, "--block-thickness", "0.5"), capsys)
    (blocked,) = run_json([*LAW[:-1], "BP"], capsys)
    assert four["thickness_ratio_final"] == pytest.approx(blocked["thickness_ratio_final"], rel=1e-14)
    (other,) = run_json((*LAW, "--set", "k=0.82"), capsys)
    assert other["thickness_ratio_final"] > four["thickness_ratio_final"]


def test_a_synthetic_test_is_read_back_and_its_noise_is_what_was_asked_for(tmp_path: Path) -> None:
    clean, noisy = tmp_path / "clean.csv", tmp_path / "noisy.csv"
    noise = ("--thickness-noise", "0.005", "--force-noise", "0.1", "--seed", "3")
    assert main([*LAW, "--as-test", str(clean)]) == main([*LAW, "--as-test", str(noisy), *noise]) == 0
    assert "not a measurement" in clean.read_text().splitlines()[0]
    first, second = (read_measured(path, ["time", "force", "thickness"], ["width"]) for path in (clean, noisy))
    assert len(first.columns["time"]) == 1201
    assert first.columns["force"][1] == 20.0
    for name, deviation in (("thickness", 0.005), ("force", 0.1)):
        assert np.std(second.columns[name] - first.columns[name]) == pytest.approx(deviation, rel=0.1)
    assert main([*LAW, "--load", str(clean)]) == 0


def test_the_table_fits_80_columns(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert main([*LAW, "--width", "30"]) == 0
    out = capsys.readouterr().out
    assert all(len(line) <= 80 and "…" not in line for line in out.splitlines())
    assert "IM7-8552 70 CP 30" in out


@pytest.mark.parametrize(("heading", "said"), [("pressure", True), ("pressure [MPa]", False)])
def test_a_unit_that_a_load_file_does_not_give_is_an_assumption(
    heading: str, said: bool, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.chdir(tmp_path)
    Path("press.csv").write_text(f"time [s],{heading}\n0,0\n1,0.1\n600,0.1\n")
    line = "pressure without a unit in press.csv read as MPa"
    for command in (LAW, ("run", *LAW[1:])):
        assert main([*command, "--load", "press.csv"]) == 0
        assert (line in capsys.readouterr().out) is said
        assert main([*command, "--load", "press.csv", "--json"]) == 0
        found = json.loads(capsys.readouterr().out)
        assert (line in (found[0] if isinstance(found, list) else found)["assumptions"]) is said


def test_run_and_law1d_end_at_one_thickness_under_a_load_file(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "press.csv"
    path.write_text("time [s],pressure [bar]\n0,0\n1,1\n300,1\n301,2\n600,2\n")
    (law,) = run_json((*LAW, "--load", str(path)), capsys)
    (other,) = run_json(LAW, capsys)
    assert main(["run", *LAW[1:], "--load", str(path), "--json"]) == 0
    driven = json.loads(capsys.readouterr().out)
    assert driven["thickness_ratio_1d"] == pytest.approx(law["thickness_ratio_final"], rel=1e-8)
    assert driven["thickness_ratio_final"] == pytest.approx(law["thickness_ratio_final"], abs=1e-3)
    assert abs(driven["thickness_ratio_final"] - other["thickness_ratio_final"]) > 1e-3  # another load is noticed


def test_the_text_explains_its_headings_and_says_when_the_laws_meet(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    assert main([*LAW[:-1], "4", "--match-time", "360"]) == 0
    out = capsys.readouterr().out
    for words in ("IM7-8552 70 4 plies 15", "the model's thickness at 360 s", "limit: h/h0", "bleeds at: time", "4 blocks"):
        assert words in out
    assert main(["run", *LAW[1:-1], "4", "--refine", "8"]) == 0
    out = capsys.readouterr().out
    assert "70 degC 4 plies 15 mm" in out
    row = next(line for line in out.splitlines() if "lock time, s" in line)
    umat, law = (float(cell) for cell in row.split()[3:5])
    assert umat == pytest.approx(law, rel=0.05)


def test_a_synthetic_test_says_its_plies_and_their_thickness(tmp_path: Path) -> None:
    path = tmp_path / "test.csv"
    assert main([*LAW[:-1], "SB", "--plies", "24", "--block-thickness", "0.3", "--as-test", str(path)]) == 0
    specimen = read_specimen(path, {}, {})
    assert (specimen.geometry.plies, specimen.geometry.h0) == pytest.approx((24.0, 0.3))
    assert specimen.thickness[0] == pytest.approx(specimen.geometry.stack)
