from __future__ import annotations

from pathlib import Path

import pytest

from plyflow.diagnose.library import load_umat
from plyflow.umat.library import UmatLibrary

UMATS = Path(__file__).parent / "umats"


@pytest.fixture(scope="session")
def neo_hooke() -> UmatLibrary:
    """Neo-Hooke with a number of mistakes to choose from (PROPS 3)."""
    return load_umat(UMATS / "neo_hooke.f")
