"""Laminates of plies between rigid plates by finite elements: section 5 of the paper, without a licence."""
