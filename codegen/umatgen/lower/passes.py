"""Passes over lowered stages: reduce to a plane, fold constants, leave out what nobody needs, share subexpressions.

Each pass is a function of all stages; the operation counts before and after each are kept with the stage.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

import sympy as sp

from umatgen.lower.assign import Assignment, OperationCount, element, operations, share
from umatgen.lower.stage import Stage, Variable

Pass = Callable[[Sequence[Stage]], list[Stage]]
_OUT_OF_PLANE = re.compile(r"^(?:f0|f1|f_step)\((?:1,3|2,3|3,1|3,2)\)$")
_OUT_OF_PLANE_VOIGT = re.compile(r"^\w+\([56]\)$|^ddsdde\((?:[56],\d|\d,[56])\)$")


def counted(name: str, stages: Sequence[Stage], work: Pass) -> list[Stage]:
    """Run a pass and note the operations of every stage before and after it."""
    before = {s.name: operations(s.assignments) for s in stages}
    result = []
    for stage in work(stages):
        count = OperationCount(stage.name, name, before[stage.name], operations(stage.assignments))
        if stage.counts and stage.counts[-1].name == name:
            count = replace(count, before=stage.counts[-1].before)
            stage = replace(stage, counts=stage.counts[:-1])  # noqa: PLW2901
        result.append(replace(stage, counts=(*stage.counts, count)))
    return result


def base(target: str) -> str:
    """Name of the array or scalar of a target."""
    return target.split("(", maxsplit=1)[0]


def in_plane(stages: Sequence[Stage]) -> list[Stage]:
    """Plane strain and axisymmetry: F13, F23, F31, F32 and all components 13, 23 are zero; four Voigt components."""
    return [_stage_in_plane(stage) for stage in stages]


def _stage_in_plane(stage: Stage) -> Stage:
    zero = {
        s: sp.S.Zero
        for a in stage.assignments
        for s in a.expr.free_symbols
        if _OUT_OF_PLANE.match(s.name) or _OUT_OF_PLANE_VOIGT.match(s.name)
    }
    kept = [a for a in stage.assignments if not _OUT_OF_PLANE_VOIGT.match(a.target)]
    return replace(
        stage,
        assignments=[Assignment(a.target, a.expr.subs(zero)) for a in kept],
        inputs=tuple(_flat(v) for v in stage.inputs),
        outputs=tuple(_flat(v) for v in stage.outputs),
        local_arrays=tuple(_flat(v) for v in stage.local_arrays),
    )


def _flat(variable: Variable) -> Variable:
    shape = {(6,): (4,), (6, 6): (4, 4)}.get(variable.shape, variable.shape)
    return replace(variable, shape=shape)


def fold(stages: Sequence[Stage]) -> list[Stage]:
    """Scalars that are constant (zero by symmetry, or left out by the scene) go into the expressions that use them."""
    known: dict[sp.Symbol, sp.Expr] = {}
    arrays = {v.name for s in stages for v in (*s.inputs, *s.outputs, *s.local_arrays) if v.shape}
    several = _defined_more_than_once(stages)
    result = []
    for stage in stages:
        body = []
        for assignment in stage.assignments:
            expr = assignment.expr.subs({s: known[s] for s in assignment.expr.free_symbols if s in known})
            whole = assignment.target in arrays or "(" in assignment.target
            if expr.is_number and not whole and assignment.target not in several:
                known[sp.Symbol(assignment.target, real=True)] = expr
                known[sp.Symbol(assignment.target, positive=True)] = expr
                continue
            body.append(Assignment(assignment.target, expr))
        result.append(replace(stage, assignments=body))
    return [_without(s, {k.name for k in known}) for s in result]


def _defined_more_than_once(stages: Sequence[Stage]) -> set[str]:
    targets = [a.target for s in stages for a in s.assignments]
    return {t for t in targets if targets.count(t) > 1}


def _without(stage: Stage, names: set[str]) -> Stage:
    return replace(
        stage,
        inputs=tuple(v for v in stage.inputs if v.name not in names),
        outputs=tuple(v for v in stage.outputs if v.name not in names),
    )


@dataclass
class _Liveness:
    """What later statements need: whole variables, and single elements of arrays."""

    names: set[str] = field(default_factory=set)

    def need(self, expr: sp.Expr) -> None:
        self.names |= {s.name for s in expr.free_symbols}

    def needs(self, target: str, whole: set[str]) -> bool:
        return target in self.names or base(target) in whole


def prune(wanted: Iterable[str]) -> Pass:
    """Keep only assignments, inputs, outputs and stages that the wanted results need."""

    def work(stages: Sequence[Stage]) -> list[Stage]:
        needed = set(wanted)
        kept: list[Stage] = []
        for stage in reversed(stages):
            slim = _prune_stage(stage, needed)
            if slim is not None:
                kept.append(slim)
                needed |= {v.name for v in slim.inputs}
        return kept[::-1]

    return work


def _prune_stage(stage: Stage, needed: set[str]) -> Stage | None:
    outputs = tuple(v for v in stage.outputs if v.name in needed)
    if not outputs:
        return None
    whole = {v.name for v in outputs}
    live = _Liveness(set(whole))
    body: list[Assignment] = []
    for assignment in reversed(stage.assignments):
        if live.needs(assignment.target, whole):
            body.append(assignment)
            live.need(assignment.expr)
    used = {base(name) for name in live.names} | {base(a.target) for a in body}
    inner = tuple(Variable(v.name, v.shape) for v in stage.outputs if v.shape and v.name in used - whole)
    return replace(
        stage,
        assignments=body[::-1],
        outputs=outputs,
        inputs=tuple(v for v in stage.inputs if v.name in used),
        local_arrays=(*(v for v in stage.local_arrays if v.name in used), *inner),
    )


def share_subexpressions(stages: Sequence[Stage]) -> list[Stage]:
    """Common subexpressions of each stage; those of the tangent only outside its components."""
    return [replace(s, assignments=_shared(s)) for s in stages]


def _shared(stage: Stage) -> list[Assignment]:
    if stage.sharing == "none":
        return list(stage.assignments)
    if stage.sharing == "all":
        return share(stage.assignments)
    if stage.sharing == "slopes":
        slopes = (i for i, a in enumerate(stage.assignments) if a.target.startswith("dlng_"))
        place = next(slopes, len(stage.assignments))
        return [*stage.assignments[:place], *share(stage.assignments[place:])]
    tangent = ("ddsdde", "both_")
    rest = [a for a in stage.assignments if a.target.startswith(tangent)]
    return share([a for a in stage.assignments if not a.target.startswith(tangent)]) + rest


def vanishing(stages: Sequence[Stage]) -> list[Stage]:
    """Array elements that are zero everywhere they are defined, used as zero in the same stage."""
    result = []
    for stage in stages:
        local = {v.name for v in stage.local_arrays}
        targets = [a.target for a in stage.assignments]
        zeros = {
            element(a.target): sp.S.Zero
            for a in stage.assignments
            if a.expr == 0 and base(a.target) in local and targets.count(a.target) == 1
        }
        body = [Assignment(a.target, a.expr.subs(zeros)) for a in stage.assignments if element(a.target) not in zeros]
        result.append(replace(stage, assignments=body))
    return result
