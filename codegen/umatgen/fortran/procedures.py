"""Stages to procedures."""

from __future__ import annotations

from umatgen.lower.stage import Stage
from umatgen.nodes import Assign, Block, Declare, Statement


def block_of(stage: Stage) -> Block:
    """The procedure of a stage: inputs first, then outputs."""
    arguments = [Declare(v.name, v.shape, "in", v.note) for v in stage.inputs]
    arguments += [Declare(v.name, v.shape, "out", v.note) for v in stage.outputs]
    body: list[Statement] = [Assign(target, text) for target, text in stage.preamble]
    body += [Assign(a.target, a.expr) for a in stage.assignments]
    locals_ = tuple(Declare(v.name, v.shape) for v in stage.local_arrays)
    return Block(stage.name, stage.title, stage.equation, tuple(arguments), body, locals_)


def call_text(stage: Stage, prefix: str, **rename: str) -> str:
    """CALL statement with the stage's own names, some of them renamed by the caller."""
    names = [v.name for v in (*stage.inputs, *stage.outputs)]
    return f"CALL {prefix}{stage.name}({', '.join(rename.get(n, n) for n in names)})"
