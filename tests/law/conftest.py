from __future__ import annotations

import pytest

from plyflow.umat.prepare import Umat, prepare_umat


@pytest.fixture(scope="session")
def umat() -> Umat:
    return prepare_umat()
