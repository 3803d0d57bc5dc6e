"""Fortran text from lowered stages: nodes, expression printer, line layout, and one file per host face."""
