"""One audit of the default scene for all tests of this folder, compiled in a cache of its own."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from plyflow.audit.report import Audit, run_audit


@pytest.fixture(scope="session", autouse=True)
def own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Nothing compiled here enters the user's cache, and nothing stale comes out of it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PLYFLOW_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="session")
def audited(own_cache: None) -> Audit:
    """The audit of the default scene."""
    return run_audit()
