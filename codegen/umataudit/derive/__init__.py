"""Derivations, one file for each part of the paper; importing this package registers them all."""

from umataudit.derive import (
    appendix,
    constants,
    elastic,
    fibre_scale,
    flow_states,
    frame,
    locking,
    one_dimensional,
    programme,
    tangents,
    viscous,
)

__all__ = [
    "appendix", "constants", "elastic", "fibre_scale", "flow_states", "frame", "locking", "one_dimensional", "programme", "tangents",
    "viscous",
]  # fmt: skip
