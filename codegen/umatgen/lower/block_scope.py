"""Which variables of the point routine differ from point to point of a block; the others follow from PROPS alone."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from umatgen.expressions import expression
from umatgen.nodes import Assign, Call, Do, If, Procedure, Statement, base

POINT, WIDTH, MARGIN = "p", "block", "margin"  # the point's number in its block, how many they are, and 0 where it falls out
SIMD, NOVECTOR = "!$omp simd", "!GCC$ NOVECTOR"
ELEMENT = re.compile(r"(?<![\w@.])([a-z]\w*)(?:\((\d+(?:,\d+)?)\))?")

Shape = tuple[int | str, ...]


@dataclass
class Scope:
    """Variables of a procedure: shapes, logical ones, and those that differ from point to point."""

    shapes: dict[str, Shape]
    logical: set[str]
    lanes: set[str] = field(default_factory=set)

    @classmethod
    def of(cls, procedure: Procedure) -> Scope:
        """Those that a procedure declares."""
        declared = (*procedure.arguments, *procedure.declared)
        return cls({d.name: d.shape for d in declared if d.shape}, {d.name for d in declared if d.kind == "LOGICAL"})

    def differs(self, text: str) -> bool:
        """Whether a text reads a variable that differs from point to point."""
        return any(match.group(1) in self.lanes for match in ELEMENT.finditer(text))

    def laned(self, text: str) -> str:
        """The text for point p of a block."""
        return ELEMENT.sub(self._element, text)

    def declare(self, name: str, shape: Shape = (), *, logical: bool = False) -> None:
        """Add a variable that differs from point to point."""
        self.lanes.add(name)
        self.shapes |= {name: shape} if shape else {}
        self.logical |= {name} if logical else set()

    def _element(self, match: re.Match[str]) -> str:
        name, index = match.groups()
        if name not in self.lanes:
            return match.group()
        element = f"{name}({POINT}{f',{index}' if index else ''})"
        return f"{element} > 0.5d0" if name in self.logical else element


def indices(shape: Sequence[int | str]) -> list[str]:
    """Element numbers of an array, first index fastest."""
    found = [""]
    for n in shape:
        found = [f"{left},{i}" if left else str(i) for i in range(1, int(n) + 1) for left in found]
    return found


def spread(point: Procedure, body: Sequence[Statement], inner: Mapping[str, Procedure], uniform: set[str]) -> dict[str, Scope]:
    """Scopes of the point routine ("") with the statements `body`, and of each procedure that it calls."""
    scopes = {"": Scope.of(point)} | {name: Scope.of(procedure) for name, procedure in inner.items()}
    scopes[""].lanes = {d.name for d in point.arguments} - uniform | {MARGIN}
    before = -1
    while (now := sum(len(s.lanes) for s in scopes.values())) != before:
        before = now
        _spread(body, "", scopes, inner, masked=False)
    return scopes


def _spread(
    body: Sequence[Statement], place: str, scopes: dict[str, Scope], inner: Mapping[str, Procedure], *, masked: bool
) -> None:
    scope = scopes[place]
    for statement in body:
        if isinstance(statement, Assign) and (masked or scope.differs(expression(statement.value))):
            scope.lanes.add(base(statement.target))
        elif isinstance(statement, If):
            reads = masked or any(scope.differs(condition) for condition, _ in statement.branches)
            for _, inside in statement.branches:
                _spread(inside, place, scopes, inner, masked=reads)
        elif isinstance(statement, Do):
            _spread(statement.body, place, scopes, inner, masked=masked)
        elif isinstance(statement, Call):
            _pass_on(statement, scope, scopes[statement.name], inner[statement.name], masked=masked)
            _spread(inner[statement.name].body, statement.name, scopes, inner, masked=False)


def _pass_on(call: Call, scope: Scope, own: Scope, called: Procedure, *, masked: bool) -> None:
    """From the arguments of a call to the dummies and back."""
    for number, (actual, dummy) in enumerate(zip(call.arguments, called.arguments, strict=True)):
        if scope.differs(actual) or (masked and number >= call.outputs):
            own.lanes.add(dummy.name)
        if dummy.name in own.lanes and re.fullmatch(r"[a-z]\w*", actual):
            scope.lanes.add(actual)
