"""Blocks in OpenGeoSys against the driver; every comparison is shown to see a planted error."""

from __future__ import annotations

import ctypes
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mgis.door import Door
from plyflow.cli import main
from plyflow.errors import RunError
from plyflow.hosts.mgis import checks
from plyflow.hosts.mgis.behaviour import Behaviour, behaviour_of
from plyflow.hosts.mgis.checks import ELEMENT, FULL, PRESSED, check_block
from plyflow.hosts.mgis.opengeosys import require_ogs
from plyflow.umat.prepare import prepare_umat


@pytest.fixture(scope="session", autouse=True)
def _opengeosys() -> None:
    """There is no skip: without OpenGeoSys these tests fail and say how to get it."""
    require_ogs()


def block(name: str) -> checks.Block:
    return next(one for one in FULL if one.name == name)


@pytest.mark.parametrize("scene", ["bdf1", "default"])
def test_an_element_and_a_pressed_one_do_what_the_driver_does(scene: str, tmp_path: Path) -> None:
    rows = list(checks.check_scene(scene, tmp_path))
    assert [row.remark for row in rows] == ["", "", ""]
    assert [row.rejected for row in rows if row.job.startswith("element")] == [0, 0]
    # 24 % is far behind the lock, where the free width is exp(-eps_lock) but for the steps that are left.
    assert [row.width for row in rows] == pytest.approx([np.exp(0.140253)] * 3, abs=3e-4)


@pytest.mark.parametrize("name", ["4x4x4 F-bar", "held 3x3x3 F-bar"])
def test_a_mesh_with_f_bar_does_what_the_driver_does(name: str, tmp_path: Path) -> None:
    row = check_block(block(name), prepare_umat("default"), "default", tmp_path)
    assert row.remark == ""
    assert row.rejected == 0


def altered(monkeypatch: pytest.MonkeyPatch, right: str, wrong: str) -> None:
    """The behaviour of a scene with something else in its mechanics."""

    def other(scene: str) -> Behaviour:
        made = behaviour_of(scene)
        text = made.files["generic_behaviour.h"]
        assert text.count(right) == 1
        return replace(made, files=dict(made.files) | {"generic_behaviour.h": text.replace(right, wrong)})

    monkeypatch.setattr(checks, "behaviour_of", other)


@pytest.mark.parametrize(
    ("right", "wrong", "one", "remark"),
    [
        ("det * stress[k];", "1.001 * det * stress[k];", ELEMENT, "stress or state differs"),
        ("memcpy(props, d->s1.material_properties, N_PROPS * sizeof(double));",
         "memcpy(props, d->s1.material_properties, N_PROPS * sizeof(double)); props[7] *= 0.99;", ELEMENT, "width differs"),
    ],
)  # fmt: skip
def test_an_error_in_the_behaviour_is_seen(
    right: str, wrong: str, one: checks.Block, remark: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    altered(monkeypatch, right, wrong)
    assert remark in check_block(one, prepare_umat("bdf1"), "bdf1", tmp_path).remark


def test_a_load_that_is_not_the_blocks_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = checks.run_block
    monkeypatch.setattr(checks, "run_block", lambda block, *rest: run(replace(block, pressure=0.1), *rest))
    assert "pressure differs by 5.0e-01" in check_block(PRESSED, prepare_umat("bdf1"), "bdf1", tmp_path).remark


def test_a_wrong_operator_costs_iterations_or_the_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    altered(monkeypatch, "K[i * columns + k] = change[i]", "K[i * columns + k] = 3.0 * change[i]")
    with pytest.raises(RunError, match=r"did not finish element.*block\.log"):
        check_block(ELEMENT, prepare_umat("bdf1"), "bdf1", tmp_path)


def test_the_command_prints_a_table_or_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(checks, "QUICK", (replace(ELEMENT, increments=10, compaction=0.02),))
    assert main(["mgis", "check", "bdf1", "--json", "-o", str(tmp_path)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["scene"], found["blocks"][0]["increments"]) == ("bdf1", 10)
    assert found["OpenGeoSys"]
    assert main(["mgis", "check", "bdf1", "-o", str(tmp_path)]) == 0
    assert "bdf1 in OpenGeoSys" in capsys.readouterr().out


def test_frames_are_turned_as_mfront_turns_them(bdf1: Door) -> None:
    """Beside a behaviour that MFront itself made, which comes with OpenGeoSys."""
    library = next(require_ogs().parents[1].glob("lib/python*/site-packages/lib64/libOgsMFrontBehaviour.so"))
    made = Door(library, "MohrCoulombAbboSloanOrtho")
    rng = np.random.default_rng(3)
    basis = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    basis *= np.sign(np.linalg.det(basis))
    for own, other, shape in (
        ("ThermodynamicForces_PK2Stress", "ThermodynamicForces", (6,)),
        ("TangentOperatorBlocks_dPK2_dEGL", "TangentOperatorBlocks", (6, 6)),
    ):
        values = rng.standard_normal(shape)
        assert np.abs(bdf1.turned(own, values, basis) - made.turned(other, values, basis)).max() < 1e-14
    assert isinstance(made.library, ctypes.CDLL)
