"""CalculiX with external materials, built once and kept in the user's cache; the scene bdf1 and its face."""

from __future__ import annotations

from pathlib import Path

import pytest

from plyflow.hosts.calculix.build import ensure_ccx
from plyflow.hosts.calculix.checks import Material
from plyflow.hosts.calculix.faces import Face, native_face
from plyflow.umat.prepare import prepare_umat
from umatgen.scene import SCENES


@pytest.fixture(scope="session")
def ccx() -> Path:
    """The program; built if need be, which takes some minutes."""
    return ensure_ccx()


@pytest.fixture(scope="session")
def material() -> Material:
    """The scene with its default constants."""
    return Material.of(prepare_umat("bdf1"))


@pytest.fixture(scope="session")
def native() -> Face:
    return native_face(SCENES["bdf1"])
