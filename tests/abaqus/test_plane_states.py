"""Plane strain, generalised plane strain, axisymmetry (NTENS = 4) beside NTENS = 6 held in the same way; no plane stress."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from plyflow.driver.drive import Controls, Step, drive
from plyflow.umat.compile import compile_umat, generate_cached
from plyflow.umat.library import CallResult, UmatLibrary
from umatgen.scene import SCENES, Scene

Array = NDArray[np.float64]
IN_PLANE = [0, 1, 2, 3]
AGREE = 1e-13
STATES = 10
INCREMENTS, DT = 30, 0.5
RADIUS, WIDTH = 20.0, 15.0  # mm
# F33 [-] at a part (0 to 1) of the path, for a stretch of the first axis.
CONSTRAINTS: dict[str, Callable[[float, float], float]] = {
    "plane strain": lambda part, stretch: 1.0,
    "generalised plane strain": lambda part, stretch: 1.0 + 0.004 * part,
    "axisymmetric": lambda part, stretch: 1.0 + (stretch - 1.0) * WIDTH / (RADIUS + WIDTH),
}
NORMALS = {"1": "2", "2": "1", "3": "2"}  # by the axis of the fibre


def library(scene: Scene) -> tuple[UmatLibrary, list[float]]:
    source, manifest, _ = generate_cached(scene)
    changes = {"kappa": 1.0}  # so low that it does not hide the rest
    props = [changes.get(row["name"], float(row["default"])) for row in manifest["props"]]
    return UmatLibrary(compile_umat(source)), props


def path(constraint: str, fibre: str) -> list[Array]:
    """Compaction across the fibre past the lock, with shear in the plane; axis 1 widens unless the fibre holds it."""
    gradients = []
    for part in np.linspace(0.0, 1.0, INCREMENTS + 1):
        f = np.eye(3)
        f[1, 1] = 1.0 - 0.20 * part
        f[0, 0] = min(1.0 / f[1, 1], 1.151)
        if fibre != "3":
            f[0, 0], f[1, 1] = (1.0 + 0.001 * part, f[1, 1]) if fibre == "1" else (1.0 - 0.20 * part, 1.0 + 0.001 * part)
        f[0, 1], f[1, 0] = 0.05 * part, -0.02 * part
        f[2, 2] = CONSTRAINTS[constraint](part, float(f[0, 0]))
        gradients.append(f)
    return gradients


def answers(scene: Scene, gradients: list[Array]) -> list[CallResult]:
    """Every increment of the path, the state carried from one to the next."""
    umat, props = library(scene)
    state, result = np.zeros(STATES), []
    for start, end in pairwise(gradients):
        result.append(umat.call(start, end, DT, props, state, ntens=scene.ntens))
        assert result[-1].messages == ""
        state = result[-1].statev
    return result


def difference(plane: list[CallResult], solid: list[CallResult]) -> float:
    """Largest difference of stress, DDSDDE and state along the path, relative to the largest of each."""
    worst = 0.0
    for one, other in zip(plane, solid, strict=True):
        block = other.ddsdde[np.ix_(IN_PLANE, IN_PLANE)]
        worst = max(
            worst,
            np.abs(one.stress - other.stress[IN_PLANE]).max() / np.abs(other.stress).max(),
            np.abs(one.ddsdde - block).max() / np.abs(block).max(),
            float((np.abs(one.statev - other.statev) / np.maximum(np.abs(other.statev), 1e-3)).max()),
        )
    return worst


def pair(fibre: str) -> tuple[Scene, Scene]:
    plane = replace(SCENES["plane"], name=f"plane_f{fibre}", fibre=fibre, normal=NORMALS[fibre])
    return plane, replace(plane, name=f"solid_f{fibre}", stress_state="3d")


@pytest.mark.parametrize("fibre", NORMALS)
@pytest.mark.parametrize("constraint", CONSTRAINTS)
def test_four_components_agree_with_six_under_the_same_constraint(constraint: str, fibre: str) -> None:
    plane, solid = pair(fibre)
    gradients = path(constraint, fibre)
    found = answers(plane, gradients), answers(solid, gradients)
    assert {result.statev[4] for result in found[0]} == {0.0, 1.0}
    assert difference(*found) < AGREE


def test_another_constraint_and_a_part_in_ten_to_the_twelve_of_the_strain_out_of_the_plane_are_seen() -> None:
    plane, solid = pair("3")
    gradients = path("plane strain", "3")
    changed = [f + 1e-12 * np.outer([0, 0, 1], [0, 0, 1]) for f in gradients]
    for other, bound in ((changed, AGREE), (path("generalised plane strain", "3"), 1e3 * AGREE)):
        assert difference(answers(plane, gradients), answers(solid, other)) > bound


@pytest.mark.parametrize("constraint", [1.0, 1.002])
def test_a_free_edge_is_found_by_both(constraint: float) -> None:
    """Plate along 2, edge along 1 free, the third axis held: Newton's method with 4 and with 6 components."""
    controls = Controls(initial_increment=0.05, minimum_increment=1e-9, maximum_increment=1.0)
    target = {"11": 0.0, "22": 0.2, "33": constraint, "12": 0.0}
    steps = [Step(10.0, target, {"11": "S", "22": "P"})]
    histories = []
    for scene in pair("3"):
        umat, props = library(scene)
        histories.append(drive(umat, props, STATES, steps, controls, ntens=scene.ntens))
    plane, solid = histories
    assert plane.completed and solid.completed, (plane.message, solid.message)
    assert plane.deformation_gradient[-1, 1, 1] < 0.9
    assert np.abs(plane.deformation_gradient[-1] - solid.deformation_gradient[-1]).max() < 1e-9


@pytest.mark.parametrize(
    ("scene", "ntens", "ndi", "said"),
    [
        *((name, 3, 2, "plane stress is not supported") for name in ("plane", "default", "inplane")),
        ("plane", 6, 3, "NTENS"),
        ("default", 4, 3, "NTENS"),
    ],
)
def test_plane_stress_and_elements_of_the_other_kind_end_the_analysis(scene: str, ntens: int, ndi: int, said: str) -> None:
    umat, props = library(SCENES[scene])
    result = umat.call(np.eye(3), np.eye(3), 0.1, props, np.zeros(STATES), ntens=ntens, ndi=ndi)
    assert result.stopped
    assert said in result.messages
