"""Both doors return S and dS/dE of the UMAT's Cauchy stress and DDSDDE, and have an outcome where that has none."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from calculix.doors import AdapterDoor, Array, NativeDoor, bond, pulled_back
from plyflow.hosts.calculix.checks import Material
from plyflow.hosts.calculix.faces import Face, native_face
from plyflow.umat.prepare import prepare_umat
from umatgen.scene import SCENES

DT = 0.5
ZERO = np.zeros(8)
Door = Callable[..., object]


def state_pair(seed: int, size: float = 0.05) -> tuple[Array, Array]:
    """Deformation gradients of a start and an end in general position, far from the lock, turned by any angle."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    start = np.diag([1.0, 1.02, 0.985]) + 0.005 * rng.standard_normal((3, 3))
    return turn @ start, turn @ (np.eye(3) + size * 0.02 * rng.standard_normal((3, 3))) @ start


@pytest.fixture(scope="session")
def material(material: Material) -> Material:
    """With a penalty so low that it does not hide the other parts of stress and stiffness."""
    return material.with_values(kappa=1.0)


@pytest.fixture(scope="session")
def native_door(native: Face) -> NativeDoor:
    return NativeDoor(native.path)


@pytest.fixture(scope="session")
def adapter_door(adapter: Face) -> AdapterDoor:
    return AdapterDoor(adapter.path)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("door", ["native_door", "adapter_door"])
def test_stress_and_stiffness_are_the_umats_pulled_back(
    door: str, seed: int, material: Material, request: pytest.FixtureRequest
) -> None:
    f0, f1 = state_pair(seed)
    umat = material.library.call(f0, f1, DT, material.values, ZERO)
    stress, stiffness = pulled_back(f1, umat.stress, umat.ddsdde)
    answer = request.getfixturevalue(door)(f0, f1, DT, material.values, ZERO)
    # Rounding, times the condition of the push-forward.
    assert np.abs(answer.stress - stress).max() < 1e-10 * np.abs(stress).max()
    assert np.abs(answer.stiffness - stiffness).max() < 1e-11 * np.abs(stiffness).max()
    assert answer.state == pytest.approx(umat.statev, rel=1e-9, abs=1e-12 * np.abs(umat.stress).max())
    assert answer.pnewdt == -1.0


def test_the_comparison_sees_a_missing_rotation(material: Material) -> None:
    f0, f1 = state_pair(3)
    umat = material.library.call(f0, f1, DT, material.values, ZERO)
    right, wrong = (pulled_back(f, umat.stress, umat.ddsdde) for f in (f1, f1 @ one_degree()))
    assert np.abs(right[0] - wrong[0]).max() > 1e-3 * np.abs(right[0]).max()


def one_degree() -> Array:
    """A rotation by one degree."""
    c, s = np.cos(np.pi / 180), np.sin(np.pi / 180)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize("name", ["paper", "symmetric", "augmented", "blend", "squeeze", "viscous", "multiplier"])
def test_every_scene_with_a_native_face_returns_the_umats_stress_and_stiffness(name: str) -> None:
    umat, door = prepare_umat(name), NativeDoor(native_face(SCENES[name]).path)
    props = [1.0 if row["name"] == "kappa" else float(row["default"]) for row in umat.manifest["props"]]
    state = np.zeros(len(umat.manifest["statev"]))
    f0, f1 = state_pair(5)
    given = umat.library.call(f0, f1, DT, props, state)
    stress, stiffness = pulled_back(f1, given.stress, given.ddsdde)
    answer = door(f0, f1, DT, np.array(props), state)
    assert not given.messages
    assert np.abs(answer.stress - stress).max() < 1e-10 * np.abs(stress).max()
    assert np.abs(answer.stiffness - stiffness).max() < 1e-11 * np.abs(stiffness).max()


def test_stiffness_is_there_also_when_only_stress_is_asked_for(native_door: NativeDoor, material: Material) -> None:
    f0, f1 = state_pair(1)
    full, stress_only = (native_door(f0, f1, DT, material.values, ZERO, icmd=icmd) for icmd in (0, 3))
    assert (full.stiffness == stress_only.stiffness).all()


@pytest.mark.parametrize(
    ("system", "basis"),
    [
        ([0, 2, 0, -1, 1, 0, 1], [[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
        # Cylindrical about axis 3 through the origin, at the point (1, 2, 3).
        ([0, 0, 0, 0, 0, 5, -1], [[1 / 5**0.5, -2 / 5**0.5, 0], [2 / 5**0.5, 1 / 5**0.5, 0], [0, 0, 1]]),
    ],
)
def test_an_orientation_turns_the_fibre(
    system: list[float], basis: list[list[float]], native_door: NativeDoor, material: Material
) -> None:
    q = np.array(basis, dtype=float)
    f0, f1 = state_pair(2)
    plain = native_door(f0 @ q, f1 @ q, DT, material.values, ZERO)
    turned = native_door(f0, f1, DT, material.values, ZERO, orientation=np.array(system, dtype=float))
    assert np.abs(turned.stress - bond(q) @ plain.stress).max() < 1e-10 * np.abs(plain.stress).max()
    expected = bond(q) @ plain.stiffness @ bond(q).T
    assert np.abs(turned.stiffness - expected).max() < 1e-11 * np.abs(expected).max()
    assert np.abs(turned.stress - plain.stress).max() > 1e-3 * np.abs(plain.stress).max()


def test_an_increment_across_the_lock_asks_for_the_part_that_lands_on_it(
    native_door: NativeDoor, adapter_door: AdapterDoor, material: Material
) -> None:
    f0, f1 = np.diag([1.0, 1.02, 1 / 1.02]), np.diag([1.0, 1.1, 1 / 1.1])
    wanted = material.library.call(f0, f1, DT, material.values, ZERO).pnewdt
    assert 0.0 < wanted < 1.0
    for door in (native_door, adapter_door):
        assert door(f0, f1, DT, material.values, ZERO).pnewdt == pytest.approx(wanted, rel=1e-12)
        assert door(f0, f1, DT, material.values, ZERO, pnewdt=0.1).pnewdt == 0.1


@pytest.mark.parametrize("end", [np.diag([1.0, 1.0, -0.5]), np.diag([1.0, 1.0, 0.01]), np.full((3, 3), np.nan)])
def test_an_end_that_has_no_stress_cuts_and_leaves_finite_numbers_and_the_state(
    end: Array, native_door: NativeDoor, adapter_door: AdapterDoor, material: Material
) -> None:
    start = np.diag([1.0, 1.01, 1 / 1.01])
    state = np.arange(8) / 10.0
    state[4] = 0.0
    for door in (native_door, adapter_door):
        answer = door(start, end, DT, material.values, state)
        assert 0.0 < answer.pnewdt < 1.0
        assert np.isfinite(answer.stress).all()
        assert np.isfinite(answer.stiffness).all()
        assert np.abs(answer.stiffness).max() > 0.0
        assert answer.state == pytest.approx(state)


def test_the_linear_guess_has_the_same_stiffness_whatever_its_end(native_door: NativeDoor, material: Material) -> None:
    start = np.diag([1.0, 1.01, 1 / 1.01])
    ends = (start, np.diag([1.0, 1.0, -0.5]), np.diag([1.0, 1.2, 0.8]))
    answers = [native_door(start, end, DT, material.values, ZERO, ielas=1) for end in ends]
    for answer in answers:
        assert (answer.stiffness == answers[0].stiffness).all()
        assert answer.pnewdt == -1.0
        assert (answer.state == ZERO).all()
    at_rest = native_door(start, start, DT, material.values, ZERO)
    # At rest the stiffness is that of the rate floor.
    assert np.abs(at_rest.stiffness[5, 5]) > 1e4 * np.abs(answers[0].stiffness[5, 5])


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ("props[:-1]", "CONSTANTS= does not fit this scene: NPROPS value 1.600000E+01"),
        ("state[:3]", "DEPVAR is too small"),
    ],
)
def test_a_deck_that_does_not_fit_ends_the_analysis_with_the_reason(
    change: str, said: str, native: Face, material: Material
) -> None:
    program = f"""
import numpy as np
from pathlib import Path
from calculix.doors import NativeDoor
props, state = np.array({list(material.values)!r}), np.zeros(8)
{change.partition("[")[0]} = {change}
NativeDoor(Path({str(native.path)!r}))(np.eye(3), np.eye(3), 1.0, props, state)
print("still here")
"""
    tests = Path(__file__).resolve().parents[1]
    answer = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=tests)
    assert answer.returncode == 201
    assert said in answer.stdout
    assert "still here" not in answer.stdout
