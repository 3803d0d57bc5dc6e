"""The registered equations of each emitted block, evaluated with 30 digits: what a compiled block must return.

A reference is a function of the block's inputs by name. It is written from `umatgen.model` alone; how the compiler orders,
factors or shares subexpressions does not enter. The references are in `stress_blocks` and `tangent_blocks`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import mpmath as mp

from umataudit.numbers import Value
from umatgen.model.generators import VOIGT

Inputs = Mapping[str, Value]
Outputs = dict[str, Value]
Reference = Callable[[Inputs, str], Outputs]
REFERENCES: dict[str, Reference] = {}
UNIT = [mp.mpf(int(i == j)) for i, j in VOIGT]
SLOPES = ("det_f", "stretch", "a_norm2", "j2")


class UnknownBlockError(KeyError):
    """An emitted block has no registered equations."""


def reference(name: str) -> Reference:
    """Reference of a block; called with its inputs and the scene's kind of tangent.

    Raises
    ------
    UnknownBlockError
        Names the block.
    """
    if name not in REFERENCES:
        raise UnknownBlockError(f"block '{name}' has no registered equations; add a reference in umataudit")
    return REFERENCES[name]


def block(*names: str) -> Callable[[Reference], Reference]:
    """Decorator: the function is the reference of these blocks."""

    def add(function: Reference) -> Reference:
        for name in names:
            REFERENCES[name] = function
        return function

    return add


def device_of(names: Mapping[str, Value]) -> str:
    """Device of incompressibility, from what a block is given."""
    return "augmented" if "p_start" in names else "penalty" if "kappa_eff" in names else "none"
