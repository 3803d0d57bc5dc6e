"""CalculiX with external materials, built once and kept in the user's cache; the default scene and its faces."""

from __future__ import annotations

from pathlib import Path

import pytest

from plyflow.hosts.calculix.build import ensure_ccx
from plyflow.hosts.calculix.checks import Material
from plyflow.hosts.calculix.faces import Face, adapter_face, native_face
from plyflow.umat.prepare import Umat, prepare_umat
from umatgen.scene import Scene


@pytest.fixture(scope="session")
def ccx() -> Path:
    """The program; built if need be, which takes some minutes."""
    return ensure_ccx()


@pytest.fixture(scope="session")
def umat() -> Umat:
    return prepare_umat()


@pytest.fixture(scope="session")
def material(umat: Umat) -> Material:
    """The default scene with its default constants."""
    return Material(umat.manifest, [float(row["default"]) for row in umat.manifest["props"]], umat.library)


@pytest.fixture(scope="session")
def native() -> Face:
    return native_face(Scene())


@pytest.fixture(scope="session")
def adapter(umat: Umat) -> Face:
    return adapter_face(umat.source, "PFDEFAULTNL")
