"""Numerics that hold: the matrix of stiff, extreme and refused states, measured and reported."""

from plyflow.evidence.stability.bench import Bench
from plyflow.evidence.stability.cells import Cell, Check, Outcome, Verdict
from plyflow.evidence.stability.matrix import Matrix, run_matrix
from plyflow.evidence.stability.run import run_stability

__all__ = ["Bench", "Cell", "Check", "Matrix", "Outcome", "Verdict", "run_matrix", "run_stability"]
