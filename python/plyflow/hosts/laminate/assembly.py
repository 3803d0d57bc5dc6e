"""Stiffness of a specimen from those of its elements: places in the sparse matrix found once, factors by the direct solver."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from plyflow.hosts.laminate.element import Array

PIVOT = 1e-3  # the stiffness is unsymmetric, its diagonal good enough to keep the order of elimination


class Assembly:
    """Sparse matrix of the unknowns out of dense blocks.

    Parameters
    ----------
    owner : (3 nodes,) unknown of each displacement, below 0 where it is held.
    size : int
        Number of unknowns.
    groups : sequence of (g, d) displacements of each block of a group.
    """

    def __init__(self, owner: NDArray[np.intp], size: int, groups: list[NDArray[np.intp]]) -> None:
        self.size, self._kept, keys = size, [], []
        for group in groups:
            own = owner[group]
            rows, columns = np.broadcast_arrays(own[:, :, None], own[:, None, :])
            kept = np.flatnonzero((rows >= 0) & (columns >= 0))
            self._kept.append(kept)
            keys.append(columns.ravel()[kept] * size + rows.ravel()[kept])
        filled, self._place = np.unique(np.concatenate(keys), return_inverse=True)
        self._rows = (filled % size).astype(np.int32)
        self._starts = np.searchsorted(filled // size, np.arange(size + 1)).astype(np.int32)

    def matrix(self, blocks: list[Array]) -> Any:
        """The matrix (CSC) of blocks (g, d, d) of all groups, in their order."""
        entries = np.concatenate([block.ravel()[kept] for block, kept in zip(blocks, self._kept, strict=True)])
        data = np.bincount(self._place, entries, len(self._rows))
        return sparse.csc_matrix((data, self._rows, self._starts), shape=(self.size, self.size))


def factorised(matrix: Any) -> Any:
    """A function that solves with the matrix."""
    return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=PIVOT, options={"SymmetricMode": True}).solve
