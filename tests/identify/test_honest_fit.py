"""What helps where readings alone do not do: an offset, a temperature column, faulty rows left out, the next test to make."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from identify.making import read_back, synthetic, truth
from plyflow.case.case import Case
from plyflow.cli import main
from plyflow.identify.judged import judge, offset_hint
from plyflow.identify.model import NAMES
from plyflow.identify.refine import Fit, fit
from plyflow.identify.specimen import Reading, read_specimen
from plyflow.identify.suggest import Suggestion, suggestions
from plyflow.run.synthetic import SyntheticTest, synthetic_test

NOISE = (0.005, 0.1)
OFFSET = 0.05  # mm


def noisy(layup: str, load: str, seed: int) -> SyntheticTest:
    return synthetic("IM7-8552", 70.0, (layup, 15.0, load)).with_noise(*NOISE, seed)


def holds(found: Fit, column: dict[str, float]) -> bool:
    return all(found.estimates[name].low <= column[name] <= found.estimates[name].high for name in NAMES)


def test_an_offset_is_hinted_at_and_then_fitted(tmp_path: Path) -> None:
    tests = [noisy("CP", "ramp-dwell", 1), noisy("BP", "ramp-dwell", 2)]
    off = [replace(one, thickness=one.thickness + OFFSET) for one in tests]
    specimens = read_back(off, tmp_path)
    plain = fit(specimens)
    assert not holds(plain, truth("IM7-8552", 70.0))
    assert any("--offset" in words for words in judge(plain).misfit)
    assert "try --offset" in offset_hint(plain, specimens, "auto")
    found = fit(specimens, offset=True)
    assert holds(found, truth("IM7-8552", 70.0))
    assert judge(found).sound
    assert all(one.low <= OFFSET <= one.high for one in found.offsets)
    right = fit(read_back(tests, tmp_path), offset=True)
    assert all(one.low <= 0.0 <= one.high for one in right.offsets)


def test_an_offset_costs_accuracy(tmp_path: Path) -> None:
    specimens = read_back([noisy("CP", "ramp-dwell", 1)], tmp_path)
    plain, found = fit(specimens, "always"), fit(specimens, "always", offset=True)
    for name in ("k", "a", "b_bleed"):
        assert found.estimates[name].error > plain.estimates[name].error


def test_faulty_rows_are_left_out_and_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "cp.csv"
    lines = noisy("CP", "ramp-dwell", 1).text().splitlines()
    for row in (100, 200, 300):
        lines[row] = lines[row].split(",")[0] + ",,,"
    path.write_text("\n".join(lines) + "\n")
    assert main(["identify", str(path), "--skip-bad-rows", "--json"]) == 0
    notes = json.loads(capsys.readouterr().out)["notes"]
    assert any("3 of 1201 rows skipped as asked: line 101: no value of force" in note for note in notes)
    assert main(["identify", str(path), "--json"]) == 2
    error = capsys.readouterr().err
    assert all(f"line {line}:" in error for line in (101, 201, 301))


def test_a_steady_column_of_temperature_gives_the_temperature(tmp_path: Path) -> None:
    text = noisy("CP", "ramp-dwell", 1).text().replace("# temperature: 70 degC\n", "")
    lines = text.splitlines()
    first = next(row for row, line in enumerate(lines) if line.startswith("time"))
    body = (f"{line},{343.15 + 0.4 * (row % 2)}" for row, line in enumerate(lines[first + 1 :]))
    lines = [*lines[:first], lines[first] + ",T [K]", *body]
    path = tmp_path / "cp.csv"
    path.write_text("\n".join(lines) + "\n")
    specimen = read_specimen(path, {}, {})
    assert specimen.geometry.temperature == pytest.approx(70.2, abs=0.01)
    assert specimen.like is None and not specimen.load.temperatures
    assert any("taken as 70.2 degC" in note for note in specimen.notes)


def test_parameters_at_one_temperature_come_from_a_heated_test(tmp_path: Path) -> None:
    """10 K of heating in 20 minutes; taken at the temperature of its mean it would be off by more than its intervals."""
    cycle = tmp_path / "cycle.csv"
    cycle.write_text("time [min],temperature [degC],force [N]\n0,65,0\n1,65,20\n10,70,20\n11,70,40\n15,75,60\n20,75,60\n")
    test = synthetic_test(Case("IM7-8552", math.nan, "CP", 15.0, str(cycle)), 5.0).with_noise(*NOISE, 4)
    path = tmp_path / "heated.csv"
    path.write_text(test.text())
    specimen = read_specimen(path, {"temperature": 70.0}, {}, Reading(like="IM7-8552"))
    column = truth("IM7-8552", 70.0)
    found = fit([specimen], "always")
    assert holds(found, column)
    flat = replace(specimen, like=None, load=replace(specimen.load, temperatures=()))
    assert not holds(fit([flat], "always"), column)


def ratio_of_widths(suggested: Suggestion, found: Fit) -> dict[str, float]:
    """Half widths found over those predicted."""
    ends = {name: found.estimates[name] for name in suggested.then}
    return {name: 0.5 * (ends[name].high - ends[name].low) / width for name, width in suggested.then.items()}


def test_the_interval_predicted_for_the_next_test_is_the_one_it_gives(tmp_path: Path) -> None:
    """The three best tests of the paper's length, made by simulation and fitted together with the first; 10 % for their noise."""
    first = noisy("CP", "ramp-dwell", 3)
    found = suggestions([fit(read_back([first], tmp_path))])
    assert [one.ratio for one in found] == sorted(one.ratio for one in found)
    for seed, one in enumerate([one for one in found if one.length == 1200.0][:3]):
        test = synthetic("IM7-8552", 70.0, (one.layup, one.width, one.load)).with_noise(*NOISE, 20 + seed)
        joint = fit(read_back([first, test], tmp_path))
        for name, ratio in ratio_of_widths(one, joint).items():
            assert ratio == pytest.approx(1.0, abs=0.1), (one, name)
        doubled = replace(one, then={name: 2.0 * width for name, width in one.then.items()})
        assert max(ratio_of_widths(doubled, joint).values()) < 0.9  # a prediction off by two is noticed


def test_the_next_test_is_told_even_where_the_first_leaves_all_open(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "minute.csv"
    path.write_text("\n".join(noisy("CP", "ramp-dwell", 1).text().splitlines()[:69]) + "\n")
    assert main(["identify", str(path), "--suggest", "--json"]) == 1
    out, error = capsys.readouterr()
    found = json.loads(out)
    assert found["a"]["value"] is None
    assert "leaves -1 to 0" in found["a"]["not_determined"]
    assert "the readings fix least: k" in found["valley"]
    assert found["suggestions"][0]["ratio"] < 0.1
    assert "is not determined" in error
    assert all(math.isfinite(row["half_k"]) for row in found["suggestions"])


def test_numbers_out_of_the_usual_and_misfits_are_taken_on_request(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "cp.csv"
    test = noisy("CP", "ramp-dwell", 1)
    path.write_text(test.text().replace("15 mm", "1.5 mm").replace("0.125 mm", "0.0125 mm"))
    assert main(["identify", str(path)]) == 2
    slipped = replace(test, thickness=test.thickness - np.where(test.time > 600.0, 0.01, 0.0))
    path.write_text(slipped.text())
    assert main(["identify", str(path), "--json", "--accept-misfit"]) == 0
    assert "the law does not follow them" in capsys.readouterr().err
