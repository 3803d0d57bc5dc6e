"""The point routine over a block of points: its nodes with the variables as arrays over the points, branches as masks.

`p` counts the points of a block. What depends on PROPS alone is one number for all points; every other variable of the scalar
routine gets the points as its first dimension. A branch becomes a mask and its assignments a `merge`; what costs a function or
calls a stage is left out where no point of the block wants it. A fault ends nothing: it takes the margin of its point away.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp

from umatgen.expressions import expression
from umatgen.lower.point import FAULT
from umatgen.nodes import Assign, Call, Comment, Do, If, Procedure, Return, Statement, base
from umatgen.scene import SceneError

POINT, WIDTH, MARGIN = "p", "block", "margin"
NOVECTOR = "!GCC$ NOVECTOR"  # gathers cost more than they save, and vector functions may differ by an ulp
SCALAR_ONLY = {"widening"}  # set under a condition for the one increment that passes the lock: that goes through the scalar routine
_EXACT = {"atanh"}  # divided by small differences afterwards: an ulp of a vector function would be 1e-8 of a slope
_COSTLY = re.compile(r"\b(?:exp|log|atanh)\(|\*\*\(")
_WORD = re.compile(r"(?<![\w@.])([a-z]\w*)(?:\((\d+(?:,\d+)?)\))?")


@dataclass
class Scope:
    """Variables of a procedure: shapes, logical ones, and those that differ from point to point."""

    shapes: dict[str, tuple[int | str, ...]]
    logical: set[str]
    lanes: set[str] = field(default_factory=set)

    @classmethod
    def of(cls, procedure: Procedure) -> Scope:
        """Those that the procedure declares."""
        declared = (*procedure.arguments, *procedure.declared)
        return cls({d.name: d.shape for d in declared if d.shape}, {d.name for d in declared if d.kind == "LOGICAL"})

    def differs(self, text: str) -> bool:
        """Whether a text reads a variable that differs from point to point."""
        return any(match.group(1) in self.lanes for match in _WORD.finditer(text))

    def laned(self, text: str) -> str:
        """The text for point p of a block."""
        return _WORD.sub(self._element, text)

    def _element(self, match: re.Match[str]) -> str:
        name, index = match.groups()
        if name not in self.lanes:
            return match.group()
        element = f"{name}({POINT}{f',{index}' if index else ''})"
        return f"{element} > 0.5d0" if name in self.logical else element


def without_faults(body: Sequence[Statement], shapes: Mapping[str, tuple[int | str, ...]]) -> list[Statement]:
    """Statements with faults, and what is left to the scalar routine, as losses of the margin."""
    result: list[Statement] = []
    lost = Assign(MARGIN, "0.0d0")
    for statement in body:
        if isinstance(statement, Assign) and statement.target in FAULT:
            continue
        if isinstance(statement, Call) and set(FAULT) & set(statement.arguments):
            result.append(If(((".NOT. (dt >= 0.0d0 .AND. dt <= huge(dt))", [lost]),)))
        elif isinstance(statement, If):
            result += _without_faults(statement, lost, shapes)
        else:
            result.append(statement)
    return result


def _without_faults(statement: If, lost: Assign, shapes: Mapping[str, tuple[int | str, ...]]) -> list[Statement]:
    branches: list[tuple[str, Sequence[Statement]]] = []
    for condition, body in statement.branches:
        if "ifault" in condition or re.fullmatch(rf"({'|'.join(SCALAR_ONLY)}) > 1\.0d0", condition):
            continue
        left = any(isinstance(s, Return) or (isinstance(s, Assign) and s.target in SCALAR_ONLY) for s in body)
        branches.append((_finite(condition, shapes), [lost] if left else without_faults(body, shapes)))
    if branches and not branches[0][0]:
        return list(branches[0][1])
    return [If(tuple(branches))] if branches else []


def _finite(condition: str, shapes: Mapping[str, tuple[int | str, ...]]) -> str:
    """`@finite(x)` as a comparison, sums of arrays written out."""
    condition = re.sub(r"sum\((\w+)\)", lambda m: " + ".join(f"{m[1]}({i})" for i in indices(shapes[m[1]])), condition)
    return re.sub(r"\.NOT\. @finite\((.*)\)$", r".NOT. abs(\1) <= huge(1.0d0)", condition)


def indices(shape: Sequence[int | str]) -> list[str]:
    """Element numbers of an array, first index fastest."""
    found = [""]
    for n in shape:
        found = [f"{left},{i}" if left else str(i) for i in range(1, int(n) + 1) for left in found]
    return found


def spread(point: Procedure, body: Sequence[Statement], inner: Mapping[str, Procedure], uniform: set[str]) -> dict[str, Scope]:
    """Which variables differ from point to point, in the point routine ("") and in each procedure that it calls."""
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
        if dummy.name in own.lanes and re.match(r"[a-z]", actual):
            scope.lanes.add(base(actual))


def one_call(body: Sequence[Statement]) -> list[Statement]:
    """Branches that end with calls of the same procedure, but for constants, as one call behind them."""
    result: list[Statement] = []
    for statement in body:
        ends = [b[-1] for _, b in statement.branches] if isinstance(statement, If) and all(b for _, b in statement.branches) else []
        calls = [end for end in ends if isinstance(end, Call)]
        varying = [n for n, a in enumerate(zip(*(c.arguments for c in calls), strict=True)) if len(set(a)) > 1] if calls else []
        constant = all(re.match(r"\d", c.arguments[n]) for c in calls for n in varying)
        if not isinstance(statement, If) or len(calls) < max(2, len(ends)) or len({c.name for c in calls}) > 1 or not constant:
            result.append(statement)
            continue
        names = {n: f"{calls[0].name}_{n + 1}" for n in varying}
        result.append(If(tuple(
            (condition, [*inner[:-1], *(Assign(name, call.arguments[n]) for n, name in names.items())])
            for (condition, inner), call in zip(statement.branches, calls, strict=True)
        )))  # fmt: skip
        result.append(Call(calls[0].name, tuple(names.get(n, a) for n, a in enumerate(calls[0].arguments)), calls[0].outputs))
    return result


def cheaper(value: sp.Expr | str, *, hot: bool = False) -> sp.Expr | str:
    """Powers with a symbol as exponent by exp and log; in a loop also quotients on one denominator."""
    if isinstance(value, str):
        return value
    value = value.replace(lambda e: isinstance(e, sp.log) and e.args[0].is_Mul, lambda e: _log_of(e.args[0]))
    value = value.replace(lambda e: e.is_Pow and bool(e.exp.free_symbols), lambda e: sp.exp(e.exp * sp.log(e.base)))
    return value.replace(lambda e: e.is_Add and sum(map(_is_quotient, e.args)) > 1, sp.together) if hot else value


def _is_quotient(term: sp.Expr) -> bool:
    return bool(sp.denom(term).free_symbols)


def _log_of(product: sp.Expr) -> sp.Expr:
    powers = [f for f in product.args if f.is_Pow and f.exp.free_symbols]
    rest = sp.Mul(*(f for f in product.args if f not in powers))
    return sp.Add(*(f.exp * sp.log(f.base) for f in powers), sp.log(rest))


class Lanes:
    """Statements of one procedure over the points of a block."""

    def __init__(self, scope: Scope, inner: Mapping[str, Scope], called: Mapping[str, Procedure], defined: set[str], *, hot: bool = False) -> None:
        self.scope, self._inner, self._called, self._defined, self._hot = scope, inner, called, set(defined), hot
        self.arrays: dict[str, tuple[int | str, ...]] = {}
        self.hits: list[str] = []
        self._masks = 0
        self._done: list[Statement] = []
        self._pending: list[Statement] = []
        self._after: list[Assign] = []

    def of(self, body: Sequence[Statement], mask: str = "") -> list[Statement]:
        """The statements in order, neighbours in one loop over the points."""
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
                self._assign(target, expression(cheaper(value, hot=self._hot)), mask)
            case Call():
                self._call(statement, mask)
            case If():
                self._branch(statement, mask)
            case Do():
                self._flush()
                self._done.append(Do(statement.counter, statement.first, statement.last, self.of(statement.body, mask)))
            case _:
                raise SceneError(f"no batch routine: {type(statement).__name__} has no counterpart over a block of points")

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
            yield f"{target}({index})", _WORD.sub(lambda m, i=index: m[0] + (f"({i})" if m[1] in self.scope.shapes else ""), value)

    def _merged(self, target: str, value: str, mask: str) -> Assign:
        logical = base(target) in self.scope.logical
        left, text = self.scope.laned(target).removesuffix(" > 0.5d0"), self.scope.laned(value)
        if logical:
            text = "1.0d0" if value == ".TRUE." else f"merge(1.0d0, 0.0d0, {text})"
        known = target in self._defined
        self._defined.add(target)
        return Assign(left, f"merge({text}, {left}, {mask})" if mask and known else text)

    def _branch(self, statement: If, mask: str) -> None:
        if not any(self.scope.differs(condition) for condition, _ in statement.branches) and not mask:
            self._flush()
            self._done.append(If(tuple((c, self.of(b)) for c, b in statement.branches)))
            return
        costly = any(_is_costly(body, alone=len(statement.branches) == 1) for _, body in statement.branches)
        if costly:
            self._flush()
        others: list[str] = []
        for condition, body in statement.branches:
            wanted = self.scope.laned(condition)
            parts = [*([mask] if mask else []), *(f".NOT. {other}" for other in others), *([f"({wanted})"] if wanted else [])]
            if costly:
                others.append(self._guarded(" .AND. ".join(parts), body))
            else:
                others.append(self._hit(" .AND. ".join(parts), body, single=len(statement.branches) == 1))

    def _hit(self, condition: str, body: Sequence[Statement], *, single: bool) -> str:
        """A branch inside the loop; its mask."""
        if single and len(body) == 1 and isinstance(body[0], Assign) and body[0].target not in self.scope.shapes:
            self._take(body[0], _bare(condition))
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
        self.arrays[name] = ()
        self.scope.lanes.add(name)
        self.scope.logical.add(name)
        self._pending.append(Assign(f"{name}({POINT})", f"merge(1.0d0, 0.0d0, {_bare(condition)})"))
        self._flush()
        mask = f"{name}({POINT}) > 0.5d0"
        self._done.append(If(((f"any({name} > 0.5d0)", self.of(body, mask)),)))
        return mask

    def _call(self, call: Call, mask: str) -> None:
        self._flush()
        inner, called = self._inner[call.name], self._called[call.name]
        actual, merges = [], []
        for number, (name, dummy) in enumerate(zip(call.arguments, called.arguments, strict=True)):
            if dummy.name in inner.lanes and not re.match(r"[a-z]", name):
                raise SceneError(f"no batch routine: {call.name} is called with the constant {name}, elsewhere with a variable")
            shared = number >= call.outputs and mask and any(base(d) == name for d in self._defined)
            here = f"{name}_here" if shared else name
            if shared:
                shape = self.scope.shapes.get(name, ())
                self.arrays[here] = shape
                self.scope.lanes.add(here)
                self.scope.shapes |= {here: shape} if shape else {}
                merges.append((name, here))
            elif number >= call.outputs:
                shape = self.scope.shapes.get(name, ())
                self._defined |= {f"{name}({i})" for i in indices(shape)} if shape else {name}
            actual.append(here)
        self._done.append(Call(call.name, tuple(actual), call.outputs))
        for name, here in merges:
            self._assign(name, here, mask)

    def _flush(self) -> None:
        """Close the loop; comments at its end belong to what follows."""
        trailing: list[Statement] = []
        while self._pending and isinstance(self._pending[-1], Comment):
            trailing.insert(0, self._pending.pop())
        if self._pending:
            exact = any(isinstance(s, Assign) and f"{n}(" in str(s.value) for s in self._pending for n in _EXACT)
            directive = NOVECTOR if exact else "!$omp simd"
            self._done.append(Do(POINT, "1", WIDTH, tuple(self._pending), directive))
        self._done += [*self._after, *trailing]
        self._pending, self._after = [], []


def _bare(condition: str) -> str:
    """A condition without brackets around the whole."""
    inside = condition[1:-1] if condition.startswith("(") and condition.endswith(")") else condition
    return inside if inside.count("(") == inside.count(")") and ").AND.(" not in inside and ") .AND. (" not in inside else condition


def _is_costly(body: Sequence[Statement], *, alone: bool) -> bool:
    """Whether a branch calls a stage, or one without another in its place a function: worth leaving out."""
    return any(
        isinstance(s, Call | Do) or (alone and isinstance(s, Assign) and bool(_COSTLY.search(expression(s.value))))
        or (isinstance(s, If) and any(_is_costly(b, alone=alone) for _, b in s.branches))
        for s in body
    )  # fmt: skip


def private(statements: Sequence[Statement], candidates: set[str]) -> tuple[list[Statement], set[str]]:
    """Statements with the variables that live in one loop only as scalars; the names of the arrays that stay."""
    loops = list(_loops(statements))
    outside = _outside(statements)
    single = {n for n in candidates if n not in outside and sum(_uses(loop, n) for loop in loops) == 1}
    pattern = re.compile(rf"\b({'|'.join(sorted(single)) or '-'})\({POINT}((?:,\d)*)\)")

    def scalar(text: str) -> str:
        return pattern.sub(lambda m: m[1] + (f"_{m[2].replace(',', '')}" if m[2] else ""), text)

    return _replaced(statements, scalar), candidates - single


def _loops(statements: Sequence[Statement]) -> Iterator[Do]:
    for statement in statements:
        if isinstance(statement, Do):
            if statement.directive:
                yield statement
            else:
                yield from _loops(statement.body)
        elif isinstance(statement, If):
            for _, body in statement.branches:
                yield from _loops(body)


def _outside(statements: Sequence[Statement]) -> set[str]:
    """Names in calls and conditions."""
    found: set[str] = set()
    for statement in statements:
        if isinstance(statement, Call):
            found |= {base(a) for a in statement.arguments}
        elif isinstance(statement, If):
            for condition, body in statement.branches:
                found |= set(re.findall(r"[a-z]\w*", condition)) | _outside(body)
        elif isinstance(statement, Do) and not statement.directive:
            found |= _outside(statement.body)
    return found


def _uses(loop: Do, name: str) -> bool:
    wanted = re.compile(rf"\b{name}\({POINT}\b")
    return any(isinstance(s, Assign) and wanted.search(f"{s.target} {s.value}") for s in loop.body)


def _replaced(statements: Sequence[Statement], scalar: Callable[[str], str]) -> list[Statement]:
    result: list[Statement] = []
    for s in statements:
        if isinstance(s, Assign):
            result.append(Assign(scalar(s.target), scalar(str(s.value))))
        elif isinstance(s, Do):
            result.append(Do(s.counter, s.first, s.last, _replaced(s.body, scalar), s.directive))
        elif isinstance(s, If):
            result.append(If(tuple((c, _replaced(b, scalar)) for c, b in s.branches)))
        else:
            result.append(s)
    return result
