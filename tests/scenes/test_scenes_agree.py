"""Every shipped scene agrees with the default one on what it kept, and refuses what it left out."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from plyflow.umat.compile import compile_umat, generate_cached
from plyflow.umat.library import CallResult, UmatLibrary
from umatgen.scene import SCENES, Scene

Array = NDArray[np.float64]
IN_PLANE = [0, 1, 2, 3]
TOLERANCE = 1e-13
CONSTANTS = dict(SCENES["baked"].baked)
# Scenes that a test of their own compares, because law, moduli or material frame differ.
OWN_TEST = {"viscous", "free", "fibre3", "printed"}
SAME_LAW = [name for name in SCENES if name not in OWN_TEST | {"default"}]
both_stages = pytest.mark.parametrize("locked", [False, True])


@cache
def library(scene: Scene) -> tuple[UmatLibrary, dict[str, Any]]:
    """Compiled scene and its manifest."""
    source, manifest, _ = generate_cached(scene)
    return UmatLibrary(compile_umat(source)), manifest


def call(scene: Scene, start: Array, end: Array, locked: bool, **constants: float) -> CallResult:
    """One call with the scene's own PROPS and STATEV, dt = 0.1 s, at 70 degC, where the constants belong."""
    umat, manifest = library(scene)
    values = CONSTANTS | constants
    props = [values[row["name"]] for row in manifest["props"]]
    state = [float(locked and row["name"] == "locked") for row in manifest["statev"]]
    return umat.call(start, end, 0.1, props, state, ntens=int(manifest["ntens"]), temperature=70.0)


def states(scene: Scene, locked: bool) -> list[tuple[Array, Array]]:
    """Pairs F0, F1 on the right side of the lock, fibre and ply normal where the scene has them.

    Without shear out of the plane for plane scenes.
    """
    generator = np.random.default_rng(7)
    order = np.ix_(*[np.argsort((1, 2, 3) if scene.free else scene.axes)] * 2)
    result = []
    for _ in range(5):
        start = np.diag([1.001, 1.16, 0.84] if locked else [1.001, 1.02, 0.98]) + 0.003 * generator.normal(size=(3, 3))
        start, step = start[order], 0.002 * generator.normal(size=(3, 3))[order]
        if scene.ntens == 4:
            for matrix in (start, step):
                matrix[[0, 1, 2, 2], [2, 2, 0, 1]] = 0.0
        result.append((start, start + step))
    return result


def inextensible(locked: bool) -> list[tuple[Array, Array]]:
    """Pairs with C11 = 1, no shear and, past the lock, C22 = chi_l: where the printed invariants are what they stand for."""
    width = float(np.exp(-CONSTANTS["eps_lock"]))
    pairs = []
    for end in [0.84, 0.81, 0.78] if locked else [0.985, 0.97, 0.95]:
        begin, finish = (np.diag([1.0, width if locked else 1 / c, c]) for c in (end + 2e-3, end))
        pairs.append((begin, finish))
    return pairs


def distance(have: Array, want: Array) -> float:
    """Largest difference over the largest entry."""
    return float(np.max(np.abs(have - want)) / np.max(np.abs(want)))


def distances(have: CallResult, want: CallResult) -> float:
    """The larger one of stress and DDSDDE."""
    assert have.messages == "" and want.messages == ""
    return max(distance(have.stress, want.stress), distance(have.ddsdde, want.ddsdde))


def reference(scene: Scene) -> Scene:
    """The default scene with the law of `scene`: same tangent, constraint and material axes, everything else kept."""
    tangent = "consistent" if scene.tangent == "none" else scene.tangent
    device = scene.incompressibility if scene.incompressibility != "none" else "penalty"
    kept = {"integrator": scene.integrator, "fibre": scene.fibre, "normal": scene.normal}
    return Scene(name="default", tangent=tangent, incompressibility=device, **kept)


def worst_difference(scene: Scene, locked: bool, plant: float = 1.0) -> float:
    """Largest difference of stress and DDSDDE to the reference, relative to their largest entries."""
    worst = 0.0
    kappa = {"kappa": 0.0} if scene.incompressibility == "none" else {}
    for start, end in states(scene, locked):
        have, want = (call(one, start, end, locked, **kappa) for one in (scene, reference(scene)))
        assert have.messages == "" and want.messages == ""
        keep = IN_PLANE if scene.ntens == 4 else list(range(6))
        worst = max(worst, distance(plant * have.stress, want.stress[keep]))
        if scene.tangent != "none":
            worst = max(worst, distance(plant * have.ddsdde, want.ddsdde[np.ix_(keep, keep)]))
    return worst


@pytest.mark.parametrize(("name", "stage"), [(n, stage) for n in SAME_LAW for stage in SCENES[n].kept_regimes])
def test_a_scene_agrees_with_the_default_on_what_it_kept(name: str, stage: str) -> None:
    assert worst_difference(SCENES[name], stage == "bleed") < TOLERANCE


def test_a_planted_difference_is_seen() -> None:
    assert worst_difference(SCENES["baked"], False, plant=1.0 + 1e-12) > TOLERANCE


@both_stages
def test_the_viscous_scene_is_the_default_with_vanishing_moduli(locked: bool) -> None:
    tiny = {"E_L": 1e-30, "E_T": 1e-30, "G_LT": 0.495e-30}
    for start, end in states(SCENES["viscous"], locked):
        assert distances(call(SCENES["viscous"], start, end, locked), call(Scene(), start, end, locked, **tiny)) < TOLERANCE


def basis(direction: Array) -> Array:
    """A right-handed orthonormal basis with `direction` first."""
    n = direction / np.linalg.norm(direction)
    other = np.cross(n, [0.3, -0.5, 0.8])
    other /= np.linalg.norm(other)
    return np.column_stack([n, other, np.cross(n, other)])


@pytest.mark.parametrize("direction", [[1, 0, 0], [0, 0, 1], [0, 0, -1], [1, 2, -0.5], [-3, 0.1, 1e-9]])
@both_stages
def test_a_free_fibre_and_normal_are_the_default_in_a_turned_material_frame(direction: list[float], locked: bool) -> None:
    turn = basis(np.array(direction, dtype=float))
    own = dict(zip(("n1", "n2", "n3", "m1", "m2", "m3"), map(float, [*direction, *turn[:, 2]]), strict=True))
    for start, end in states(Scene(), locked):
        have = call(SCENES["free"], start @ turn.T, end @ turn.T, locked, **own)
        # The turned input is itself rounded: compare at the rounding of F carried through, not at 1e-13.
        assert distances(have, call(Scene(), start, end, locked)) < 1e-10


@both_stages
def test_a_fibre_along_axis_3_is_the_default_with_the_material_axes_renamed(locked: bool) -> None:
    for start, end in states(Scene(), locked):
        # Columns in the order N, t, n; t turned about, so that the frame stays right-handed.
        have = call(SCENES["fibre3"], *(f[:, [2, 1, 0]] * [1, -1, 1] for f in (start, end)), locked)
        assert distance(have.stress, call(Scene(), start, end, locked).stress) < TOLERANCE


@both_stages
def test_the_printed_invariants_give_the_default_stress_where_they_are_real(locked: bool) -> None:
    for start, end in inextensible(locked):
        have, want = (call(scene, start, end, locked) for scene in (SCENES["printed"], SCENES["bdf1"]))
        assert have.messages == "" and want.messages == ""
        # (I1-1)^2 - 4 I3 loses digits to cancellation: those of the stretches' difference.
        lost = (np.trace(end) / (end[1, 1] - end[2, 2])) ** 2
        assert distance(have.stress, want.stress) < TOLERANCE * max(1.0, lost / 100)
    assert distance(have.stress * (1 + 1e-9), want.stress) > TOLERANCE * lost


@pytest.mark.parametrize(
    ("name", "locked", "message"),
    [("squeeze", True, "left out the bleeding stage"), ("bleed", False, "left out the squeezing stage")],
)
def test_a_scene_refuses_the_stage_it_left_out(name: str, locked: bool, message: str) -> None:
    start, end = states(SCENES[name], locked)[0]
    result = call(SCENES[name], start, end, locked)
    assert message in result.messages and result.stopped
    assert np.all(result.stress == 0.0)


def test_plane_stress_is_refused() -> None:
    umat, manifest = library(Scene())
    props = [row["default"] for row in manifest["props"]]
    result = umat.call(np.eye(3), np.eye(3), 0.1, props, np.zeros(8), ntens=3, ndi=2)
    assert "plane stress is not supported" in result.messages and result.stopped


def test_what_is_left_out_is_gone_from_the_source() -> None:
    lean, bleed, plane, viscous = (generate_cached(SCENES[name])[0] for name in ("lean", "bleed", "plane", "viscous"))
    assert all(word not in lean for word in ("_check", "energy", "dissipation +", "props("))
    assert "pf_bleed_squeeze(" not in bleed
    assert all(word not in plane for word in ("f1(1,3)", "f1(3,2)", "stress(5)", "b_left(6)"))
    assert "moduli" not in viscous


def test_internal_and_external_procedures_give_the_same_numbers() -> None:
    for start, end in states(Scene(), False):
        one, other = (call(replace(Scene(), procedures=kind), start, end, False) for kind in ("internal", "external"))
        assert np.allclose(one.stress, other.stress, rtol=1e-14, atol=0)
        assert np.allclose(one.ddsdde, other.ddsdde, rtol=1e-13)
