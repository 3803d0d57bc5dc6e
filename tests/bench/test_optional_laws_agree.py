"""Scenes whose law differs somewhere from the default one agree with it to 1e-13 where it does not; none is forgotten."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from plyflow.umat.library import CallResult
from plyflow.umat.prepare import prepare_umat
from scenes import test_scenes_agree
from umatgen.scene import SCENES

Array = NDArray[np.float64]
TOLERANCE = 1e-13
CONSTANTS = dict(SCENES["baked"].baked)
# Scenes that tests/scenes compares by a test of their own, because law, moduli or material frame differ.
OWN_TEST = {
    "viscous": "test_the_viscous_scene_is_the_default_with_vanishing_moduli",
    "free": "test_a_free_fibre_direction_is_the_default_in_a_turned_material_frame",
    "fibre3": "test_a_fibre_along_axis_3_is_the_default_with_the_material_axes_renamed",
}
COMPARED_HERE = {"printed", "blend"}


def call(name: str, start: Array, end: Array, locked: bool) -> CallResult:
    """One call with the same constants in every scene; dt = 0.1 s, 70 degC."""
    umat = prepare_umat(name)
    props = [CONSTANTS[entry["name"]] for entry in umat.manifest["props"]]
    state: list[Any] = [float(locked and entry["name"] == "locked") for entry in umat.manifest["statev"]]
    return umat.library.call(start, end, 0.1, props, state, temperature=70.0)


def outside_the_window(locked: bool) -> list[tuple[Array, Array]]:
    """Pairs F0, F1 with shears, the compaction well on one side of the lock (a window of 1e-3 about -0.059)."""
    generator = np.random.default_rng(9)
    base = np.diag([1.001, 1.08, 0.90] if locked else [1.001, 1.02, 0.98])
    starts = [base + 0.003 * generator.normal(size=(3, 3)) for _ in range(5)]
    return [(start, start + 0.002 * generator.normal(size=(3, 3))) for start in starts]


def inextensible(locked: bool) -> list[tuple[Array, Array]]:
    """Pairs with C11 = 1, no shear and, past the lock, C22 = chi_l: where the printed invariants are what they stand for."""
    width = float(np.exp(-CONSTANTS["eps_lock"]))
    steps = [0.90, 0.87, 0.83] if locked else [0.985, 0.97, 0.95]
    pairs = []
    for end in steps:
        sizes = [(1.0, width if locked else 1 / c, c) for c in (end + 2e-3, end)]
        pairs.append((np.diag(sizes[0]), np.diag(sizes[1])))
    return pairs


def distance(have: Array, want: Array) -> float:
    """Largest difference over the largest entry."""
    return float(np.max(np.abs(have - want)) / np.max(np.abs(want)))


@pytest.mark.parametrize("locked", [False, True])
def test_the_blend_is_the_default_outside_its_window(locked: bool) -> None:
    for start, end in outside_the_window(locked):
        have, want = (call(name, start, end, locked) for name in ("blend", "default"))
        assert have.messages == "" and want.messages == ""
        assert distance(have.stress, want.stress) < TOLERANCE
        assert distance(have.ddsdde, want.ddsdde) < TOLERANCE


def test_inside_its_window_the_blend_differs() -> None:
    lock = float(np.exp(CONSTANTS["eps_lock"]))
    start, end = np.diag([1.0, 1 / lock, lock * 1.0004]), np.diag([1.0, 1 / lock, lock * 1.0001])
    assert distance(call("blend", start, end, False).stress, call("default", start, end, False).stress) > 1e-3


@pytest.mark.parametrize("locked", [False, True])
def test_the_printed_invariants_give_the_default_stress_where_they_are_real(locked: bool) -> None:
    for start, end in inextensible(locked):
        have, want = (call(name, start, end, locked) for name in ("printed", "default"))
        assert have.messages == "" and want.messages == ""
        # (I1-1)^2 - 4 I3 loses digits to cancellation: those of the stretches' difference.
        lost = (np.trace(end) / (end[1, 1] - end[2, 2])) ** 2
        assert distance(have.stress, want.stress) < TOLERANCE * max(1.0, lost / 100)
    assert distance(have.stress * (1 + 1e-9), want.stress) > TOLERANCE * lost


def forgotten(compared_at_once: set[str]) -> set[str]:
    """Scenes that no test compares with the default one."""
    own = {name for name, test in OWN_TEST.items() if callable(getattr(test_scenes_agree, test, None))}
    return set(SCENES) - {"default"} - compared_at_once - COMPARED_HERE - own


def test_no_scene_is_forgotten() -> None:
    at_once = set(test_scenes_agree.SAME_LAW)
    assert forgotten(at_once) == set()
    assert forgotten(at_once - {"squeeze"}) == {"squeeze"}
