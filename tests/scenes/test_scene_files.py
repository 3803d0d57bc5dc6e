"""Scenes from TOML files: validated with the file, the key and what is allowed."""

from __future__ import annotations

from pathlib import Path

import pytest

from plyflow.cli import main
from plyflow.errors import InputError
from plyflow.umat.scenes import find_scene, read_scene
from plyflow.umat.sizes import scene_table
from umatgen.explain import explain
from umatgen.pipeline import generate
from umatgen.scene import SCENES, Scene


def write(folder: Path, text: str) -> Path:
    """A scene file."""
    path = folder / "mine.toml"
    path.write_text(text)
    return path


def test_a_scene_file_is_read(tmp_path: Path) -> None:
    scene = read_scene(write(tmp_path, 'regimes = "squeeze"\ntangent = "symmetric"\nelastic = false\n'))
    assert scene == Scene(name="mine", regimes="squeeze", tangent="symmetric", elastic=False)
    assert "SUBROUTINE pf_mine_point" in generate(scene).source


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("colour = 1", "'colour' is no key of a scene"),
        ('regimes = "flow"', "regimes 'flow' is not known; choose one of both, squeeze, bleed"),
        ("elastic = [1]", "elastic"),
        ("regimes = ", "is not TOML"),
        ("[baked]\nk = 0.8", "lacks w0"),
        ("baked = 3", "must be a table"),
    ],
)
def test_a_bad_scene_file_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_scene(write(tmp_path, text))


def test_an_unknown_scene_or_file_is_refused() -> None:
    with pytest.raises(InputError, match="the shipped scenes are"):
        find_scene("nope")
    with pytest.raises(InputError, match="give the path of a TOML file"):
        find_scene("nope.toml")


def test_the_table_lists_every_scene_and_the_passes_save_operations() -> None:
    table = scene_table().set_index("scene")
    assert set(table.index) == set(SCENES)
    assert (table["operations"] <= table["operations, raw"]).all()
    assert table.loc["stressonly", "operations"] < table.loc["default", "operations"] / 2


def test_explain_names_what_is_gone_and_nothing_else() -> None:
    assert explain(Scene()) == []
    pieces = {(o.kind, o.name) for o in explain(SCENES["squeeze"])}
    assert ("procedure", "bleed") in pieces and ("constant", "l0_over_d") in pieces and ("state", "locked") in pieces
    assert not any(name == "squeeze" for _, name in pieces)


def test_the_commands_print(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "bleed"]) == 0
    assert "regimes is 'bleed'" in capsys.readouterr().out
    assert main(["explain", "nope"]) == 2
    assert "the shipped scenes are" in capsys.readouterr().err
