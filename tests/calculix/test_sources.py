"""The emitted native source: warnings as errors, the same every time; the command of the README makes the library."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from plyflow.cli import main
from plyflow.errors import InputError
from plyflow.hosts.calculix.faces import face_files, native_text
from umatgen.scene import SCENES

WITH_FACE = [name for name, scene in SCENES.items() if scene.ntens == 6 and scene.fibre == "1" and not scene.baked
             and scene.compaction == "normal" and scene.tangent != "none" and not scene.creep
             and not scene.table]  # fmt: skip


def said(text: str, folder: Path, *flags: str) -> str:
    """What gfortran says of a source."""
    (folder / "native.for").write_text(text)
    command = ["gfortran", "-std=f2018", "-Wall", "-Wextra", "-Werror", "-fimplicit-none", *flags, "-c", "native.for"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False).stderr


@pytest.mark.parametrize("name", WITH_FACE)
def test_the_native_source_is_clean_fixed_form_of_72_and_132_columns(name: str, tmp_path: Path) -> None:
    text = native_text(SCENES[name])
    assert said(text, tmp_path) == said(text, tmp_path, "-ffixed-line-length-132") == ""
    assert max(len(line) for line in text.splitlines()) <= 72
    assert text == native_text(SCENES[name])


def test_an_unused_variable_in_the_source_would_be_seen(tmp_path: Path) -> None:
    planted = native_text(SCENES["bdf1"]).replace("INTEGER :: i, j, n,", "INTEGER :: i, j, n, unused_one,", 1)
    assert "unused_one" in said(planted, tmp_path)


def test_every_procedure_of_the_material_frame_is_headed_by_its_equation_and_nothing_spatial_is_left() -> None:
    text = native_text(SCENES["bdf1"])
    for name in ("kinematics", "stress", "gradient", "tangent"):
        head = text.split(f"SUBROUTINE pf_bdf1_{name}(")[0].rsplit("!-----", 1)[1]
        assert re.search(r"! Equation: \d+", head)
        assert "! In:" in head
        assert "! Out:" in head
    assert not any(word in text for word in ("b_left(", "y_rate", "Cauchy stress", " tau"))
    assert "c_inverse(" in text


@pytest.mark.parametrize("name", sorted(set(SCENES) - set(WITH_FACE)))
def test_a_scene_without_a_face_is_refused_with_the_choice_to_make(name: str) -> None:
    with pytest.raises(InputError, match="CalculiX"):
        native_text(SCENES[name])


def test_the_command_of_the_readme_makes_the_library(tmp_path: Path) -> None:
    assert main(["calculix", "write", "bdf1", "-o", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == set(face_files("bdf1"))
    (command,) = re.findall(r"^  (gfortran .*)$", (tmp_path / "README.txt").read_text(), re.MULTILINE)
    subprocess.run(command.split(), cwd=tmp_path, check=True, capture_output=True)
    library = ["nm", "-D", "libPFBDF1.so"]
    symbols = subprocess.run(library, cwd=tmp_path, check=True, capture_output=True, text=True)
    assert " T PFMATERIAL\n" in symbols.stdout
