"""Laminates against the driver, the one-dimensional law, balances and themselves."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest


from plyflow.case.case import Case
from plyflow.case.stack import stack_angles
from plyflow.cli import main
from plyflow.errors import InputError, RunError
from plyflow.hosts.laminate.equilibrium import Equilibrium
from plyflow.hosts.laminate.result import result_files, summary, works
from plyflow.hosts.laminate.run import CHECKPOINT, LaminateRun
from plyflow.hosts.laminate.specimen import Specimen
from plyflow.law import LoadProgramme
from plyflow.sweep.umat_cases import driven as driven_case
from plyflow.umat.prepare import Umat, prepare_umat

SHORT = "time [s],force [N]\n0,0\n1,20\n60,20\n"


@pytest.fixture(scope="module")
def umat() -> Umat:
    return prepare_umat("default")


def laminate(
    umat, layup="BP", temperature=70.0, cells=2, friction=0.0, stack=None, load="ramp-dwell", folder=None, refine=1.0, settings=None,
    arms=0.0,
):  # fmt: skip
    case = Case("IM7-8552", temperature, layup, 15.0, load, settings or {})
    model = Equilibrium(Specimen(case, stack_angles(stack, layup), cells, arms), umat, friction)
    return LaminateRun(model, folder, refine)


@pytest.fixture
def short(tmp_path):
    path = tmp_path / "short.csv"
    path.write_text(SHORT)
    return str(path)


def test_stiffness_is_the_derivative_of_the_forces_on_a_distorted_mesh(umat):
    model = laminate(umat, stack="30,0").model
    noise = np.random.default_rng(0).standard_normal
    count = model.unknowns
    place, way, h = 1e-3 * noise(count), noise(count), 1e-7
    here, *around = (model.trial(model.start(), place + s * h * way, 1.0, 1.0, 1) for s in (0.0, 1.0, -1.0))
    slope = (around[0].residual - around[1].residual) / (2.0 * h)
    assert np.abs(slope - model.stiffness(here)[0] @ way).max() < 1e-6 * np.abs(slope).max()


def test_turning_the_whole_specimen_turns_its_forces_and_changes_nothing_else(umat):
    model = laminate(umat, stack="90,0").model
    nodes = model.specimen.mesh.points
    moved = 1e-3 * np.random.default_rng(1).standard_normal(nodes.shape)
    turn = np.linalg.qr(np.random.default_rng(2).standard_normal((3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    full = Equilibrium(model.specimen, umat, 0.0)
    full.owner = np.arange(nodes.size)
    start = full.start()
    straight = full.trial(start, moved.ravel(), 1.0, 0.0, 1)
    turned = full.trial(start, ((nodes + moved) @ turn.T - nodes).ravel(), 1.0, 0.0, 1)
    expected = straight.residual.reshape(-1, 3) @ turn.T
    assert np.abs(turned.residual.reshape(-1, 3) - expected).max() < 1e-6 * np.abs(expected).max()
    assert np.abs(turned.points.statev - straight.points.statev).max() < 1e-6 * np.abs(straight.points.statev).max()


@pytest.mark.parametrize("distorted", [False, True])
def test_one_inextensible_block_does_what_the_driver_does_through_the_lock(umat, distorted):
    """The driver gets the pressure on the area that the block has become; between the increments it is linear there only."""
    case = Case("IM7-8552", 70.0, "BP", 15.0, settings={"E_L": 1e7})
    specimen = Specimen(case, (0.0,), 2)
    inside = np.isclose(specimen.mesh.points[:, :2], 3.75).all(axis=1)
    specimen.mesh.points[inside, :2] += 0.8 * distorted
    run = LaminateRun(Equilibrium(specimen, umat, 0.0))
    run.finish()
    time, _, locked, _, width = run.course.table.T
    pressures = case.load_programme.pressure(time) / width
    _, driven = driven_case(replace(case, settings={}), LoadProgramme(tuple(time), tuple(pressures)), umat)
    assert run.course.rows[-1][1] == pytest.approx(driven.deformation_gradient[-1, 2, 2], abs=1e-4)
    assert width[-1] == pytest.approx(driven.deformation_gradient[-1, 1, 1], abs=1e-4)
    assert np.ptp(run.state.gradient, axis=0).max() < 1e-6  # the patch stays homogeneous
    assert locked[-1] == 1.0


@pytest.mark.parametrize(
    ("layup", "temperature", "fibre"), [("BP", 30.0, 25.0), ("BP", 70.0, 25.0), ("BP", 90.0, 25.0), ("CP", 70.0, 1e4)]
)
def test_frictionless_laminates_follow_the_law(umat, layup, temperature, fibre):
    """Fibres of 25 MPa stretch before the lock, which costs cross-ply laminates 2e-3 of width; stiff ones do not."""
    run = laminate(umat, layup, temperature, cells=1, settings={"E_L": fibre})
    run.finish()
    found = summary(run)
    assert found["thickness_ratio_final"] == pytest.approx(found["thickness_ratio_1d"], abs=3e-3)
    assert np.ptp(found["width_ratio_of_blocks"]) < 1e-6
    assert found["width_ratio_final"] == pytest.approx(found["width_ratio_1d"], abs=1e-3)
    assert found["increments"] <= 100


@pytest.mark.parametrize("temperature", [30.0, 70.0])
def test_friction_holds_the_outer_blocks_and_cold_plies_that_snap_stop_nothing(umat, short, temperature):
    run = laminate(umat, cells=4, temperature=temperature, friction=0.05, load=short)
    run.finish()
    outer, inner, inner_too, outer_too = run.course.rows[-1][4:]
    assert outer < inner - 5e-4
    assert (outer, inner) == pytest.approx((outer_too, inner_too), abs=1e-4)
    assert run.course.rows[-1][2] == 1.0
    assert run.course.increments <= 60


def test_work_of_the_plate_is_stored_dissipated_or_rubbed_away(umat, short):
    """Of first order in the increments; 16 times as many bring it below 1e-3."""
    gaps = []
    for refine in (4.0, 16.0):
        run = laminate(umat, cells=1, friction=0.05, load=short, refine=refine)
        run.finish()
        work = works(run)
        gaps.append(abs(work["plate"] - work["stored"] - work["dissipated"] - work["friction"]) / work["plate"])
        assert work["friction"] > 0.03 * work["plate"]
    assert gaps[1] < 0.5 * gaps[0]
    assert gaps[1] < 1e-3


def test_arms_hold_the_edges_and_widen_with_the_plies(umat, short):
    found = {}
    for arms in (0.0, 7.5):
        run = laminate(umat, cells=1, load=short, arms=arms)
        run.finish()
        found[arms] = run
    with_arms = found[7.5].model
    assert with_arms.volumes.sum() == pytest.approx(2.0 * found[0.0].model.volumes.sum())
    places = with_arms.specimen.mesh.points + with_arms.displacement(found[7.5].state.unknowns)
    assert places[:, 0].max() > 15.0 - 1e-3
    assert found[7.5].course.rows[-1][1] > found[0.0].course.rows[-1][1] + 1e-3


def test_a_run_that_cannot_go_on_says_where_and_goes_on_from_its_file(umat, short, tmp_path, monkeypatch):
    run = laminate(umat, cells=1, load=short, folder=tmp_path)

    def fail(time: float, increment: int, locked: float) -> None:
        if increment == 5:
            monkeypatch.setattr("plyflow.hosts.laminate.equilibrium.ITERATIONS", 1)

    with pytest.raises(RunError, match=rf"stopped at .* of 60 s: not converged after 1 .*{CHECKPOINT}"):
        run.finish(fail)
    monkeypatch.undo()
    again = laminate(umat, cells=1, load=short, folder=tmp_path)
    assert again.course.increments == 5
    again.finish()
    assert again.state.time == 60.0


@pytest.mark.parametrize("every", [0.0, 1e9])
def test_a_run_goes_on_from_its_checkpoint_and_ends_the_same(umat, short, tmp_path, every, monkeypatch):
    monkeypatch.setattr("plyflow.hosts.laminate.run.EVERY", every)
    whole = laminate(umat, cells=1, load=short, friction=0.05)
    whole.finish()
    broken = laminate(umat, cells=1, load=short, friction=0.05, folder=tmp_path)

    def stop(time: float, increment: int, locked: float) -> None:
        if time > 2.0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        broken.finish(stop)
    again = laminate(umat, cells=1, load=short, friction=0.05, folder=tmp_path)
    assert again.course.increments > 0
    again.finish()
    assert again.course.rows == whole.course.rows
    assert set(result_files(again)) >= {"result.json", "history.csv", "thickness.svg", "laminate_000.vtu", "laminate.pvd"}
    with pytest.raises(InputError, match="belongs to another run"):
        laminate(umat, cells=1, load=short, friction=0.1, folder=tmp_path)
    (tmp_path / CHECKPOINT).write_bytes(b"no archive")
    with pytest.raises(InputError, match="is no checkpoint"):
        laminate(umat, cells=1, load=short, friction=0.05, folder=tmp_path)


@pytest.mark.parametrize(
    ("text", "layup", "angles"),
    [
        (None, "BP", (90.0, 0.0, 90.0, 0.0)),
        ("[90_4/0_4]_2", "BP", (90.0, 0.0, 90.0, 0.0)),
        ("45,-45", "SB", (45.0, -45.0)),
        ("[90_2/0_2]", "CP", (90.0, 90.0, 0.0, 0.0)),
    ],
)
def test_stacks(text, layup, angles):
    assert stack_angles(text, layup) == angles


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--cells", "0"), "at least one element"),
        (("--friction", "-0.1"), "at least 0"),
        (("--arms", "-1"), "a length in mm of at least 0"),
        (("--arms", "5", "--stack", "45,-45"), "leave the arms out"),
        (("--load", "PULL"), "the sign reversed"),
        (("--load", "REST"), "a force above 0"),
        (("--stack", "[90/0]_8"), "no whole number of blocks"),
        (("--stack", "across"), "write directions in degrees"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(options, said, tmp_path, capsys):
    loads = {"PULL": "time [s],force [N]\n0,0\n1,20\n2,-5\n", "REST": "time [s],force [N]\n0,0\n1,0\n"}
    for name, text in loads.items():
        (tmp_path / f"{name}.csv").write_text(text)
    given = [str(tmp_path / f"{option}.csv") if option in loads else option for option in options]
    base = ["laminate", "--material", "IM7-8552", "--temperature", "70", "--layup", "BP", "-o", str(tmp_path / "out")]
    assert main([*base, *given]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_the_command_prints_json_and_writes_its_files(short, tmp_path, capsys):
    options = ["--material", "IM7-8552", "--temperature", "70", "--layup", "BP", "--cells", "1", "--load", short, "--json"]
    assert main(["laminate", *options, "-o", str(tmp_path / "out")]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {"thickness_ratio_final", "thickness_ratio_1d", "width_ratio_of_blocks", "lock_time_last", "provenance"} <= set(found)
    assert (tmp_path / "out" / "laminate.pvd").is_file()
