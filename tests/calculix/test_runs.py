"""Finite-element runs in CalculiX against the driver; every comparison is shown to see a planted error."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from plyflow.errors import RunError
from plyflow.hosts.calculix.checks import (
    MOST_ITERATIONS,
    Material,
    check_face,
    check_laminate,
    check_scene,
    compacted,
    force_and_widths,
)
from plyflow.hosts.calculix.cubes import uniaxial
from plyflow.hosts.calculix.faces import Face, native_face, native_text
from plyflow.hosts.calculix.job import run_job
from plyflow.hosts.deck import laminate_deck
from plyflow.umat.prepare import prepare_umat
from umatgen.scene import SCENES

pytestmark = pytest.mark.usefixtures("ccx")


def deck(material: Material, face: Face, strain: float = -0.05, increments: int = 20) -> str:
    return uniaxial(strain, increments).deck(material.card(face), face.material)


def test_the_native_face_runs_as_the_driver_does(material: Material, native: Face, tmp_path: Path) -> None:
    rows = list(check_face(material, native, tmp_path))
    assert [row.job for row in rows] == ["uniaxial", "shear", "rotation", "twist", "bend", "laminate"]
    assert [row.remark for row in rows if not row.passed] == []
    assert max(row.iterations for row in rows) <= MOST_ITERATIONS
    assert sum(row.cutbacks for row in rows) == 0


def test_a_scene_is_checked_by_name_in_a_relative_folder_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """CalculiX runs in that folder and has to find the libraries from there."""
    monkeypatch.chdir(tmp_path)
    first = next(iter(check_scene("symmetric", Path("jobs"))))
    assert (first.job, first.passed) == ("uniaxial", True), first.remark
    assert any((tmp_path / "jobs").rglob("*.dat"))


@pytest.mark.parametrize(
    ("right", "wrong", "jobs", "remark"),
    [
        ("stre = stress\n", "stre = 1.001d0*stress\n", "uniaxial shear rotation twist bend", "differs from the driver"),
        ("stiff(n) = ddsdde(i,j)\n", "stiff(n) = ddsdde(i,j)/100.0d0\n", "uniaxial", "did not finish"),
    ],
)
def test_an_error_in_the_native_face_is_seen(
    right: str, wrong: str, jobs: str, remark: str, material: Material, tmp_path: Path
) -> None:
    text = native_text(SCENES["bdf1"])
    assert len(re.findall(rf"^ +{re.escape(right)}", text, re.MULTILINE)) == 1
    face = native_face(SCENES["bdf1"], text.replace(f" {right}", f" {wrong}"))
    seen: dict[str, str] = {}
    try:
        for row in check_face(material, face, tmp_path):
            seen[row.job] = row.remark
    except RunError as stopped:
        seen[re.findall(r"job (\w+)", str(stopped))[0]] = str(stopped)
    assert all(remark in seen[job] for job in jobs.split())


def test_the_laminate_without_friction_takes_the_driver_s_force_and_width(
    material: Material, native: Face, tmp_path: Path
) -> None:
    softer = material.with_values(kappa=100.0)
    smooth = laminate_deck("calculix", softer.card(native), native.material, friction=0.0, cells=(3, 3, 1))
    force, widths = force_and_widths(run_job("smooth", smooth, [native], tmp_path))
    core = compacted(softer, 0.96, 240.0)
    widened = core.deformation_gradient[-1, 1, 1]
    # Increments of 10 s in CalculiX, of 5 s in the driver: two percent of the force, a few 1e-4 of the width.
    assert force == pytest.approx(-core.stress[-1, 2] * 7.5 * 7.5 * widened, rel=0.03)
    assert widths == pytest.approx([widened, widened], abs=5e-4)


def test_another_material_in_the_laminate_is_seen(
    material: Material, native: Face, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    softer = material.with_values(kappa=100.0)
    thicker = softer.with_values(h0=2.0 * material.values[1]).card(native)
    monkeypatch.setattr(Material, "card", lambda self, face: thicker)
    row = check_laminate(softer, native, tmp_path)
    assert not row.passed
    assert "force" in row.remark


def test_a_deck_that_asks_for_too_much_says_why_in_the_log(material: Material, native: Face, tmp_path: Path) -> None:
    result = run_job("crushed", deck(material, native, -0.9, 2), [native], tmp_path, must_finish=False)
    assert not result.completed
    assert "compaction limit: stretch must stay above its bound" in (tmp_path / "crushed.log").read_text()


def test_a_missing_library_is_named(material: Material, native: Face, tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"libPFBDF1\.so"):
        run_job("lonely", deck(material, native), [], tmp_path)


def test_a_run_that_takes_too_long_is_stopped(material: Material, native: Face, tmp_path: Path) -> None:
    large = laminate_deck("calculix", material.card(native), native.material, cells=(8, 8, 2))
    with pytest.raises(RunError, match=r"took more than 0\.5 s"):
        run_job("slow", large, [native], tmp_path, timeout=0.5)


def test_increments_of_fixed_size_are_those_of_the_deck(material: Material, native: Face, tmp_path: Path) -> None:
    fixed = deck(material, native, -0.05, 5)
    result = run_job("fixed", fixed, [native], tmp_path)
    assert result.increments["increment_size"].to_list() == pytest.approx([4.0] * 5)
    assert result.tables["S", "BODY"].time == pytest.approx([4.0, 8.0, 12.0, 16.0, 20.0])
    sizes = "*STATIC, DIRECT\n4.0, 20.0\n"
    assert sizes in fixed
    free = run_job("free", fixed.replace(sizes, "*STATIC\n4.0, 20.0, 4.0, 20.0\n"), [native], tmp_path)
    assert len(free.increments) < 5


def test_the_laminate_without_friction_passes_the_lock_as_plyflow_laminate_does(
    material: Material, native: Face, tmp_path: Path
) -> None:
    """Both end beyond the lock, where a free edge stays as wide as it is; kappa = 10 MPa lets CalculiX's iteration get there."""
    from plyflow.case.case import Case
    from plyflow.case.stack import stack_angles
    from plyflow.hosts.laminate.equilibrium import Equilibrium
    from plyflow.hosts.laminate.run import LaminateRun
    from plyflow.hosts.laminate.specimen import Specimen

    softer = material.with_values(kappa=10.0)
    deck = laminate_deck("calculix", softer.card(native), native.material, friction=0.0, cells=(3, 3, 1), compaction=0.2)
    result = run_job("locked", deck, [native], tmp_path)
    force, widths = force_and_widths(result)
    assert result.cutbacks == 0
    core = compacted(softer, 0.8, 240.0)
    # As above: increments of 10 s in CalculiX, of 5 s in the driver.
    assert force == pytest.approx(-core.stress[-1, 2] * 7.5 * 7.5 * core.deformation_gradient[-1, 1, 1], rel=0.03)
    case = Case("IM7-8552", 70.0, "BP", 15.0, settings={"kappa": 10.0})
    run = LaminateRun(Equilibrium(Specimen(case, stack_angles("90,0", "BP"), 1), prepare_umat("bdf1"), 0.0))
    run.finish()
    assert run.course.rows[-1][2] == 1.0  # all points locked
    # Each passes the lock in increments of its own, over which a width is right to some 1e-3.
    assert widths == pytest.approx(run.course.rows[-1][4:6], abs=2e-3)
