"""The reduced matrix, run once for all tests of this folder."""

import pytest

from plyflow.evidence.stability import Bench, Matrix, run_matrix


@pytest.fixture(scope="session")
def bench() -> Bench:
    """Scenes as they are emitted."""
    return Bench(quick=True)


@pytest.fixture(scope="session")
def matrix() -> Matrix:
    """The reduced matrix: every check on every material and temperature, fewer cases and random states."""
    return run_matrix(Bench(quick=True))
