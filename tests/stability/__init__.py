"""Tests of the stability matrix: what must hold, and that every check fails on a planted error."""
