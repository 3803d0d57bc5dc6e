"""The generic function returns the UMAT's stress in each measure and its exact derivative, and says what it cannot do."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mgis.door import SYMMETRIC, Answer, Array, Door, mandel
from plyflow.cli import main
from plyflow.hosts.mgis.behaviour import behaviour_of, compiled
from plyflow.umat.prepare import Umat, prepare_umat

DT = 0.5
MEASURES = {"Cauchy": 0, "second Piola-Kirchhoff": 1, "first Piola-Kirchhoff": 2}
STEP = 1e-6


def constants(umat: Umat, **changes: float) -> list[float]:
    """Defaults with a penalty that does not hide the other parts."""
    values = {row["name"]: float(row["default"]) for row in umat.manifest["props"]} | {"kappa": 1.0} | changes
    return [values[row["name"]] for row in umat.manifest["props"]]


def states(seed: int, plane: bool = False) -> tuple[Array, Array]:
    """Start and end in general position, turned by any angle."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    mask = np.array([[1, 1, 0], [1, 1, 0], [0, 0, 1]]) if plane else np.ones((3, 3))
    turn = np.eye(3) if plane else turn * np.sign(np.linalg.det(turn))
    start = np.diag([1.0, 1.02, 0.985]) + 0.005 * rng.standard_normal((3, 3)) * mask
    return turn @ start, turn @ (np.eye(3) + 0.001 * rng.standard_normal((3, 3)) * mask) @ start


def tensor(stress: Array) -> Array:
    full = np.zeros((3, 3))
    for value, (i, j) in zip(stress, SYMMETRIC, strict=False):
        full[i, j] = full[j, i] = value
    return full


def expected(measure: int, f: Array, stress: Array, door: Door) -> Array:
    """Components of the Cauchy stress in the host's measure."""
    sigma, inverse = tensor(stress), np.linalg.inv(f)
    if measure == 0:
        return mandel(sigma, door.short)
    first = np.linalg.det(f) * sigma @ inverse.T
    return mandel(inverse @ first, door.short) if measure == 1 else np.array([first[i, j] for i, j in door.full])


def by_differences(door: Door, f0: Array, f1: Array, values: list[float], state: Array, operator: int) -> Array:
    """D sigma/dF, dS/dE or dP/dF from the door's own stress."""
    columns = []
    for i, j in door.short if operator == 1 else door.full:
        change = np.zeros((3, 3))
        if operator == 1:
            change[i, j] = change[j, i] = 1.0 if i == j else 1.0 / np.sqrt(2.0)
            change = np.linalg.inv(f1).T @ change
        else:
            change[i, j] = 1.0
        above, below = (
            door(f0, f1 + sign * STEP * change, DT, values, state, wanted=0.0, measure=operator).forces for sign in (1, -1)
        )
        columns.append((above - below) / (2.0 * STEP))
    return np.array(columns).T


def differences(door: Door, umat: Umat, seed: int, operator: int, plane: bool = False) -> tuple[float, float]:
    """Relative differences of stress (from the UMAT's) and operator (from differences)."""
    (f0, f1), values, state = states(seed, plane), constants(umat), np.zeros(len(umat.manifest["statev"]))
    answer = door(f0, f1, DT, values, state, measure=operator, operator=operator)
    own = umat.library.call(f0, f1, DT, values, state, ntens=umat.manifest["ntens"], increment=2)
    wanted, slopes = expected(operator, f1, own.stress, door), by_differences(door, f0, f1, values, state, operator)
    assert answer.outcome == 1
    assert (answer.state == own.statev).all()
    assert (answer.energies == [own.sse, own.spd + own.scd]).all()
    stress, tangent = np.abs(answer.forces - wanted).max(), np.abs(answer.operator - slopes).max()
    return float(stress / np.abs(wanted).max()), float(tangent / np.abs(slopes).max())


# Rounding through the condition of F; central differences of a smooth stress with a step of 1e-6 of a rate of 1e-3.
STRESS, TANGENT = 1e-12, 1e-5


@pytest.mark.parametrize("operator", MEASURES.values(), ids=MEASURES)
@pytest.mark.parametrize("scene", ["bdf1", "default", "plane"])
def test_each_stress_and_operator_is_the_umats(scene: str, operator: int) -> None:
    behaviour, umat = behaviour_of(scene), prepare_umat(scene)
    plane = scene == "plane"
    door = Door(compiled(behaviour), behaviour.name, "PlaneStrain" if plane else "Tridimensional")
    for seed in range(3):
        stress, tangent = differences(door, umat, seed, operator, plane)
        assert stress < STRESS
        assert tangent < TANGENT


@pytest.mark.parametrize(
    ("right", "wrong", "operator"),
    [
        ("i < 3 ? 1.0 : ROOT_2", "1.0", 1),  # shears without sqrt 2
        ("(&left[0][0])[i] - (&right[0][0])[i]", "0.0", 0),  # no Jaumann terms
        ("K[i * columns + k] = change[i]", "K[k * rows + i] = change[i]", 0),  # stored by columns
        ("if (operator == CAUCHY)\n", "if (0)\n", 0),  # Kirchhoff's derivative over J
    ],
)
def test_a_wrong_operator_is_seen(right: str, wrong: str, operator: int) -> None:
    behaviour, umat = behaviour_of("bdf1"), prepare_umat("bdf1")
    text = behaviour.files["generic_behaviour.h"]
    assert text.count(right) == 1
    altered = replace(behaviour, files=dict(behaviour.files) | {"generic_behaviour.h": text.replace(right, wrong)})
    assert max(differences(Door(compiled(altered), altered.name), umat, 1, operator)) > 10.0 * TANGENT


def test_the_metadata_are_the_manifests(bdf1: Door) -> None:
    manifest = prepare_umat("bdf1").manifest
    assert bdf1.names("MaterialProperties") == [row["name"] for row in manifest["props"]]
    assert bdf1.names("InternalStateVariables") == [*(row["name"] for row in manifest["statev"]), "last_gradient"]
    assert [bdf1.number(one) for one in ("api_version", "BehaviourType", "BehaviourKinematic", "SymmetryType")] == [1, 2, 3, 1]


def fresh(door: Door, wanted: float, f1: Array | None = None, **options: int) -> Answer:
    umat, (f0, end) = prepare_umat("bdf1"), states(2)
    return door(f0, end if f1 is None else f1, DT, constants(umat), np.zeros(8), wanted=wanted, **options)


def test_without_a_wish_for_it_no_operator_is_made(bdf1: Door) -> None:
    stress_alone, both = fresh(bdf1, 0.0), fresh(bdf1, 4.0)
    assert (stress_alone.forces == both.forces).all()
    assert np.abs(stress_alone.operator).max() == 0.0 < np.abs(both.operator).max()


def test_a_prediction_is_the_operator_at_the_start_and_leaves_the_rest(bdf1: Door) -> None:
    predicted, at_rest = fresh(bdf1, -4.0), fresh(bdf1, 4.0, states(2)[0])
    assert predicted.outcome == 1
    assert (predicted.operator == at_rest.operator).all()
    assert np.isnan(predicted.state).all()
    assert (predicted.forces == 0.0).all()


@pytest.mark.parametrize(
    ("wanted", "end", "options", "said"),
    [
        (4.0, np.diag([1.0, 1.0, -0.5]), {}, "J at the end of the increment must be positive"),
        (4.0, np.diag([1.0, 1.0, 0.01]), {}, "compaction limit"),
        (104.0, None, {}, "no speed of sound"),
        (4.0, None, {"operator": 3}, "K[2] is 0, 1, 2"),
        (4.0, None, {"measure": 3}, "K[1] is 0, 1, 2"),
    ],
)
def test_what_cannot_be_done_is_said_and_leaves_state_and_stress(
    wanted: float, end: Array | None, options: dict[str, int], said: str, bdf1: Door
) -> None:
    answer = fresh(bdf1, wanted, end, **options)
    assert answer.outcome == -1
    assert said in answer.message
    assert np.isnan(answer.state).all()
    assert (answer.forces == 0.0).all()
    assert answer.ratio == (0.25 if end is not None else 1.0)


def test_the_start_is_where_the_point_was_not_what_the_host_says(bdf1: Door) -> None:
    """OpenGeoSys's F-bar scales the gradient of the start by the volume ratio of the end."""
    (f0, f1), values = states(2), constants(prepare_umat("bdf1"))
    told = [bdf1(start, f1, DT, values, np.zeros(8), kept=f0) for start in (f0, 1.01 * f0)]
    assert (told[0].forces == told[1].forces).all()
    undeformed = [bdf1(start, f1, DT, values, np.zeros(8), kept=kept) for start, kept in ((f0, np.zeros((3, 3))), (f0, np.eye(3)))]
    assert (undeformed[0].forces == undeformed[1].forces).all()
    assert np.abs(undeformed[0].forces - told[0].forces).max() > 1e-3 * np.abs(told[0].forces).max()


def test_a_local_frame_does_what_free_directions_do(bdf1: Door) -> None:
    """The symbols that turn gradients, stresses and operators, beside the scene with fibre and normal in PROPS."""
    free, umat = behaviour_of("free"), prepare_umat("free")
    (f0, f1), q = states(4), states(5)[0]
    q = np.linalg.qr(q)[0] * np.sign(np.linalg.det(q))
    directions = dict(zip(("n1", "n2", "n3", "m1", "m2", "m3"), [*q[:, 0], *q[:, 2]], strict=True))
    values, state = constants(umat, **directions), np.zeros(len(umat.manifest["statev"]))
    wanted = Door(compiled(free), free.name)(f0, f1, DT, values, state, measure=1, operator=1)
    door = Door(compiled(behaviour := behaviour_of("default")), behaviour.name)
    local = [door.turned("Gradients", np.array([f[i, j] for i, j in door.full]), q) for f in (f0, f1)]
    turned = []
    for components in local:
        full = np.zeros((3, 3))
        full[tuple(zip(*door.full, strict=True))] = components
        turned.append(full)
    answer = door(turned[0], turned[1], DT, values[:17], state, measure=1, operator=1)
    stress = door.turned("ThermodynamicForces_PK2Stress", answer.forces, q)
    operator = door.turned("TangentOperatorBlocks_dPK2_dEGL", answer.operator, q)
    # Rounding of the turns, carried by a rate of 1e-3.
    assert np.abs(stress - wanted.forces).max() < 1e-11 * np.abs(wanted.forces).max()
    assert np.abs(operator - wanted.operator).max() < 1e-11 * np.abs(wanted.operator).max()


def test_the_command_writes_library_and_sources(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mgis", "bdf1", "-o", str(tmp_path)]) == 0
    written = {"libPlyflowBdf1.so", "PlyflowBdf1.c", "generic_behaviour.h", "bdf1.for", "abaqus_standins.f90"}
    assert {Path(line).name for line in capsys.readouterr().out.split()} == written == {p.name for p in tmp_path.iterdir()}


def test_a_scene_without_a_tangent_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mgis", "stressonly"]) == 2
    assert "has no tangent" in capsys.readouterr().err
