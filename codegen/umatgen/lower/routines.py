"""The procedures of a material as nodes: the point routine with its stages inside, the checks, the temperature table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from umatgen.expressions import decimal
from umatgen.lower.creep_stages import path_routine
from umatgen.lower.faults import NO_FAULT, applicable
from umatgen.lower.interface import Property, state_variables, table_quantities
from umatgen.lower.point import point_body, properties, property_places
from umatgen.lower.stage import Stage
from umatgen.model.temperature import cubics
from umatgen.nodes import Assign, Comment, Declare, Exit, If, Procedure, Return, Statement, While, targets, when
from umatgen.scene import Scene

_INTEGER, _LOGICAL = "INTEGER", "LOGICAL"


def stage_routine(stage: Stage) -> Procedure:
    """The procedure of a stage: inputs first, then outputs."""
    ins = [Declare(v.name, v.shape, "in", v.note) for v in stage.inputs]
    outs = [Declare(v.name, v.shape, "out", v.note) for v in stage.outputs]
    heading = [stage.title, *stage.formula, f"Equation: {stage.equation}"]
    for title, declared in (("In:", ins), ("Out:", outs)):
        heading += [title, *(f"  {d.name:<14} {d.note}".rstrip() for d in declared)]
    body = [Assign(a.target, a.expr) for a in stage.assignments]
    arrays = tuple(Declare(v.name, v.shape) for v in stage.local_arrays)
    return Procedure(stage.name, heading, (*ins, *outs), body, arrays)


def arguments(scene: Scene, stages: Sequence[Stage]) -> tuple[Declare, ...]:
    """Dummies of the point routine, in order."""
    n, states = scene.ntens, len(state_variables(scene))
    ins = [Declare("f0", (3, 3), "in"), Declare("f1", (3, 3), "in"), Declare("dt", (), "in")]
    ins += [] if scene.baked else [Declare("props", (len(properties(scene, stages)),), "in")]
    ins += [Declare("kinc", (), "in", kind=_INTEGER)] if scene.creep else []
    ins += [Declare("theta", (), "in")] if scene.table else []
    changed = [Declare("statev", (states,), "inout")] if states else []
    changed += [Declare("stress", (n,), "inout")]
    changed += [Declare("ddsdde", (n, n), "inout")] if scene.tangent != "none" else []
    changed += [Declare("sse", (), "inout"), Declare("scd", (), "inout")] if scene.energies else []
    changed += [Declare("ddsddt", (n,), "inout")] if scene.table else []
    return (*ins, *changed, *_fault_dummies())


def _fault_dummies() -> tuple[Declare, ...]:
    return (Declare("ifault", (), "out", kind=_INTEGER), Declare("fault_value", (), "out"), Declare("fault_bound", (), "out"))


def inner_routines(scene: Scene, stages: Sequence[Stage]) -> list[Procedure]:
    """The procedures of the stages, and the path of a creep-exact increment."""
    return [stage_routine(s) for s in stages] + ([path_routine()] if scene.creep else [])


def point_routine(scene: Scene, stages: Sequence[Stage]) -> Procedure:
    """One increment of one material point."""
    used = properties(scene, stages)
    named = [] if scene.baked else [(i, p.fortran) for i, p in enumerate(used, 1)]
    body = point_body(scene, stages, named)
    inside = inner_routines(scene, stages) if scene.procedures == "internal" else []
    declared = (_FINITE, *_logical(body), *_arrays(scene, stages), *_parameters(scene, used))
    return Procedure("point", _heading(stages), arguments(scene, stages), body, declared, inside)


def _heading(stages: Sequence[Stage]) -> list[str]:
    title = {s.name: s.title for s in stages}
    return [
        "One increment of one material point.",
        "In:  f0, f1 deformation gradients [-], dt [s], props, statev at the start",
        f"Out: stress ({title['stress']}) [MPa], ddsdde ({title.get('tangent', 'not computed')}) [MPa], sse, scd per reference volume "
        "[MPa], statev at the end",
        "     ifault 0, or the number of the fault with the value and the bound it violates; then nothing else is set",
    ]


def _logical(body: Sequence[Statement]) -> list[Declare]:
    return [Declare("locked", kind=_LOGICAL)] if "locked" in set(targets(body)) else []


def _arrays(scene: Scene, stages: Sequence[Stage]) -> list[Declare]:
    """Local arrays: outputs of stages, and the stress before it is handed out."""
    dummies = {d.name for d in arguments(scene, stages)}
    outputs = {v.name: v.shape for s in stages for v in s.outputs if v.shape and v.name not in dummies}
    outputs |= {"sigma": (scene.ntens,)}
    return [Declare(name, shape) for name, shape in outputs.items()]


def _parameters(scene: Scene, used: Sequence[Property]) -> list[Declare]:
    """Named constants."""
    values = {"rounding": "1.0d-6"} if scene.table else {}
    values |= {p.fortran: decimal(dict(scene.baked)[p.name]) for p in used} if scene.baked else {}
    return [Declare(name, value=value) for name, value in values.items()]


_FINITE = Declare("@finite", kind="LOGICAL, EXTERNAL")


def finite_routine() -> Procedure:
    """Whether a number is finite, by its bits."""
    heading = (
        "Whether a number is neither infinite nor NaN, by its bits: comparing values would not survive compilers that assume that "
        "all numbers are finite (-ffast-math).",
    )
    words = Declare("words", kind=_INTEGER, value="storage_size(1.0d0)/64")
    long = Declare("long", kind=_INTEGER, value="selected_int_kind(18)")
    declared = (long, words, Declare("bits", ("words",), kind="INTEGER(long)"), Declare("largest", ("words",), kind="INTEGER(long)"))
    return Procedure("finite", heading, (Declare("number", (), "in"),), [
        Assign("bits", "transfer(number, bits)"),
        Assign("largest", "transfer(huge(number), largest)"),
        Assign("@finite", "ibclr(bits(words), 63) <= largest(words)"),
    ], declared, result="LOGICAL")  # fmt: skip


def check_routine(scene: Scene, stages: Sequence[Stage]) -> Procedure:
    """Checks of the constants and of the time increment."""
    heading = (
        "Checks of the constants and of the time increment; the deformation gradient is checked through its determinant.",
        "Out: ifault 0, or the number of the fault with value and bound",
    )
    dt_is_well = "@finite(dt) .AND. dt >= 0.0d0"
    bad_dt = [Assign("ifault", "13"), Assign("fault_value", "dt")]
    dummies = (Declare("dt", (), "in"), *(() if scene.baked else (_props(scene, stages),)), *_fault_dummies())
    if scene.baked:
        body: list[Statement] = [when(dt_is_well, Return()), *bad_dt]
        return Procedure("check", heading, dummies, [*NO_FAULT, *body], (_FINITE,))
    checks = applicable(property_places(scene, stages), bool(scene.table))
    every = " + ".join([*(f"props({i})" for i in range(1, len(properties(scene, stages)) + 1)), "dt"])
    well = " .AND. ".join([f"@finite({every})", "dt >= 0.0d0", *(c.condition for c in checks)])
    branches = [(f".NOT. ({dt_is_well})", bad_dt), (".NOT. @finite(sum(props))", [Assign("ifault", "24")])]
    for c in checks:
        found = [Assign("ifault", f"{c.number}"), Assign("fault_value", c.value), Assign("fault_bound", c.bound)]
        branches.append((f".NOT. ({c.condition})", found))
    return Procedure("check", heading, dummies, [
        *NO_FAULT,
        Comment("All is well: the usual case, in one go (a sum is not finite if a term is not)."),
        when(well, Return()),
        Comment("Something is not: say what."),
        If(tuple(branches)),
    ], (_FINITE,))  # fmt: skip


def _props(scene: Scene, stages: Sequence[Stage]) -> Declare:
    return Declare("props", (len(properties(scene, stages)),), "in")


def temperature_routine(scene: Scene) -> Procedure:
    """Constants of the material at a temperature, and their slopes."""
    marks = [decimal(t) for t in dict(scene.table)["temperature"]]
    found = cubics(dict(scene.table), table_quantities(scene))
    n = len(marks)
    outs = [Declare(c.name, (), "out") for c in found] + [Declare(f"d{c.name}", (), "out") for c in found]
    constants = [Declare("start", (n,), value=f"[{', '.join(marks)}]")]
    body: list[Statement] = [
        Assign("i", "1"),
        While(f"i < {n - 1}", [when("theta < start(i + 1)", Exit()), Assign("i", "i + 1")]),
        Assign("s", "theta - start(i)"),
    ]
    for c in found:
        pieces = ", ".join(decimal(x) for piece in c.coefficients for x in piece)
        constants.append(Declare(f"c_{c.name}", (4, n - 1), value=f"reshape([{pieces}], [4, {n - 1}])"))
        c3, c2, c1, c0 = (f"c_{c.name}({i},i)" for i in (1, 2, 3, 4))
        body.append(Assign(c.name, f"(({c3}*s + {c2})*s + {c1})*s + {c0}"))
        body.append(Assign(f"d{c.name}", f"(3.0d0*{c3}*s + 2.0d0*{c2})*s + {c1}"))
    heading = (
        "Constants of the material at a temperature, and their slopes: monotone cubics (Fritsch and Carlson, SIAM J. Numer. Anal. "
        "17, 1980) between the temperatures of the table, c3, c2, c1, c0 of each in s = theta - start of the piece.",
        "In:  theta temperature [degC], within the table",
    )
    declared = (Declare("i", kind=_INTEGER), Declare("s"), *constants)
    return Procedure("temperature", heading, (Declare("theta", (), "in"), *outs), body, declared)


@dataclass(frozen=True)
class Material:
    """Everything of a scene that is the same for every host: lowered stages and procedures in order, the point routine first."""

    stages: tuple[Stage, ...]
    routines: tuple[Procedure, ...]

    @property
    def point(self) -> Procedure:
        """One increment of one material point."""
        return self.routines[0]


def assemble(scene: Scene, stages: Sequence[Stage]) -> Material:
    """Stages to procedures: the stages inside the point routine or beside it, then what else it calls."""
    routines = [point_routine(scene, stages)]
    routines += inner_routines(scene, stages) if scene.procedures == "external" else []
    routines += [temperature_routine(scene)] if scene.table else []
    routines += [check_routine(scene, stages)] if scene.checks else []
    routines += [finite_routine()]
    return Material(tuple(stages), tuple(routines))
