"""What an analyst asks of `plyflow abaqus`: directions, ply thickness, and a folder in which nothing stale stays."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from abaqus.keywords import Keyword, read
from plyflow.case.case import Case
from plyflow.cli import main
from plyflow.hosts.abaqus.package import abaqus_files

CASE = Case("IM7-8552", 70.0, "BP", 15.0)
COMMAND = ["abaqus", "--material", "IM7-8552", "-o"]


def keywords(text: str, name: str) -> list[Keyword]:
    return [entry for entry in read(text) if entry.name == name]


@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0, -45.0, 22.5])
def test_a_direction_of_any_angle_has_its_orientation_with_the_fibre_along_local_axis_1(angle: float) -> None:
    text = abaqus_files("default", CASE, angles=(angle, 0.0))["orientation.inc"]
    line = keywords(text, "ORIENTATION")[0]
    first, second = np.reshape([float(value) for value in line.data[0]], (2, 3))
    turn = np.radians(angle)
    assert first == pytest.approx([np.cos(turn), np.sin(turn), 0.0], abs=1e-14)
    assert np.cross(first, second) == pytest.approx([0.0, 0.0, 1.0], abs=1e-14)
    sections = [entry.parameters["ORIENTATION"] for entry in keywords(text, "SOLID SECTION")]
    assert sections == [line.parameters["NAME"], keywords(text, "ORIENTATION")[-1].parameters["NAME"]]


def test_ply_thickness_and_stack_reach_card_and_sections(tmp_path: Path) -> None:
    options = ["--layup", "BP", "--ply-thickness", "0.13", "--stack", "0/90/45"]
    assert main([*COMMAND, str(tmp_path), *options]) == 0
    assert "2 h0 = 0.52 [mm]" in (tmp_path / "material.inc").read_text()
    assert len(keywords((tmp_path / "orientation.inc").read_text(), "SOLID SECTION")) == 3


REFUSED = [
    (["--ply-thickness", "130"], "--ply-thickness 130 mm must be above 0 and at most 10 mm"),
    (["--ply-thickness", "0.1", "--set", "h0=0.5"], "--ply-thickness and --set h0 exclude each other"),
    (["--stack", "0/90", "--angle", "30"], "--stack and --angle exclude each other"),
    (["--stack", "0/x"], "write directions in degrees"),
    (["--angle", "nan"], "direction nan must be a finite number"),
]


@pytest.mark.parametrize(("options", "what"), REFUSED)
def test_options_that_do_not_fit_are_refused_and_nothing_is_written(
    options: list[str], what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*COMMAND, str(tmp_path / "job"), *options]) == 2
    assert what in capsys.readouterr().err
    assert not (tmp_path / "job").exists()


def test_another_job_is_replaced_when_asked_for_and_leaves_nothing_behind(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*COMMAND, str(tmp_path)]) == 0
    assert main([*COMMAND, str(tmp_path)]) == 0  # the same job again
    (tmp_path / "c3d8_monotonic.odb").write_text("a result")
    other = ["abaqus", "plane", "--material", "IM7-8552", "-o", str(tmp_path)]
    assert main(other) == 2
    assert "holds another job (scene default, case IM7-8552 70 degC BP 15 mm" in capsys.readouterr().err
    assert (tmp_path / "default.for").exists()
    assert main([*other, "--force"]) == 0
    left = {path.name for path in tmp_path.iterdir()}
    assert "c3d8_monotonic.odb" in left and not left & {"default.for", "c3d8_monotonic.inp", "laminate.inp"}


def test_files_that_nobody_knows_are_not_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "README.txt").write_text("mine")
    assert main([*COMMAND, str(tmp_path)]) == 2
    assert "has a README.txt of its own" in capsys.readouterr().err
    assert (tmp_path / "README.txt").read_text() == "mine" and len(list(tmp_path.iterdir())) == 1
