"""The emitted native source: both forms, warnings as errors, the same every time; the commands of the README."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from plyflow.cli import main
from plyflow.errors import InputError
from plyflow.hosts.calculix.faces import adapter_face, native_text
from plyflow.hosts.calculix.sources import face_files
from umatgen.scene import SCENES, Scene

WITH_FACE = [name for name, scene in SCENES.items() if scene.ntens == 6 and scene.fibre == "1" and not scene.baked
             and scene.invariants == "transverse" and scene.tangent != "none" and not scene.two_step
             and not scene.table]  # fmt: skip
STRICT = ["-std=f2018", "-Wall", "-Wextra", "-Werror", "-fimplicit-none"]


def compiled(path: Path, flags: list[str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["gfortran", *flags, "-c", str(path), "-o", str(path.with_suffix(".o"))],
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize("name", WITH_FACE)
def test_the_native_source_is_valid_in_both_forms(name: str, tmp_path: Path) -> None:
    text = native_text(SCENES[name])
    free, fixed = tmp_path / "free.f90", tmp_path / "fixed.for"
    free.write_text(text)
    fixed.write_text(text)
    assert compiled(free, STRICT).stderr == ""
    assert compiled(fixed, ["-ffixed-form", "-std=legacy", "-Wall"]).returncode == 0
    assert max(len(line.removesuffix("&").rstrip()) for line in text.splitlines()) <= 72


def test_an_unused_variable_in_the_source_would_be_seen(tmp_path: Path) -> None:
    path = tmp_path / "planted.f90"
    path.write_text(native_text(Scene()).replace("INTEGER :: i, j, n,", "INTEGER :: i, j, n, unused_one,", 1))
    assert "unused_one" in compiled(path, STRICT).stderr


def test_the_source_is_the_same_every_time() -> None:
    assert native_text(Scene()) == native_text(Scene())


def test_every_procedure_of_the_material_frame_is_headed_by_its_equation() -> None:
    text = native_text(Scene())
    for name in ("kinematics", "stress", "gradient", "tangent"):
        head = text.split(f"SUBROUTINE pf_default_{name}(")[0].rsplit("!-----", 1)[1]
        assert re.search(r"! Equation: \d+", head)
        assert "! In:" in head
        assert "! Out:" in head


def test_nothing_spatial_is_left_in_it() -> None:
    text = native_text(Scene())
    for word in ("b_left(", "y_rate", "Cauchy stress", " tau"):
        assert word not in text
    assert "c_inverse(" in text


@pytest.mark.parametrize("name", sorted(set(SCENES) - set(WITH_FACE)))
def test_a_scene_without_a_face_is_refused_with_the_choice_to_make(name: str) -> None:
    with pytest.raises(InputError, match="CalculiX"):
        native_text(SCENES[name])


@pytest.mark.parametrize("name", ["lower", "UNDER_SCORE", "", "X" * 41])
def test_a_library_name_that_calculix_cannot_read_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="at most 40 capital letters and digits"):
        adapter_face("", name)


def test_the_commands_of_the_readme_make_the_libraries(tmp_path: Path) -> None:
    assert main(["calculix", "write", "-o", str(tmp_path)]) == 0
    assert {path.name for path in tmp_path.iterdir()} == set(face_files("default"))
    commands = re.findall(r"^  (gfortran .*)$", (tmp_path / "README.txt").read_text(), re.MULTILINE)
    assert len(commands) == 2
    for command in commands:
        subprocess.run(command.split(), cwd=tmp_path, check=True, capture_output=True)
    for library, symbol in (("libPFDEFAULT.so", "PFMATERIAL"), ("libPFDEFAULTNL.so", "PFUMAT")):
        symbols = subprocess.run(["nm", "-D", library], cwd=tmp_path, check=True, capture_output=True, text=True)
        assert f" T {symbol}\n" in symbols.stdout
