"""The native door returns S and dS/dE of the UMAT's Cauchy stress and DDSDDE, and has an outcome where that has none."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calculix.door import Array, NativeDoor, bond, pulled_back
from plyflow.hosts.calculix.checks import Material
from plyflow.hosts.calculix.faces import Face, native_face
from plyflow.umat.compile import compile_umat, generate_cached
from plyflow.umat.library import UmatLibrary
from umatgen.scene import SCENES

DT = 0.5
ZERO = np.zeros(8)
START = np.diag([1.0, 1.01, 1 / 1.01])
SCENES_WITH_FACE = ["paper", "symmetric", "augmented", "squeeze", "viscous", "multiplier"]


def state_pair(seed: int) -> tuple[Array, Array]:
    """Deformation gradients of a start and an end in general position, far from the lock, turned by any angle."""
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    start = np.diag([1.0, 1.02, 0.985]) + 0.005 * rng.standard_normal((3, 3))
    return turn @ start, turn @ (np.eye(3) + 0.001 * rng.standard_normal((3, 3))) @ start


@pytest.fixture(scope="session")
def material(material: Material) -> Material:
    """With a penalty so low that it does not hide the other parts of stress and stiffness."""
    return material.with_values(kappa=1.0)


@pytest.fixture(scope="session")
def door(native: Face) -> NativeDoor:
    return NativeDoor(native.path)


@pytest.mark.parametrize(("name", "seed"), [*(("bdf1", seed) for seed in range(12)), *((n, 5) for n in SCENES_WITH_FACE)])
def test_stress_and_stiffness_are_the_umats_pulled_back(name: str, seed: int) -> None:
    scene = replace(SCENES[name], integrator="bdf1")
    source, manifest, _ = generate_cached(scene)
    defaults = [float(row["default"]) for row in manifest["props"]]
    own = Material(manifest, defaults, UmatLibrary(compile_umat(source))).with_values(kappa=1.0)
    f0, f1 = state_pair(seed)
    umat = own.library.call(f0, f1, DT, own.values, np.zeros(own.n_statev))
    stress, stiffness = pulled_back(f1, umat.stress, umat.ddsdde)
    answer = NativeDoor(native_face(scene).path)(f0, f1, DT, own.values, np.zeros(own.n_statev))
    assert not umat.messages
    # Rounding, times the condition of the push-forward.
    assert np.abs(answer.stress - stress).max() < 1e-10 * np.abs(stress).max()
    assert np.abs(answer.stiffness - stiffness).max() < 1e-11 * np.abs(stiffness).max()
    assert answer.state == pytest.approx(umat.statev, rel=1e-9, abs=1e-12 * np.abs(umat.stress).max())
    assert answer.pnewdt == -1.0


def test_the_comparison_sees_a_missing_rotation(material: Material) -> None:
    (f0, f1), angle = state_pair(3), np.pi / 180
    umat = material.library.call(f0, f1, DT, material.values, ZERO)
    c, s = np.cos(angle), np.sin(angle)
    one_degree = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    right, wrong = (pulled_back(f, umat.stress, umat.ddsdde) for f in (f1, f1 @ one_degree))
    assert np.abs(right[0] - wrong[0]).max() > 1e-3 * np.abs(right[0]).max()


def test_stiffness_is_there_also_when_only_stress_is_asked_for(door: NativeDoor, material: Material) -> None:
    full, stress_only = (door(*state_pair(1), DT, material.values, ZERO, icmd=icmd) for icmd in (0, 3))
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
    system: list[float], basis: list[list[float]], door: NativeDoor, material: Material
) -> None:
    q, (f0, f1) = np.array(basis, dtype=float), state_pair(2)
    plain = door(f0 @ q, f1 @ q, DT, material.values, ZERO)
    turned = door(f0, f1, DT, material.values, ZERO, orientation=system)
    assert np.abs(turned.stress - bond(q) @ plain.stress).max() < 1e-10 * np.abs(plain.stress).max()
    expected = bond(q) @ plain.stiffness @ bond(q).T
    assert np.abs(turned.stiffness - expected).max() < 1e-11 * np.abs(expected).max()
    assert np.abs(turned.stress - plain.stress).max() > 1e-3 * np.abs(plain.stress).max()


def test_an_increment_across_the_lock_goes_through_and_a_wish_of_others_stays(door: NativeDoor, material: Material) -> None:
    f0, f1 = np.diag([1.0, 1.02, 1 / 1.02]), np.diag([1.0, 1.18, 1 / 1.18])
    umat = material.library.call(f0, f1, DT, material.values, ZERO)
    stress, _ = pulled_back(f1, umat.stress, umat.ddsdde)
    for wish in (-1.0, 0.1):
        answer = door(f0, f1, DT, material.values, ZERO, pnewdt=wish)
        assert np.abs(answer.stress - stress).max() < 1e-10 * np.abs(stress).max()
        assert (answer.pnewdt, answer.state[4]) == (wish, 1.0) == (wish, umat.statev[4])


@pytest.mark.parametrize("end", [np.diag([1.0, 1.0, -0.5]), np.diag([1.0, 1.0, 0.01]), np.full((3, 3), np.nan)])
def test_an_end_that_has_no_stress_cuts_and_leaves_finite_numbers_and_the_state(
    end: Array, door: NativeDoor, material: Material
) -> None:
    state = np.arange(8) / 10.0
    state[4] = 0.0
    answer = door(START, end, DT, material.values, state)
    assert 0.0 < answer.pnewdt < 1.0
    assert np.isfinite(answer.stress).all()
    assert np.isfinite(answer.stiffness).all()
    assert np.abs(answer.stiffness).max() > 0.0
    assert answer.state == pytest.approx(state)


def test_the_linear_guess_has_the_same_stiffness_whatever_its_end(door: NativeDoor, material: Material) -> None:
    ends = (START, np.diag([1.0, 1.0, -0.5]), np.diag([1.0, 1.2, 0.8]))
    answers = [door(START, end, DT, material.values, ZERO, ielas=1) for end in ends]
    for answer in answers:
        assert (answer.stiffness == answers[0].stiffness).all()
        assert answer.pnewdt == -1.0
        assert (answer.state == ZERO).all()
    at_rest = door(START, START, DT, material.values, ZERO)
    # At rest the stiffness is that of the rate floor.
    assert np.abs(at_rest.stiffness[5, 5]) > 1e4 * np.abs(answers[0].stiffness[5, 5])


@pytest.mark.parametrize(
    ("constants", "states", "said"),
    [(16, 8, "CONSTANTS= does not fit this scene: NPROPS value 1.600000E+01"), (17, 3, "DEPVAR is too small")],
)
def test_a_deck_that_does_not_fit_ends_the_analysis_with_the_reason(
    constants: int, states: int, said: str, native: Face, material: Material
) -> None:
    program = f"""
import numpy as np
from calculix.door import NativeDoor
NativeDoor({str(native.path)!r})(np.eye(3), np.eye(3), 1.0, {list(material.values)[:constants]!r}, np.zeros({states}))
print("still here")
"""
    tests = Path(__file__).resolve().parents[1]
    answer = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, cwd=tests)
    assert answer.returncode == 201
    assert said in answer.stdout
    assert "still here" not in answer.stdout
