"""Finite-element runs in CalculiX against the driver; every comparison is shown to see a planted error."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calculix import planted
from plyflow.errors import RunError
from plyflow.hosts.abaqus.deck import MaterialCard
from plyflow.hosts.calculix import scenarios
from plyflow.hosts.calculix.checks import (
    MOST_ITERATIONS,
    PRINTED_DIGITS,
    CheckRow,
    Material,
    check_face,
    check_laminate,
    check_locking,
    check_scene,
    compacted,
)
from plyflow.hosts.calculix.faces import Face, adapter_face, native_face, native_text
from plyflow.hosts.calculix.job import run_job, try_job
from plyflow.umat.compile import FLAGS, compile_umat, support_source
from plyflow.umat.prepare import prepare_umat
from umatgen.scene import Scene

pytestmark = pytest.mark.usefixtures("ccx")
JOBS = ["uniaxial", "shear", "rotation", "twist", "bend"]
NEO_HOOKE = Path(__file__).resolve().parents[1] / "diagnose" / "umats" / "neo_hooke.f"
WITH_INCLUDE = (*FLAGS, f"-I{support_source('ABA_PARAM.INC').parent}")


def failed(rows: list[CheckRow]) -> dict[str, str]:
    return {row.job: row.remark for row in rows if not row.passed}


def test_the_native_face_runs_as_the_driver_does(material: Material, native: Face, tmp_path: Path) -> None:
    rows = list(check_face(material, native, "native", tmp_path))
    assert [row.job for row in rows] == [*JOBS, "laminate"]
    assert failed(rows) == {}
    assert max(row.iterations for row in rows) <= MOST_ITERATIONS
    assert sum(row.cutbacks for row in rows) == 0


def test_the_adapter_runs_as_the_driver_does(material: Material, adapter: Face, tmp_path: Path) -> None:
    rows = list(check_face(material, adapter, "adapter", tmp_path))
    assert [row.job for row in rows] == JOBS
    assert failed(rows) == {}
    late = [row for row in rows if row.iterations > MOST_ITERATIONS]
    assert all("iterations after the first increment" in row.remark for row in late)


def test_a_scene_is_checked_by_name(tmp_path: Path) -> None:
    first = next(iter(check_scene("symmetric", tmp_path)))
    assert (first.job, first.door, first.passed) == ("uniaxial", "native", True)


def test_a_relative_folder_of_jobs_will_do(
    material: Material, native: Face, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """CalculiX runs in that folder and has to find the libraries from there."""
    monkeypatch.chdir(tmp_path)
    first = next(check_face(material, native, "native", Path("jobs")))
    assert first.passed, first.remark
    assert any((tmp_path / "jobs").rglob("*.dat"))


def test_a_blended_lock_is_crossed(tmp_path: Path) -> None:
    scene = tmp_path / "soft.toml"
    scene.write_text('name = "soft"\nlock = "blend"\nblend_width = 0.02\n')
    umat = prepare_umat(str(scene))
    soft = Material(umat.manifest, [float(row["default"]) for row in umat.manifest["props"]], umat.library)
    row = check_locking(soft, native_face(Scene(name="soft", lock="blend", blend_width=0.02)), "native", tmp_path)
    assert row.passed, row.remark
    assert row.difference is not None
    assert row.difference < 2e-4


@pytest.mark.parametrize(
    ("error", "jobs", "remark"),
    [
        (planted.stress, {"uniaxial", "shear", "rotation", "twist", "bend"}, "differs from the driver"),
        (planted.stiffness, {"uniaxial"}, "did not finish"),
    ],
)
def test_an_error_in_the_native_face_is_seen(
    error: planted.Plant, jobs: set[str], remark: str, material: Material, tmp_path: Path
) -> None:
    face = planted.native(native_text(Scene()), error)
    seen: dict[str, str] = {}
    try:
        for row in check_face(material, face, "native", tmp_path):
            if not row.passed:
                seen[row.job] = row.remark
    except RunError as stopped:
        seen[re.findall(r"job (\w+)", str(stopped))[0]] = str(stopped)
    assert jobs <= set(seen)
    assert all(remark in seen[job] for job in jobs)


def test_the_laminate_without_friction_takes_the_driver_s_force_and_width(
    material: Material, native: Face, tmp_path: Path
) -> None:
    softer = material.with_values(kappa=100.0)
    deck = scenarios.laminate(friction=0.0).make(softer.card(native), native.material)
    result = run_job("smooth", deck.text(), [native], tmp_path)
    core = compacted(softer, 0.96, 240.0)
    widened = core.deformation_gradient[-1, 1, 1]
    force = -result.tables["TOTAL", "NTOP"].values[-1, 0, 2]
    # Increments of 10 s in CalculiX, of 5 s in the driver: two percent of the force, a few 1e-4 of the width.
    assert force == pytest.approx(-core.stress[-1, 2] * 7.5 * 7.5 * widened, rel=0.03)
    for edge, axis in (("AEDGE", 1), ("BEDGE", 0)):
        assert 1.0 + result.tables["U", edge].values[-1, :, axis].mean() / 7.5 == pytest.approx(widened, abs=5e-4)


def test_another_material_in_the_laminate_is_seen(material: Material, native: Face, tmp_path: Path) -> None:
    class Thicker(Material):
        def card(self, face: Face) -> str:
            values = [
                2.0 * v if row["name"] == "h0" else v
                for v, row in zip(self.values, self.manifest["props"], strict=True)
            ]
            return Material(self.manifest, values, self.library).card(face)

    softer = material.with_values(kappa=100.0)
    row = check_laminate(Thicker(softer.manifest, softer.values, softer.library), native, tmp_path)
    assert not row.passed
    assert "force" in row.remark


def neo_hooke_cauchy(f: np.ndarray, mu: float, lam: float) -> np.ndarray:
    """Cauchy stress (6,) of the test's neo-Hooke."""
    det_f = np.linalg.det(f)
    s = (mu * (f @ f.T - np.eye(3)) + lam * np.log(det_f) * np.eye(3)) / det_f
    return np.array([s[0, 0], s[1, 1], s[2, 2], s[0, 1], s[0, 2], s[1, 2]])


def test_a_neo_hooke_umat_needs_the_adapter_under_rotation(tmp_path: Path) -> None:
    """Behind the bare @ABAQUSNL_ door a UMAT that works from F is wrong by tens of percent at 90 degrees."""
    source = NEO_HOOKE.read_text()
    bare = Face("@ABAQUSNL_PFBARE", "PFBARE", compile_umat(source, WITH_INCLUDE))
    adapted = adapter_face(source, "PFNEOHOOKE", WITH_INCLUDE)
    props = [{"index": i, "name": n, "unit": "MPa", "meaning": n} for i, n in enumerate(("mu", "lambda", "mistake"), 1)]
    state = [{"index": 1, "name": "none", "unit": "-", "meaning": "not used"}]
    scenario = scenarios.rotation(0.7, 90.0)
    wanted = neo_hooke_cauchy(scenarios.turned_gradient(0.7, 90.0, 1.0), 300.0, 500.0)
    stress = {}
    for face in (bare, adapted):
        card = MaterialCard(face.material, [300.0, 500.0, 0.0], props, state, False).text("calculix")
        result = run_job(scenario.name, scenario.make(card, face.material).text(), [face], tmp_path / face.library)
        stress[face.library] = result.tables["S", "BODY"].of(1, 1)[-1]
    scale = np.abs(wanted).max()
    assert np.abs(stress["PFNEOHOOKE"] - wanted).max() < PRINTED_DIGITS * scale
    assert np.abs(stress["PFBARE"] - wanted).max() > 0.1 * scale


def test_a_deck_that_asks_for_too_much_says_why_in_the_log(material: Material, native: Face, tmp_path: Path) -> None:
    deck = scenarios.uniaxial(-0.9, 20.0, 2).make(material.card(native), native.material)
    result = try_job("crushed", deck.text(), [native], tmp_path)
    assert not result.completed
    assert "compaction limit: stretch must stay above its bound" in (tmp_path / "crushed.log").read_text()


def test_a_missing_library_is_named(material: Material, native: Face, tmp_path: Path) -> None:
    deck = scenarios.uniaxial().make(material.card(native), native.material)
    with pytest.raises(RunError, match=r"libPFDEFAULT\.so"):
        run_job("lonely", deck.text(), [], tmp_path)


def test_a_run_that_takes_too_long_is_stopped(material: Material, native: Face, tmp_path: Path) -> None:
    deck = scenarios.laminate(cells=(8, 8, 2)).make(material.card(native), native.material)
    with pytest.raises(RunError, match=r"took more than 0\.5 s"):
        run_job("slow", deck.text(), [native], tmp_path, timeout=0.5)


def test_increments_of_fixed_size_are_those_of_the_deck(material: Material, native: Face, tmp_path: Path) -> None:
    deck = scenarios.uniaxial(-0.05, 20.0, 5).make(material.card(native), native.material)
    result = run_job("fixed", deck.text(), [native], tmp_path)
    assert result.increments["increment_size"].to_numpy() == pytest.approx(np.full(5, 4.0))
    assert result.tables["S", "BODY"].time == pytest.approx([4.0, 8.0, 12.0, 16.0, 20.0])
    steps = [replace(deck.steps[0], increments=replace(deck.steps[0].increments, direct=False, maximum=20.0))]
    free = run_job("free", replace(deck, steps=steps).text(), [native], tmp_path)
    assert len(free.increments) < 5
