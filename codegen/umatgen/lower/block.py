"""The batch routine: the point routine and its stages over blocks of points, and what surrounds a block.

Terms of PROPS alone stand before the blocks, or before the loop over the points of a stage.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from umatgen.lower.block_loops import Loops
from umatgen.lower.block_nodes import one_call, without_faults
from umatgen.lower.block_private import private
from umatgen.lower.block_scope import MARGIN, NOVECTOR, POINT, SIMD, WIDTH, Scope, Shape, indices, spread
from umatgen.lower.interface import state_variables
from umatgen.lower.point import properties
from umatgen.lower.routines import Material
from umatgen.nodes import Assign, Call, Comment, Declare, Do, If, Procedure, Return, Statement, base, targets, when
from umatgen.scene import Scene, SceneError

POINTS_OF_A_BLOCK = 8
_ONE_FOR_ALL = {"props", "kinc", "ifault", "fault_value", "fault_bound"}
_AROUND = {"f0", "f1", "dt", "statev", "stress", "ddsdde", "sse", "scd", MARGIN}  # filled before a block or read after it
_AXES = (1, 2, 3)
_INTEGER, _LOGICAL = "INTEGER", "LOGICAL"


def batch_routine(scene: Scene, material: Material) -> Procedure:
    """Calls at many points, block by block.

    Raises
    ------
    SceneError
        A statement of the point routine has no counterpart over a block.
    """
    point, shapes = material.point, Scope.of(material.point).shapes
    body = [Assign(MARGIN, "1.0d0"), *one_call(without_faults(point.body, shapes)), *_finite_results(shapes, scene)]
    procedures = {p.name: p for p in (*point.inside, *material.routines[1:])}
    called = {name: procedures[name] for name in dict.fromkeys(_called(body, procedures))}
    scopes = spread(point, body, called, _ONE_FOR_ALL)
    scope = scopes[""]
    loops = Loops("", scopes, called, {MARGIN, "scd", *(f"statev({i})" for i in indices(shapes.get("statev", (0,))))})
    statements = loops.of(body)
    once = [s for s in statements if _is_for_all(s, scope)]
    _set_once(once)
    around = _AROUND & (scope.lanes | {MARGIN})
    inner, arrays = private([s for s in statements if not _is_for_all(s, scope)], _names(statements) & scope.lanes - around)
    declared = (
        Declare(WIDTH, kind=_INTEGER, value=str(POINTS_OF_A_BLOCK)),
        *(d for d in point.declared if d.value),
        *(Declare(n, kind=_INTEGER) for n in ("first", "last", POINT, "q", "ifault")),
        *_locals(loops, arrays | around),
    )
    loop = Do("first", "1", f"n, {WIDTH}", [*_packed(scene), *inner, *_unpacked(scene)])
    inside = [_stage(name, scopes, called) for name in called]
    return Procedure("batch", _HEADING, _arguments(), [*_refusals(scene, material), *once, loop], declared, inside)


_HEADING = (
    "One increment of each of n material points with the same constants: the point routine, block by block.",
    "In:  f_start, f_end (3,3,n) deformation gradients, transposed (rows first, as C has them) [-]; dtime [s]",
    "Out: stresses, tangents, energies (SSE, SPD, SCD), states at the end; untouched where flagged is 1",
    "     flagged 1: this point goes through the scalar routine, for a fault, or because its increment passes the lock",
)


def _arguments() -> tuple[Declare, ...]:
    sizes = [Declare(n, (), "in", kind=_INTEGER) for n in ("n", "nprops", "nstatv", "ntens", "kinc")]
    ins = [Declare("props", ("nprops",), "in"), Declare("dtime", ("n",), "in")]
    ins += [Declare(name, (3, 3, "n"), "in") for name in ("f_start", "f_end")]
    changed = [
        Declare("stresses", ("ntens", "n"), "inout"), Declare("states", ("nstatv", "n"), "inout"),
        Declare("energies", (3, "n"), "inout"), Declare("tangents", ("ntens", "ntens", "n"), "inout"),
    ]  # fmt: skip
    return (*sizes, *ins, *changed, Declare("flagged", ("n",), "out", kind=_INTEGER))


def _called(body: Sequence[Statement], procedures: Mapping[str, Procedure]) -> Iterator[str]:
    """Names of the procedures that statements call, and those call in turn."""
    for statement in body:
        if isinstance(statement, Call):
            yield statement.name
            yield from _called(procedures[statement.name].body, procedures)
        elif isinstance(statement, If):
            for _, inner in statement.branches:
                yield from _called(inner, procedures)
        elif isinstance(statement, Do):
            yield from _called(statement.body, procedures)


def _is_for_all(statement: Statement, scope: Scope) -> bool:
    """Whether a statement is the same for all points, so that it stands before the blocks."""
    if isinstance(statement, Assign):
        return True
    return isinstance(statement, Call) and not any(base(a) in scope.lanes for a in statement.arguments)


def _set_once(statements: Sequence[Statement]) -> None:
    """What stands before the blocks must not change within one."""
    names = [base(name) for name in targets(statements)]
    twice = sorted({n for n in names if names.count(n) > 1})
    if twice:
        raise SceneError(f"no batch routine: {twice[0]} is set twice from constants alone")


def _names(statements: Sequence[Statement]) -> set[str]:
    return {base(name) for name in targets(statements)}


def _locals(loops: Loops, arrays: set[str]) -> list[Declare]:
    """Masks inside loops, and arrays over the points."""
    shapes = loops.scope.shapes
    return [
        *(Declare(n, kind=_LOGICAL) for n in loops.hits),
        *(Declare(n, (WIDTH, *shapes.get(n, ()))) for n in sorted(arrays | set(loops.arrays))),
    ]


def _stage(name: str, scopes: Mapping[str, Scope], called: Mapping[str, Procedure]) -> Procedure:
    """A stage over a block."""
    procedure, scope = called[name], scopes[name]
    loops = Loops(name, scopes, called, set(), hot=any(isinstance(s, Do) for s in procedure.body))
    statements, dummies = loops.of(procedure.body), {d.name for d in procedure.arguments}
    statements, arrays = private(statements, _names(procedure.body) & scope.lanes - dummies)
    arguments = tuple(
        Declare(d.name, (WIDTH, *d.shape) if d.name in scope.lanes else d.shape, d.intent) for d in procedure.arguments
    )
    counters = [Declare(POINT, kind=_INTEGER), *(d for d in procedure.declared if d.kind == _INTEGER)]
    return Procedure(name, procedure.heading[:1], arguments, statements, (*counters, *_locals(loops, arrays)))


def _finite_results(shapes: Mapping[str, Shape], scene: Scene) -> list[Statement]:
    names = ["statev", "stress"] + (["ddsdde"] if scene.tangent != "none" else [])
    terms = [f"{n}({i})" for n in names if n in shapes for i in indices(shapes[n])]
    terms += ["sse", "scd"] if scene.energies else []
    sums = [f"({' + '.join(terms[n : n + 6])})" for n in range(0, len(terms), 6)]  # several chains of additions at once
    return [
        Comment("Results that are not finite are left to the scalar routine; a sum is not finite if a term is not."),
        Assign("total", " + ".join(sums)),
        when(".NOT. abs(total) <= huge(1.0d0)", Assign(MARGIN, "0.0d0")),
    ]


def _refusals(scene: Scene, material: Material) -> list[Statement]:
    """What concerns all points is said by the scalar routine."""
    wanted = f"ntens /= {scene.ntens} .OR. nstatv < {len(state_variables(scene))}"
    wanted += "" if scene.baked else f" .OR. nprops /= {len(properties(scene, material.stages))}"
    result: list[Statement] = [Assign("flagged", "1"), when(wanted, Return())]
    if scene.checks and not scene.baked:
        arguments = ("0.0d0", "props", "ifault", "fault_value", "fault_bound")
        result += [Call("check", arguments, 2), when("ifault /= 0", Return())]
    return result


def _packed(scene: Scene) -> list[Statement]:
    states = len(state_variables(scene))
    given = {f"f{n}({POINT},{i},{j})": f"{f}({j},{i},q)" for n, f in ((0, "f_start"), (1, "f_end")) for j in _AXES for i in _AXES}
    given |= {f"dt({POINT})": "dtime(q)"} | {f"statev({POINT},{i})": f"states({i},q)" for i in range(1, states + 1)}
    given |= {f"scd({POINT})": "energies(3,q)"} if scene.energies else {}

    def loop(point: str, directive: str) -> Do:
        body = [Assign(to, value.replace("q)", f"{point})")) for to, value in given.items()]
        return Do(POINT, "1", WIDTH, body, directive)

    rest = Do(POINT, "1", WIDTH, [Assign("q", f"first + min({POINT}, last) - 1"), *loop("q", "").body], NOVECTOR)
    return [
        Comment("A block: one array for each number; behind the last point that is repeated."),
        Assign("last", f"min({WIDTH}, n - first + 1)"),
        If(((f"last == {WIDTH}", [loop(f"first + {POINT} - 1", SIMD)]), ("", [rest]))),
    ]


def _unpacked(scene: Scene) -> list[Statement]:
    states = len(state_variables(scene))
    energies = [Assign("energies(1,q)", f"sse({POINT})"), Assign("energies(3,q)", f"scd({POINT})")]
    return [
        Comment("Results of the points that keep their margin."),
        Do(POINT, "1", "last", [
            when(
                f"{MARGIN}({POINT}) > 0.0d0",
                Assign("q", f"first + {POINT} - 1"),
                Assign("flagged(q)", "0"),
                Assign("stresses(:,q)", f"stress({POINT},:)"),
                *([Assign(f"states(1:{states},q)", f"statev({POINT},:)")] if states else []),
                *(energies if scene.energies else []),
                *([Assign("tangents(:,:,q)", f"ddsdde({POINT},:,:)")] if scene.tangent != "none" else []),
            ),
        ], NOVECTOR),
    ]  # fmt: skip
