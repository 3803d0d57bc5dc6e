"""The small language the emitter speaks: five frozen dataclasses, with SymPy expressions as leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp


@dataclass(frozen=True)
class Comment:
    """A full-line comment."""

    text: str


@dataclass(frozen=True)
class Declare:
    """A real variable: a dummy argument with its intent ("in", "out"), or a local one (intent "")."""

    name: str
    shape: tuple[int, ...] = ()
    intent: str = ""
    note: str = ""


@dataclass(frozen=True)
class Assign:
    """`target = value`; the value is a SymPy expression, or Fortran text for array syntax."""

    target: str
    value: sp.Expr | str


@dataclass(frozen=True)
class Call:
    """`CALL name(arguments)`."""

    name: str
    arguments: tuple[str, ...]


Statement = Comment | Assign | Call


@dataclass(frozen=True)
class Block:
    """A procedure: one concept, headed by its equation, with what goes in and out.

    Parameters
    ----------
    name : procedure name without the scene's prefix; also the id of the block in the manifest and the audit.
    title : what it computes, one line.
    equation : number or place in the paper.
    arguments : dummies in order, with intent and unit.
    body : statements; local names are declared by the printer.
    local_arrays : local names with a shape.
    """

    name: str
    title: str
    equation: str
    arguments: tuple[Declare, ...]
    body: Sequence[Statement]
    local_arrays: tuple[Declare, ...] = ()
