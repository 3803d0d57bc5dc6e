"""The scene of the paper's backward difference, emitted and compiled once for all tests of this folder, in a cache of its own."""

from collections.abc import Iterator
from typing import Any

import pytest

from plyflow.umat.compile import compile_umat
from plyflow.umat.library import UmatLibrary
from umatgen.pipeline import generate
from umatgen.scene import SCENES


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Nothing compiled here enters the user's cache, and nothing stale comes out of it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PLYFLOW_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session")
def emitted() -> Any:
    """Source and manifest of the scene."""
    return generate(SCENES["bdf1"])


@pytest.fixture(scope="session")
def umat(emitted: Any) -> UmatLibrary:
    """The scene as a library."""
    return UmatLibrary(compile_umat(emitted.source))
