"""The reduced matrix, run once for all tests of this folder."""

import pytest

from plyflow.evidence.stability.matrix import Matrix, all_tasks, run_matrix
from plyflow.evidence.stability.subject import Subject


@pytest.fixture(scope="session")
def subject() -> Subject:
    """Scenes as they are emitted."""
    return Subject(quick=True)


@pytest.fixture(scope="session")
def matrix() -> Matrix:
    """The reduced matrix: every check on every material and temperature, fewer cases and random states."""
    own = Subject(quick=True)
    return run_matrix(own, all_tasks(own))
