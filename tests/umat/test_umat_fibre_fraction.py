"""STATEV fibre_fraction is V0/J with the V0 in force, whoever says it: scene, scene file or case."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from plyflow.case.case import Case, state_place
from plyflow.cli import main
from plyflow.errors import InputError
from plyflow.run.case_run import run_case
from plyflow.umat.prepare import prepare_umat
from plyflow.umat.scenes import find_scene

CASE = Case("IM7-8552", 70.0, "BP", 15.0)
DENSE = replace(CASE, settings={"fibre_fraction_initial": 0.55})


def test_the_state_holds_the_fraction_of_the_case() -> None:
    umat = prepare_umat("default", DENSE.fibre_fraction)
    result = run_case(DENSE, umat)
    fractions = result.history.statev[:, state_place(umat.manifest, "fibre_fraction")]
    volumes = result.history.statev[:, state_place(umat.manifest, "J")]
    assert fractions[1:] * volumes[1:] == pytest.approx(0.55, rel=1e-12)
    assert fractions[-1] == pytest.approx(float(result.law.fibre_fraction[-1]), abs=1e-3)
    assert result.provenance["scene"]["fibre_fraction"] == 0.55


def test_a_umat_with_another_fraction_than_the_case_s_is_refused() -> None:
    with pytest.raises(InputError, match=r"fibre_fraction = 0.5, the case has fibre_fraction_initial = 0.55"):
        run_case(DENSE, prepare_umat())


def test_a_scene_file_with_its_own_fraction_is_kept_or_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own, silent = tmp_path / "own.toml", tmp_path / "silent.toml"
    own.write_text("fibre_fraction = 0.55\n")
    silent.write_text('tangent = "paper"\n')
    assert find_scene(str(silent), 0.55).fibre_fraction == find_scene(str(own), 0.55).fibre_fraction == 0.55
    assert find_scene(str(silent)).fibre_fraction == 0.5
    case = ["run", "--material", "IM7-8552", "--temperature", "70", "--layup", "BP", "--scene", str(own)]
    assert main(case) == 2
    out, error = capsys.readouterr()
    assert not out
    assert error.count("\n") == 1
    assert "has fibre_fraction = 0.55, the case has fibre_fraction_initial = 0.5: give both the same" in error
    assert main([*case, "--set", "fibre_fraction_initial=0.55", "--json"]) == 0
