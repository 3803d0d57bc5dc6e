"""One short session of `plyflow bench`: files, statements, and what must hold in them."""

from __future__ import annotations

import json
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from selenium.webdriver import Chrome

from browsing import faults_of_report
from plyflow.cli import main
from plyflow.evidence.bench import problems as problems_module
from plyflow.evidence.bench.problems import QUANTITIES, problems
from plyflow.evidence.bench.schemes import all_schemes
from umatgen.scene import SCENES

SHORT = {"REFINEMENTS": (1.0, 3.0), "LARGEST": (240.0, 60.0, 40.0, 20.0, 5.0), "TOLERANCES": (1e-3,)}
TAKING_PART = ("default", "bdf1", "paper", "multiplier", "baked", "squeeze")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files of a session with few scenes and levels."""
    target = tmp_path_factory.mktemp("bench")
    with pytest.MonkeyPatch.context() as patch:
        for name, value in SHORT.items():
            patch.setattr(problems_module, name, value)
        few = {name: SCENES[name] for name in TAKING_PART}
        for place in ("schemes", "run"):
            patch.setattr(f"plyflow.evidence.bench.{place}.SCENES", few)
        assert main(["bench", "--quick", "--repeats", "3", "-o", str(target), "--json", str(target / "more" / "b.json")]) == 0
    return target


@pytest.fixture(scope="module")
def data(folder: Path) -> dict[str, Any]:
    """The JSON."""
    found: dict[str, Any] = json.loads((folder / "bench.json").read_text())
    return found


def points(data: dict[str, Any], problem: str, scheme: str) -> dict[str, Any]:
    """Points of a scheme by control."""
    return {p["control"]: p for p in data["points"] if p["problem"] == problem and p["scheme"] == scheme}


def test_all_files_are_there_and_the_figures_stand_in_the_report(folder: Path, data: dict[str, Any]) -> None:
    text = unescape((folder / "bench.html").read_text())
    pictures = {f"{p.name}-{q}.svg": f"{p.label}: {QUANTITIES[q]}" for p in problems(True) for q in p.quantities}
    assert {path.name for path in folder.glob("*.svg")} == set(pictures)
    assert all(f"<figcaption>{caption}" in text for caption in pictures.values()) and text.count("<svg") == len(pictures)
    assert (folder / "more" / "b.json").read_text() == (folder / "bench.json").read_text()
    for section in ("Peers", "What the errors rest on", "Uncertainty", "Limits of these results", "All runs", "Made with",
                    "Assumptions", "Inputs", "Scenes that take no part"):  # fmt: skip
        assert f"<h2>{section}</h2>" in text
    assert all(line in text for line in (*data["verdict"], *data["not_shown"]))


def test_the_fronts_are_told_point_by_point(folder: Path, data: dict[str, Any]) -> None:
    fronts = (folder / "bench.html").read_text().split("What lies on the fronts")[1].split("</details>")[0]
    best = min((p for p in data["points"] if p["problem"] == "slow" and p["errors"]), key=lambda p: p["errors"]["thickness"])
    rows = [row for row in fronts.split("<tr>") if "slow, thickness" in row]
    assert best["scheme"] in rows[-1] and best["control"] in rows[-1] and f"{best['errors']['thickness']:.1e}" in rows[-1]
    assert not any("tensortrax" in row for row in rows)


def test_the_recommendation_needs_at_most_a_quarter_of_the_papers_calls_and_few_increments(data: dict[str, Any]) -> None:
    # Calls and increments are the same on every machine; the run times of the session are reported beside them.
    ratios = [one["calls"] for one in data["comparisons"] if one["scheme"] == data["recommended"] and one["base"] == "paper"]
    assert len(ratios) == 3 and all(0.0 < one <= 0.25 for one in ratios)
    wanted = [line for line in data["verdict"] if line.startswith("increments of default")]
    assert len(wanted) == 2 and all(line.endswith(": met") for line in wanted)
    for found in data["cases"].values():
        assert found["missed"] == [] and max(found["increments"].values()) <= 60
        assert np.median(list(found["increments"].values())) <= 25


def test_errors_fall_with_the_increments_by_the_integrators_order(data: dict[str, Any]) -> None:
    first, second = points(data, "blocked", "bdf1"), points(data, "slow", "default")
    factor = first["growth 1"]["errors"]["thickness"] / first["growth 3"]["errors"]["thickness"]
    assert factor == pytest.approx(3.0, rel=0.1)
    assert second["largest 40"]["errors"]["thickness"] / second["largest 20"]["errors"]["thickness"] == pytest.approx(4.0, rel=0.25)
    assert all(p["errors"]["width"] < 1e-4 for p in [*first.values(), *second.values()])


def test_an_exact_peer_makes_the_same_errors_at_another_price(data: dict[str, Any]) -> None:
    mine, peer = (points(data, "blocked", name)["largest 20"] for name in ("bdf1", "four_index"))
    assert peer["errors"]["thickness"] == pytest.approx(mine["errors"]["thickness"], rel=1e-6)
    slow = points(data, "blocked", "tensortrax")["largest 20"]
    assert slow["errors"]["thickness"] == pytest.approx(mine["errors"]["thickness"], rel=1e-6)
    assert slow["seconds_median"] > 20 * mine["seconds_median"]
    assert points(data, "blocked", "paper")["largest 20"]["errors"]["thickness"] != pytest.approx(
        mine["errors"]["thickness"], rel=1e-6
    )


def test_what_takes_no_part_is_said_with_the_reason(data: dict[str, Any]) -> None:
    assert list(data["left_out"]) == ["squeeze"]
    assert "needs 'both'" in data["left_out"]["squeeze"]


def test_rounding_distance_rates_and_machine_are_told(data: dict[str, Any]) -> None:
    assert 0.0 < data["rounding"]["stress"][0] < 1e-12
    assert 0.0 < abs(data["distance_of_the_model"]["blocked"]) < 1e-6
    assert all(rate > 1e3 for rates in data["batch"]["calls_per_second"].values() for rate in rates)
    assert {"processor", "compiler", "flags"} <= set(data["machine"])
    assert data["problems"]["blocked"]["inputs"]["kappa"] == 1e5
    assert len(data["not_shown"]) >= 4


def test_repeats_are_kept_and_bounded(data: dict[str, Any], capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert {len(p["seconds"]) for p in data["points"] if p["scheme"] == "default"} == {3}
    assert main(["bench", "--repeats", "2", "-o", str(tmp_path)]) == 2
    assert "repeats is 2; at least 3" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_every_scene_takes_part_or_is_left_out_with_a_reason() -> None:
    schemes, left_out = all_schemes()
    taking = {scheme.name for scheme in schemes if scheme.kind == "scene"}
    assert taking | set(left_out) == set(SCENES) and not taking & set(left_out)
    assert all(reason for reason in left_out.values())


def test_the_reference_is_exact_where_the_answer_is_known() -> None:
    speed = problems(False)[-1]
    values = {"w0": 15.0, "h0": 0.5, "l0_over_d": 4294.0, "k": 0.813, "a": -0.866, "b_squeeze": -14.93, "b_bleed": -31.66,
              "eps_lock": -0.05934, "chi_ratio": 0.7}  # fmt: skip
    reference = problems_module.Reference(speed, values, np.zeros(1))
    thickness = np.array([1.0, 0.97])
    rate = 0.2 / 600.0 / thickness
    eps = np.log(thickness)
    chi_l = np.exp(0.11868)
    gap = 0.813 / (np.sqrt(chi_l / 0.7) * np.exp(eps) - 0.813)
    by_hand = -2 * 900 * np.exp(-4 * eps) * 2 * np.sqrt(chi_l) * np.exp(eps) * 0.813 * (gap**2 + 3) * np.exp(-14.93) * rate**0.134
    found = reference.plate_stress(thickness, np.array([False, False]))
    assert found == pytest.approx(by_hand, rel=1e-12, abs=0)
    assert found != pytest.approx(by_hand * (1 + 1e-10), rel=1e-12, abs=0)


def test_a_reader_sees_the_whole_report(folder: Path, browser: Chrome, tmp_path: Path) -> None:
    assert faults_of_report(browser, (folder / "bench.html").read_text(encoding="utf-8"), tmp_path) == []
