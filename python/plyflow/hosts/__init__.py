"""Analyses that run the emitted material: Abaqus, CalculiX."""
