"""Statements of a procedure over a block of points: neighbours in one loop, branches as masks.

A branch becomes a mask and its assignments a `merge`; what calls a stage or costs a function is left out where no point of the
block wants it. Variables stand as arrays over the points; `private` makes scalars of those that can be.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

import sympy as sp

from umatgen.expressions import expression
from umatgen.lower.block_nodes import cheaper
from umatgen.lower.block_scope import ELEMENT, NOVECTOR, POINT, SIMD, WIDTH, Scope, Shape, indices
from umatgen.nodes import Assign, Call, Comment, Do, If, Procedure, Statement, base
from umatgen.scene import SceneError

# Without vector functions: atanh, for it is divided by small differences afterwards (an ulp would be 1e-8 of a slope), and the
# logarithm of J2, for it is tens (its ulp times m would be 1e-13 of the rate at the end).
_EXACT = re.compile(r"\batanh\(|\blog\(j2_eff\b")
_COSTLY = re.compile(r"\b(?:exp|log|atanh)\(|\*\*\(")


class Loops:
    """The statements of one procedure over the points.

    Parameters
    ----------
    place : name of the procedure, "" for the point routine.
    scopes : variables of each procedure.
    called : the procedures that are called.
    defined : variables that have a value at the start.
    hot : whether the procedure holds a loop of its own, where divisions count.
    """

    def __init__(
        self, place: str, scopes: Mapping[str, Scope], called: Mapping[str, Procedure], defined: set[str], *, hot: bool = False
    ) -> None:
        self.scope, self._scopes, self._called, self._defined, self._hot = scopes[place], scopes, called, set(defined), hot
        self.arrays: dict[str, Shape] = {}
        self.hits: list[str] = []
        self._masks = 0
        self._done: list[Statement] = []
        self._pending: list[Statement] = []
        self._after: list[Assign] = []

    def of(self, body: Sequence[Statement], mask: str = "") -> list[Statement]:
        """The statements in order, for the points of a mask.

        Raises
        ------
        SceneError
            One of them has no counterpart over a block.
        """
        kept, self._done = self._done, []
        for statement in body:
            self._take(statement, mask)
        self._flush()
        done, self._done = self._done, kept
        return done

    def _take(self, statement: Statement, mask: str) -> None:
        match statement:
            case Comment():
                self._pending.append(statement)
            case Assign(target, value):
                self._assign(target, expression(cheaper(self._exact_first(value, mask), hot=self._hot)), mask)
            case Call():
                self._call(statement, mask)
            case If():
                self._branch(statement, mask)
            case Do():
                self._flush()
                self._done.append(Do(statement.counter, statement.first, statement.last, self.of(statement.body, mask)))
            case _:
                raise SceneError(f"no batch routine: {type(statement).__name__} has no counterpart over a block of points")

    def _exact_first(self, value: sp.Expr | str, mask: str) -> sp.Expr | str:
        """Functions that stay scalar in a loop of their own; the value with a name in their place."""
        if isinstance(value, str):
            return value
        found = sorted((e for e in value.atoms(sp.Function) if _EXACT.match(expression(e))), key=str)
        for number, function in enumerate(found, 1):
            name = f"exact_{number}"
            value = value.subs(function, sp.Symbol(name, real=True))
            self._array(name)
            self._flush()
            self._assign(name, expression(function), mask)
            self._flush()
        return value

    def _array(self, name: str, shape: Shape = (), *, logical: bool = False) -> None:
        self.arrays[name] = shape
        self.scope.declare(name, shape, logical=logical)

    def _assign(self, target: str, value: str, mask: str) -> None:
        if base(target) not in self.scope.lanes:
            self._one_for_all(Assign(target, value))
            return
        for name, text in self._elements(target, value):
            if any(re.search(rf"\b{a.target}\b", text) for a in self._after):
                self._flush()
            self._pending.append(self._merged(name, text, mask))

    def _one_for_all(self, assign: Assign) -> None:
        """Beside the loop: before it, or after it where the loop reads the old value."""
        read = any(re.search(rf"\b{assign.target}\b", str(s.value)) for s in self._pending if isinstance(s, Assign))
        (self._after if read else self._done).append(assign)

    def _elements(self, target: str, value: str) -> Iterator[tuple[str, str]]:
        """Whole arrays one element after the other."""
        shape = self.scope.shapes.get(target)
        if shape is None:
            yield target, value
            return
        for index in indices(shape):
            yield f"{target}({index})", ELEMENT.sub(lambda m, i=index: self._at(m, i), value)  # type: ignore[misc]

    def _at(self, match: re.Match[str], index: str) -> str:
        return match[0] + (f"({index})" if match[1] in self.scope.shapes else "")

    def _merged(self, target: str, value: str, mask: str) -> Assign:
        """An assignment for the points of a mask; for all where the target has no value yet."""
        left, text = self.scope.laned(target).removesuffix(" > 0.5d0"), self.scope.laned(value)
        if base(target) in self.scope.logical:
            text = "1.0d0" if value == ".TRUE." else f"merge(1.0d0, 0.0d0, {text})"
        known = target in self._defined
        self._defined.add(target)
        return Assign(left, f"merge({text}, {left}, {mask})" if mask and known else text)

    def _branch(self, statement: If, mask: str) -> None:
        if not mask and not any(self.scope.differs(condition) for condition, _ in statement.branches):
            self._flush()
            self._done.append(If(tuple((c, self.of(b)) for c, b in statement.branches)))
            return
        alone = len(statement.branches) == 1
        costly = any(_is_costly(body, alone=alone) for _, body in statement.branches)
        if costly:
            self._flush()
        others: list[str] = []
        for condition, body in statement.branches:
            parts = [*([mask] if mask else []), *(f".NOT. {other}" for other in others), self.scope.laned(condition)]
            wanted = parts[-1] if len(parts) == 1 else " .AND. ".join([*parts[:-1], *([f"({parts[-1]})"] if parts[-1] else [])])
            others.append(self._guarded(wanted, body) if costly else self._hit(wanted, body, alone=alone))

    def _hit(self, condition: str, body: Sequence[Statement], *, alone: bool) -> str:
        """A branch inside the loop; its mask."""
        if alone and len(body) == 1 and isinstance(body[0], Assign) and body[0].target not in self.scope.shapes:
            self._take(body[0], condition)
            return condition
        name = f"hit_{len(self.hits) + 1}"
        self.hits.append(name)
        self._pending.append(Assign(name, condition))
        for inner in body:
            self._take(inner, name)
        return name

    def _guarded(self, condition: str, body: Sequence[Statement]) -> str:
        """A branch that is left out where no point of the block wants it; its mask."""
        self._masks += 1
        name = f"chosen_{self._masks}"
        self._array(name, logical=True)
        self._pending.append(Assign(f"{name}({POINT})", f"merge(1.0d0, 0.0d0, {condition})"))
        self._flush()
        mask = f"{name}({POINT}) > 0.5d0"
        self._done.append(If(((f"any({name} > 0.5d0)", self.of(body, mask)),)))
        return mask

    def _call(self, call: Call, mask: str) -> None:
        """A call for all points; where only some want it, and the others have their values, into other arrays first."""
        lanes, dummies = self._scopes[call.name].lanes, self._called[call.name].arguments
        actual, merges = list(call.arguments), []
        for number, (given, dummy) in enumerate(zip(call.arguments, dummies, strict=True)):
            if number < call.outputs:
                if dummy.name in lanes and not re.fullmatch(r"[a-z]\w*", given):
                    actual[number] = self._named(f"{call.name}_{number + 1}", given)
                continue
            shape = self.scope.shapes.get(given, ())
            if mask and any(base(d) == given for d in self._defined):
                actual[number] = f"{given}_here"
                self._array(actual[number], shape)
                merges.append((given, actual[number]))
            self._defined |= {f"{given}({i})" for i in indices(shape)} if shape else {given}
        self._flush()
        self._done.append(Call(call.name, tuple(actual), call.outputs))
        for name, here in merges:
            self._assign(name, here, mask)

    def _named(self, name: str, value: str) -> str:
        """An array for an argument that is an expression, a constant or an element."""
        self._array(name)
        self._assign(name, value, "")
        return name

    def _flush(self) -> None:
        """Close the loop; comments at its end belong to what follows."""
        trailing: list[Statement] = []
        while self._pending and isinstance(self._pending[-1], Comment):
            trailing.insert(0, self._pending.pop())
        if self._pending:
            exact = any(isinstance(s, Assign) and _EXACT.search(str(s.value)) for s in self._pending)
            self._done.append(Do(POINT, "1", WIDTH, tuple(self._pending), NOVECTOR if exact else SIMD))
        self._done += [*self._after, *trailing]
        self._pending, self._after = [], []


def _is_costly(body: Sequence[Statement], *, alone: bool) -> bool:
    """Whether a branch calls a stage, or one without another in its place a function: worth leaving out."""
    return any(
        isinstance(s, Call | Do) or (alone and isinstance(s, Assign) and bool(_COSTLY.search(expression(s.value))))
        or (isinstance(s, If) and any(_is_costly(b, alone=alone) for _, b in s.branches))
        for s in body
    )  # fmt: skip
