"""Local frames: what Abaqus passes with *ORIENTATION (a basis that turns with the material) beside the global form.

The physical answer has to be the same to 1e-12 at rotations up to 180 degrees with shear; a routine that mixes in what
turns (DROT, or the rotation of F itself) would not give it.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import polar

from calculix.door import bond
from plyflow.diagnose.library import load_umat
from plyflow.driver.drive import COMPONENTS, Controls, History, Step, drive
from plyflow.umat.library import UmatLibrary
from plyflow.umat.prepare import Umat, prepare_umat

Array = NDArray[np.float64]
AGREE = 1e-12
STATES = 10
# A routine that keeps a spatial direction: right in neither frame, and different in the two.
SPATIAL_FIBRE = """
      SUBROUTINE UMAT(STRESS,STATEV,DDSDDE,SSE,SPD,SCD,RPL,DDSDDT,
     1 DRPLDE,DRPLDT,STRAN,DSTRAN,TIME,DTIME,TEMP,DTEMP,PREDEF,DPRED,
     2 CMNAME,NDI,NSHR,NTENS,NSTATV,PROPS,NPROPS,COORDS,DROT,PNEWDT,
     3 CELENT,DFGRD0,DFGRD1,NOEL,NPT,LAYER,KSPT,JSTEP,KINC)
      INCLUDE 'ABA_PARAM.INC'
      CHARACTER*80 CMNAME
      DIMENSION STRESS(NTENS),STATEV(*),DDSDDE(NTENS,NTENS),
     1 DDSDDT(NTENS),DRPLDE(NTENS),STRAN(NTENS),DSTRAN(NTENS),TIME(2),
     2 PREDEF(1),DPRED(1),PROPS(NPROPS),COORDS(3),DROT(3,3),
     3 DFGRD0(3,3),DFGRD1(3,3),JSTEP(4)
      DDSDDE = 0.D0
      STRESS = 0.D0
      B11 = SUM(DFGRD1(1,:)**2)
      STRESS(1) = PROPS(1)*(B11 - 1.D0)
      DDSDDE(1,1) = 2.D0*PROPS(1)*B11
      DO I = 2, NTENS
        DDSDDE(I,I) = PROPS(1)
      END DO
      END
"""


def turn(axis: tuple[float, float, float], degrees: float) -> Array:
    """Rotation about an axis."""
    n = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def path(degrees: float, increments: int = 12) -> list[Array]:
    """Compaction, shear in all planes and rotation: F is not symmetric anywhere on the way."""
    shear = np.array([[0.0, 0.02, -0.03], [0.0, 0.03, 0.04], [0.0, 0.0, -0.03]])
    return [
        turn((1.0, 2.0, -0.5), degrees * s) @ (np.eye(3) + s * shear) for s in np.linspace(0.0, 1.0, increments + 1)[1:]
    ]


def steps(gradients: list[Array]) -> list[Step]:
    """One step and increment for each gradient."""
    return [Step(0.5, {name: float(f[int(name[0]) - 1, int(name[1]) - 1]) for name in COMPONENTS}) for f in gradients]


def driven(library: UmatLibrary, props: list[float], n_statev: int, degrees: float, corotated: bool) -> History:
    controls = Controls(0.5, 0.5, 0.5)
    return drive(library, props, n_statev, steps(path(degrees)), controls, corotated=corotated)


@pytest.fixture(scope="module")
def umat() -> Umat:
    return prepare_umat()


@pytest.fixture(scope="module")
def props(umat: Umat) -> list[float]:
    """Defaults, but a viscosity at which the rounding of F, times the fibre's modulus, is below 1e-12 of the stress."""
    changes = {"kappa": 10.0, "b_squeeze": -9.93}
    return [changes.get(row["name"], float(row["default"])) for row in umat.manifest["props"]]


@pytest.mark.parametrize("degrees", [0.0, 30.0, 90.0, 179.0, 180.0])
def test_both_frames_give_the_same_stress_and_state(degrees: float, umat: Umat, props: list[float]) -> None:
    plain, local = (driven(umat.library, props, STATES, degrees, corotated) for corotated in (False, True))
    assert plain.completed, plain.message
    assert local.completed, local.message
    assert np.abs(plain.stress - local.stress).max() < AGREE * np.abs(plain.stress).max()
    scale = np.abs(plain.statev).max(axis=0)
    scale[5] = np.abs(plain.stress).max()
    assert (np.abs(plain.statev - local.statev).max(axis=0) <= AGREE * scale).all()
    assert (plain.deformation_gradient == local.deformation_gradient).all()


@pytest.mark.parametrize("degrees", [90.0, 180.0])
def test_with_the_constants_as_shipped_both_frames_agree_too(degrees: float, umat: Umat) -> None:
    values = [float(row["default"]) for row in umat.manifest["props"]]
    plain, local = (driven(umat.library, values, STATES, degrees, corotated) for corotated in (False, True))
    assert plain.completed and local.completed
    assert np.abs(plain.stress - local.stress).max() < AGREE * np.abs(plain.stress).max()


def test_a_rotation_by_180_degrees_in_one_increment_changes_nothing_but_the_basis(
    umat: Umat, props: list[float]
) -> None:
    straight, turned = path(0.0), path(0.0)
    q = turn((0.3, -1.0, 0.4), 180.0)
    turned[-1] = q @ turned[-1]
    ends = []
    for gradients in (straight, turned):
        for corotated in (False, True):
            history = drive(umat.library, props, STATES, steps(gradients), Controls(0.5, 0.5, 0.5), corotated=corotated)
            assert history.completed, history.message
            ends.append((history.stress[-1], history.statev[-1]))
    scale = np.abs(ends[0][0]).max()
    for number, (stress, state) in enumerate(ends):
        expected = bond(q) @ ends[0][0] if number >= 2 else ends[0][0]
        assert np.abs(stress - expected).max() < 2 * AGREE * scale
        assert state == pytest.approx(ends[0][1], rel=1e-10, abs=1e-10 * scale)


@pytest.mark.parametrize("degrees", [30.0, 180.0])
def test_free_components_find_the_same_place_in_both_frames(degrees: float, umat: Umat, props: list[float]) -> None:
    """Mixed control after a rotation: Newton's method with DDSDDE from either frame."""
    pressed = Step(2.0, {"22": 0.0, "33": 0.4}, {"22": "S", "33": "P"})
    turned = steps([turn((1.0, 0.0, 0.0), degrees * s) for s in np.linspace(0.0, 1.0, 7)[1:]])
    histories = [
        drive(umat.library, props, STATES, [*turned, pressed], Controls(0.2, 1e-6, 0.5), corotated=corotated)
        for corotated in (False, True)
    ]
    assert all(history.completed for history in histories)
    plain, local = histories
    assert abs(plain.increments - local.increments) <= 1
    assert np.abs(plain.deformation_gradient[-1] - local.deformation_gradient[-1]).max() < 1e-7


def test_the_tangent_of_the_local_basis_is_the_global_one_turned(umat: Umat, props: list[float]) -> None:
    """Deformed state, non-symmetric F, unsymmetric DDSDDE."""
    for begin, end in pairwise(path(180.0)):
        r0, r1 = (polar(f)[0] for f in (begin, end))
        plain = umat.library.call(begin, end, 0.5, props, np.zeros(STATES))
        local = umat.library.call(r0.T @ begin, r1.T @ end, 0.5, props, np.zeros(STATES))
        turned = bond(r1) @ local.ddsdde @ bond(r1).T
        scale = np.abs(plain.ddsdde).max()
        assert np.abs(end - end.T).max() > 1e-3
        assert np.abs(plain.ddsdde - plain.ddsdde.T).max() > 1e-4 * scale
        assert np.abs(plain.ddsdde - turned).max() < AGREE * scale
        assert np.abs(plain.stress - bond(r1) @ local.stress).max() < AGREE * np.abs(plain.stress).max()


def test_a_routine_that_keeps_a_spatial_direction_differs_in_the_two_frames(tmp_path: Path) -> None:
    source = tmp_path / "spatial.f"
    source.write_text(SPATIAL_FIBRE)
    library = load_umat(source)
    plain, local = (driven(library, [1.0], 0, 90.0, corotated) for corotated in (False, True))
    assert np.abs(plain.stress - local.stress).max() > 0.1 * np.abs(plain.stress).max()
