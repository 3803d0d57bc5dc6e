"""The procedures of a batch: the point routine and its stages over blocks of points, and what surrounds a block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from umatgen.lower.interface import state_variables
from umatgen.lower.lanes import MARGIN, NOVECTOR, POINT, WIDTH, Lanes, Scope, indices, one_call, private, spread, without_faults
from umatgen.lower.point import properties
from umatgen.lower.routines import Material
from umatgen.nodes import Assign, Call, Comment, Declare, Do, If, Procedure, Return, Statement, base, targets, when
from umatgen.scene import Scene, SceneError

WIDTH_OF_BLOCK = 8
_UNIFORM = {"props", "kinc", "ifault", "fault_value", "fault_bound"}
_INTEGER, _LOGICAL = "INTEGER", "LOGICAL"


def check(scene: Scene) -> None:
    """Refuse a scene that has no batch routine.

    Raises
    ------
    SceneError
        Names the field and its value.
    """
    if scene.without_batch:
        raise SceneError(f"scene '{scene.name}': {scene.without_batch}")


def batch_routine(scene: Scene, material: Material) -> Procedure:
    """Calls at many points, block by block.

    Raises
    ------
    SceneError
        The scene has no batch routine.
    """
    check(scene)
    point = material.point
    procedures = {p.name: p for p in (*point.inside, *material.routines[1:])}
    shapes = Scope.of(point).shapes
    body = [Assign(MARGIN, "1.0d0"), *one_call(without_faults(point.body, shapes)), *_finite_results(shapes, scene)]
    called = {n: procedures[n] for n in _called(body)}
    scopes = spread(point, body, called, _UNIFORM)
    lanes = Lanes(scopes[""], scopes, called, {MARGIN, *(f"statev({i})" for i in indices(shapes.get("statev", (0,))))} | {"scd"})
    statements = lanes.of(body)
    once = [s for s in statements if _is_for_all(s, scopes[""])]
    statements = [s for s in statements if not _is_for_all(s, scopes[""])]
    given = {"f0", "f1", "dt", "statev", "stress", "ddsdde", "sse", "scd", MARGIN} & (scopes[""].lanes | {MARGIN})
    names = {base(t).split("%")[0] for t in targets(statements)} & scopes[""].lanes
    statements, arrays = private(statements, names - given)
    arrays |= given & (names | {d.name for d in point.arguments} | {MARGIN})
    declared = [Declare(n, (WIDTH, *scopes[""].shapes.get(n, ()))) for n in sorted(arrays | set(lanes.arrays))]
    inside = [stage(called[n], scopes[n], scopes, called) for n in called]
    loop = Do("first", "1", f"n, {WIDTH}", [*_packed(scene), *statements, *_unpacked(scene)])
    return Procedure(
        "batch", _HEADING, _arguments(), [*_refusals(scene, material), *once, loop],
        (
            Declare(WIDTH, kind=_INTEGER, value=str(WIDTH_OF_BLOCK)),
            *(d for d in point.declared if d.value),
            *(Declare(n, kind=_INTEGER) for n in ("first", "last", POINT, "q", "ifault")),
            *(Declare(n, kind=_LOGICAL) for n in lanes.hits),
            *declared,
        ), inside,
    )  # fmt: skip


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


def _called(body: Sequence[Statement]) -> list[str]:
    """Names of the procedures that statements call, in order."""
    found: dict[str, None] = {}
    for statement in body:
        if isinstance(statement, Call):
            found[statement.name] = None
        elif isinstance(statement, If):
            found |= dict.fromkeys(name for _, inner in statement.branches for name in _called(inner))
        elif isinstance(statement, Do):
            found |= dict.fromkeys(_called(statement.body))
    return list(found)


def _is_for_all(statement: Statement, scope: Scope) -> bool:
    """Whether a statement is the same for all points, so that it stands before the blocks."""
    if isinstance(statement, Assign):
        return True
    return isinstance(statement, Call) and not any(base(a) in scope.lanes for a in statement.arguments)


def stage(procedure: Procedure, scope: Scope, scopes: dict[str, Scope], called: dict[str, Procedure]) -> Procedure:
    """A stage over a block: what is the same for all points first, then the loop over them."""
    lanes = Lanes(scope, scopes, called, set(), hot=any(isinstance(s, Do) for s in procedure.body))
    statements, dummies = lanes.of(procedure.body), {d.name for d in procedure.arguments}
    names = set(targets(procedure.body)) & scope.lanes
    statements, arrays = private(statements, names - dummies)
    arguments = tuple(
        Declare(d.name, (WIDTH, *d.shape) if d.name in scope.lanes else d.shape, d.intent, d.note) for d in procedure.arguments
    )
    declared = (
        Declare(POINT, kind=_INTEGER),
        *(d for d in procedure.declared if d.kind == _INTEGER),
        *(Declare(n, kind=_LOGICAL) for n in lanes.hits),
        *(Declare(n, (WIDTH, *scope.shapes.get(n, ()))) for n in sorted(arrays | set(lanes.arrays))),
    )
    return Procedure(procedure.name, procedure.heading[:1], arguments, statements, declared)


def _finite_results(shapes: Mapping[str, tuple[int | str, ...]], scene: Scene) -> list[Statement]:
    """The margin is lost where a result is not finite: its sum is not."""
    names = ["statev", "stress"] + (["ddsdde"] if scene.tangent != "none" else [])
    terms = [f"{n}({i})" for n in names if n in shapes for i in indices(shapes[n])]
    terms += ["sse", "scd"] if scene.energies else []
    return [
        Comment("A sum is not finite if a term is not."),
        Assign("total", " + ".join(terms)),
        when(".NOT. abs(total) <= huge(1.0d0)", Assign(MARGIN, "0.0d0")),
    ]


def _refusals(scene: Scene, material: Material) -> list[Statement]:
    wanted = f"ntens /= {scene.ntens} .OR. nstatv < {len(state_variables(scene))}"
    wanted += "" if scene.baked else f" .OR. nprops /= {len(properties(scene, material.stages))}"
    result: list[Statement] = [Assign("flagged", "1"), when(wanted, Return())]
    if scene.checks and not scene.baked:
        arguments = ("0.0d0", "props", "ifault", "fault_value", "fault_bound")
        result += [Call("check", arguments, 2), when("ifault /= 0", Return())]
    return result


def _packed(scene: Scene) -> list[Statement]:
    """A block, one array for each number; behind the last point it is repeated."""
    states = len(state_variables(scene))
    return [
        Assign("last", f"min({WIDTH}, n - first + 1)"),
        Do(POINT, "1", WIDTH, [
            Assign("q", f"first + min({POINT}, last) - 1"),
            Assign(f"f0({POINT},:,:)", "transpose(f_start(:,:,q))"),
            Assign(f"f1({POINT},:,:)", "transpose(f_end(:,:,q))"),
            Assign(f"dt({POINT})", "dtime(q)"),
            *([Assign(f"statev({POINT},:)", f"states(1:{states},q)")] if states else []),
            *([Assign(f"scd({POINT})", "energies(3,q)")] if scene.energies else []),
        ], NOVECTOR),
    ]  # fmt: skip


def _unpacked(scene: Scene) -> list[Statement]:
    """Results of the points that keep their margin."""
    states = len(state_variables(scene))
    return [
        Do(POINT, "1", "last", [
            when(f"{MARGIN}({POINT}) > 0.0d0",
                Assign("q", f"first + {POINT} - 1"),
                Assign("flagged(q)", "0"),
                Assign("stresses(:,q)", f"stress({POINT},:)"),
                *([Assign(f"states(1:{states},q)", f"statev({POINT},:)")] if states else []),
                *([Assign("energies(1,q)", f"sse({POINT})"), Assign("energies(3,q)", f"scd({POINT})")] if scene.energies else []),
                *([Assign("tangents(:,:,q)", f"ddsdde({POINT},:,:)")] if scene.tangent != "none" else []),
            ),
        ], NOVECTOR),
    ]  # fmt: skip
