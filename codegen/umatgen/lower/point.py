"""The point routine as nodes: one increment of one material point, in order, shared by every host."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from umatgen.expressions import decimal, expression
from umatgen.lower.interface import HISTORY, PROPERTIES, Property, state_place, state_variables, table_quantities
from umatgen.lower.stage import Stage
from umatgen.model import creep, lock, printed_invariants, rates, temperature, viscous
from umatgen.model.tangent import VARIABLES
from umatgen.model.temperature import QUANTITIES
from umatgen.nodes import Assign, Call, Comment, If, Return, Statement, fault, handed_on, names, when
from umatgen.scene import Scene

NO_FAULT = (Assign("ifault", "0"), Assign("fault_value", "0.0d0"), Assign("fault_bound", "0.0d0"))
FAULT = ("ifault", "fault_value", "fault_bound")


PART_OF_GAP = 0.1  # what a first iteration may take of it: after a fast ramp the last rate would carry a long increment past the limit


class Calls:
    """CALL statements of the stages that a scene has, with the names that the point routine gives their arguments."""

    def __init__(self, scene: Scene, stages: Sequence[Stage]) -> None:
        self._stages = {stage.name: stage for stage in stages}
        turned = {"f0": "g0", "f1": "g1"} if scene.free else {}
        self._renamed = {name: {"stress": "sigma"} | turned for name in self._stages if name != "frame"}
        if "counted" in self._stages:
            self._renamed["gradient"][self.rate] = "y_counted"
        for name in scene.kept_regimes:
            if scene.compaction == "printed":
                self._renamed[name] |= {"stretch": "p_stretch", "a_norm2": "p_norm2"}
            if scene.creep:
                self._renamed[name] |= {"g_visc": "g_flow"} | {f"dlng_{v.name}": f"dflow_{v.name}" for v in VARIABLES}

    @property
    def rate(self) -> str:
        """The array of the rate of C that the tangent uses: in space, or in the material frame."""
        return "y_rate" if any(v.name == "y_rate" for v in self._stages["kinematics"].outputs) else "cdot"

    def title(self, name: str) -> str:
        """What a stage computes."""
        return self._stages[name].title

    def __call__(self, *names: str) -> list[Statement]:
        """Calls of those of the stages that there are, in order."""
        return [self._call(self._stages[name]) for name in names if name in self._stages]

    def _call(self, stage: Stage) -> Call:
        rename = self._renamed.get(stage.name, {})
        actual = tuple(rename.get(v.name, v.name) for v in (*stage.inputs, *stage.outputs))
        return Call(stage.name, actual, len(stage.inputs))


def point_body(scene: Scene, stages: Sequence[Stage], constants: Sequence[tuple[int, str]]) -> list[Statement]:
    """All statements of the point routine; `constants` are numbers and names of PROPS."""
    calls = Calls(scene, stages)
    body: list[Statement] = [
        *_temperature(scene),
        *_frame(scene, calls),
        *_deformation(calls),
        *_stage_of_flow(scene),
        *_time(scene),
        *calls("kinematics"),
        *_counted(scene, calls),
        *_viscous(scene, calls),
        *_limits(scene),
        *_creep(scene, calls),
        *_elastic(calls),
        *_power(scene),
        *_stress(scene, calls),
        *_thermal_stress(scene),
        *_tangent(scene, calls),
        *_results(scene, calls),
        *_state(scene),
    ]
    return [*NO_FAULT, *_checked(scene), *_named_where_needed(body, {name: f"props({i})" for i, name in constants})]


def _named_where_needed(body: Sequence[Statement], constants: Mapping[str, str]) -> list[Statement]:
    """Each constant is taken out of PROPS right before the first statement that reads it; in a branch, if only that reads it."""
    result: list[Statement] = []
    left = dict(constants)
    for place, statement in enumerate(body):
        needed = {name: text for name, text in left.items() if name in _read([statement])}
        left = {name: text for name, text in left.items() if name not in needed}
        if isinstance(statement, If):
            inside = {name: text for name, text in needed.items() if name not in _read(body[place + 1 :])}
            statement, needed = _named_in_branches(statement, needed, inside)  # noqa: PLW2901
        result += [Assign(name, text) for name, text in needed.items()]
        result.append(statement)
    return result


def _named_in_branches(statement: If, needed: Mapping[str, str], inside: Mapping[str, str]) -> tuple[If, dict[str, str]]:
    """The statement with those of `inside` named in the one branch that reads them, and what is still needed before it."""
    conditions = names([If(tuple((condition, ()) for condition, _ in statement.branches))])
    branches, rest = [], dict(needed)
    for condition, body in statement.branches:
        others = [other for _, other in statement.branches if other is not body]
        read_outside = conditions.union(*(_read(other) for other in others))
        own = {name: text for name, text in inside.items() if name in _read(body) and name not in read_outside}
        rest = {name: text for name, text in rest.items() if name not in own}
        branches.append((condition, _named_where_needed(body, own)))
    return If(tuple(branches)), rest


def _read(statements: Sequence[Statement]) -> set[str]:
    """Names that statements read, or hand to what they call."""
    return names(statements) | handed_on(statements)


def wanted_variables(scene: Scene, stages: Sequence[Stage]) -> set[str]:
    """Results of the stages that the point routine itself reads, beside those it returns."""
    body = point_body(scene, stages, ())
    renamed = {"g0", "g1"} if scene.free else set()
    renamed |= {"y_counted"}
    renamed |= {"p_stretch", "p_norm2"} if scene.compaction == "printed" else set()
    return {"stress", "ddsdde"} | names(body) | renamed


def properties(scene: Scene, stages: Sequence[Stage]) -> list[Property]:
    """The material constants that a scene uses, in the fixed order."""
    used = {v.name for stage in stages for v in stage.inputs} | names(point_body(scene, stages, ()))
    used -= set(QUANTITIES.values()) if scene.table else set()
    return [p for p in PROPERTIES if p.fortran in used]


def property_places(scene: Scene, stages: Sequence[Stage]) -> dict[str, str]:
    """Place in PROPS of each constant by manifest name."""
    return {p.name: f"props({i})" for i, p in enumerate(properties(scene, stages), 1)}


def _checked(scene: Scene) -> list[Statement]:
    if not scene.checks:
        return []
    given = ("dt",) if scene.baked else ("dt", "props")
    return [Call("check", (*given, *FAULT), len(given)), when("ifault /= 0", Return())]


def _temperature(scene: Scene) -> list[Statement]:
    """k, a and b at the end of the increment."""
    if not scene.table:
        return []
    marks = dict(scene.table)["temperature"]
    low, high = decimal(marks[0]), decimal(marks[-1])
    results = [QUANTITIES[n] for n in table_quantities(scene)]
    outside = fault(18, "theta", high)
    outside[-1:-1] = [when(f"theta < {low}", Assign("fault_bound", low))]
    return [
        Comment("k, a and b at the temperature of the end of the increment; TEMP + DTEMP may miss the end of the table by rounding."),
        when(f".NOT. (theta >= {low} - rounding .AND. theta <= {high} + rounding)", *outside),
        Call("temperature", ("theta", *results, *(f"d{name}" for name in results)), 1),
    ]


def _frame(scene: Scene, calls: Calls) -> list[Statement]:
    if not scene.free:
        return []
    parallel = when(".NOT. sine2 > 1.0d-12", *fault(17, "sine2", "1.0d-12"))
    return [Comment("Material frame: fibre along axis 1, ply normal along axis 3."), *calls("frame"), parallel]


def _deformation(calls: Calls) -> list[Statement]:
    """The deformation gradients at both ends of the increment: with a finite (every entry is a factor in it), positive determinant."""
    body: list[Statement] = [Comment("Volume ratio and compaction stretch at the start and at the end of the increment.")]
    for stage, det_f, number in (("start", "det_f_start", 11), ("compaction", "det_f", 1)):
        not_finite, not_positive = (12, 11) if number == 11 else (1, 2)
        body += calls(stage)
        body += [
            when(f".NOT. @finite({det_f})", *fault(not_finite, det_f)),
            when(f".NOT. {det_f} > 0.0d0", *fault(not_positive, det_f)),
        ]
    return body


def _stage_of_flow(scene: Scene) -> list[Statement]:
    """Which stage of flow the increment belongs to."""
    at_lock = Assign("x_lock", lock.squared_lock_stretch())
    aspect = Assign("root_chi_l", viscous.root_aspect())
    if scene.both_regimes:
        crossing = when(".NOT. locked .AND. x_start > x_lock", Assign("widening", lock.widening()))
        return [
            Comment(
                "Stage of flow by the end of the increment (sec. 4.4, Eq. 6); once locked stays locked. In the increment that "
                "passes the lock the rate in the ply plane is counted from the width at the lock."
            ),
            aspect,
            at_lock,
            Assign("locked", f"statev({state_place(scene, 'locked')}) >= 0.5d0"),
            Assign("widening", "1.0d0"),
            Assign("in_plane", "1.0d0"),
            when("x_end <= x_lock", crossing, Assign("locked", ".TRUE.")),
            when("widening > 1.0d0", Assign("in_plane", "0.0d0")),
        ]
    if scene.regimes == "squeeze":
        return [
            Comment("Only the squeezing stage is kept: it ends at the lock."),
            aspect,
            at_lock,
            when("x_start <= x_lock", *fault(15, "0.5d0*log(x_start)", "eps_lock")),
            when("x_end <= x_lock", *fault(6, "0.5d0*log(x_end)", "eps_lock")),
        ]
    return [
        Comment("Only the bleeding stage is kept: it begins at the lock, to 1e-5 of strain."),
        aspect,
        at_lock,
        when("x_start > 1.00002d0*x_lock", *fault(16, "0.5d0*log(x_start)", "eps_lock")),
    ]


def _time(scene: Scene) -> list[Statement]:
    """The rate of an increment that takes no time is zero, and its tangent that of one second at the last rate."""
    body: list[Statement] = [
        Comment("Kinematics (Eq. 9); the floor keeps the tangent finite at zero rate. An increment without time has no rate."),
        Assign("per_time", "0.0d0"),
        when("dt >= 1.0d-100", Assign("per_time", "1.0d0/dt")),
        Assign("j2_floor", rates.floor()),
    ]
    return body


def _counted(scene: Scene, calls: Calls) -> list[Statement]:
    """The right factor of the viscous dyad: the rate that J2 counts."""
    found = calls("counted")
    return [Assign("y_counted", calls.rate), when("widening > 1.0d0", *found)] if found else []


def _viscous(scene: Scene, calls: Calls) -> list[Statement]:
    branches = {name: _flow(scene, calls, name) for name in scene.kept_regimes}
    body: list[Statement] = [Assign("eps", "log(stretch)")] if scene.outputs == "full" else []
    body += [Comment("Viscous factor (Eqs. 13-15)."), Assign("j2_eff", viscous.floored_j2())]
    if scene.both_regimes:
        return [*body, If((("locked", branches["bleed"]), ("", branches["squeeze"])))]
    return body + branches[scene.regimes]


def _flow(scene: Scene, calls: Calls, name: str) -> list[Statement]:
    """The viscous factor of one stage of flow, and the constraint that goes with it."""
    body: list[Statement] = [Assign("b_log", f"b_{name}")]
    body += [Assign("db_log", f"db_{name}")] if scene.table else []
    squeeze = name == "squeeze"
    body += [Assign("kappa_eff", "kappa" if squeeze else "0.0d0")] if scene.has_volume else []
    body += [Assign("kappa_held", "0.0d0" if squeeze else "kappa")] if scene.holds_width else []
    if scene.augmented:
        body.append(Assign("p_start", f"statev({state_place(scene, 'pressure')})" if squeeze else "0.0d0"))
    if scene.compaction == "printed":
        real = expression(printed_invariants.reality(name))
        sign = ">" if scene.tangent in ("consistent", "symmetric") else ">="
        body.append(when(f".NOT. {real} {sign} 0.0d0", *fault(4, real)))
    return body + calls(f"printed_{name}", name)


def _limits(scene: Scene) -> list[Statement]:
    """The compaction limit."""
    body: list[Statement] = [
        when(".NOT. gap > 0.0d0", *fault(3, "stretch", "stretch_limit", unless=("x_start <= stretch_limit**2", 14)))
    ]
    if scene.checks:
        body.append(when(".NOT. x_start > stretch_limit**2", *fault(14, "sqrt(x_start)", "stretch_limit")))
    return body


def _creep(scene: Scene, calls: Calls) -> list[Statement]:
    """The mean over the strain path, and what the load does after it."""
    if not scene.creep:
        return []
    places = [state_place(scene, s.name) for s in HISTORY]
    smooth = f"kinc > 1 .AND. per_time > 0.0d0 .AND. statev({places[0]}) > 0.0d0"
    quotient, slope = creep.quotient()
    small = decimal(creep.SMALL_STRAIN)
    return [
        Comment(
            "Mean of the viscosity over the strain path of the increment, through the lock where it is passed: exact for creep "
            "under a constant load, whatever the increment."
        ),
        Assign("exponent", "1.0d0/(a_rate + 1.0d0)"),
        Assign("stretch_start", "sqrt(x_start)"),
        Assign("delta", "stretch_start/stretch - 1.0d0"),
        Assign("quotient", "1.0d0 + 0.5d0*delta"),
        Assign("quotient_slope", "0.5d0"),
        when(f"abs(delta) > {small}", Assign("quotient", quotient), Assign("quotient_slope", slope)),
        *_path(scene, calls),
        *calls("creep"),
        Comment(
            "A load that changes: taken as linear over this increment and the last where it rises. Not in the first increment of a "
            "step, where loads may kink, nor where the compaction rests or turns: their mean counts as the load at their end, and "
            "as a last increment without length."
        ),
        Assign("log_growth", "0.0d0"),
        Assign("history", "0.0d0"),
        Assign("dt_last", "0.0d0"),
        when(
            f"{smooth} .AND. eps_rate*statev({state_place(scene, 'eps_rate')}) > 0.0d0",
            Assign("dt_last", "dt"),
            Assign("ratio", f"min(statev({places[1]})/dt, {decimal(creep.LONGEST_LAST)})"),
            Call("ramp", (f"log(mean_stress/statev({places[0]}))", "ratio", "exponent", "log_growth", "history"), 3),
        ),
        *calls("load"),
    ]


def _path(scene: Scene, calls: Calls) -> list[Statement]:
    """The mean over the path of the stage in force; over both where the lock is passed."""

    def path(near: str, far: str, name: str, mean: str, slope: str) -> Call:
        plus, power = (f"{n}.0d0" for n in creep.PATH[name])
        return Call("path", (near, far, "stretch_limit", plus, power, "exponent", mean, slope), 6)

    whole = {name: path("stretch", "stretch_start", name, "path_mean", "path_slope") for name in scene.kept_regimes}
    share = expression(creep.share_across())
    before: list[Statement] = [Assign("squeeze", "1.0d0"), Assign("across", share)]
    after: list[Statement] = [Assign("squeeze", "0.0d0"), Assign("across", "0.0d0")]
    if not scene.both_regimes:
        return [*(before if scene.regimes == "squeeze" else after), whole[scene.regimes]]
    crossing: list[Statement] = [
        Assign("lock_stretch", "sqrt(x_lock)"),
        path("stretch", "lock_stretch", "bleed", "near_mean", "near_slope"),
        path("lock_stretch", "stretch_start", "squeeze", "far_mean", "path_slope"),
        *calls("join"),
    ]
    return [
        *after,
        If((
            ("widening > 1.0d0", crossing),
            ("locked", [whole["bleed"]]),
            ("", [*before, whole["squeeze"]]),
        )),
    ]  # fmt: skip


def _elastic(calls: Calls) -> list[Statement]:
    found = calls("elastic")
    head = [Comment("Elastic and volumetric part (Eqs. 8, 10).")] if found else []
    return [*head, *calls("moduli"), *found]


def _power(scene: Scene) -> list[Statement]:
    return [Assign("power", viscous.power())] if scene.energies and not scene.creep else []


def _stress(scene: Scene, calls: Calls) -> list[Statement]:
    total = " + ".join(f"sigma({i})" for i in range(1, scene.ntens + 1))
    finite = when(f".NOT. @finite({total})", *fault(5, "sum(abs(sigma))", "huge(dt)"))
    return [
        Comment(f"{calls.title('stress')} and tangent (Eqs. 8, 9, 16, 17)."),
        *calls("stress"),
        *([finite] if scene.checks else []),
    ]


def _thermal_stress(scene: Scene) -> list[Statement]:
    if not scene.table:
        return []
    return [
        Comment("Change of the stress with temperature: through k, a and b of the viscous part, at fixed deformation."),
        Assign("dlng_dtheta", temperature.slope_of_log_g()),
        Assign("ddsddt", temperature.stress_slope()),
    ]


def _tangent(scene: Scene, calls: Calls) -> list[Statement]:
    if scene.tangent == "none":
        return []
    return [
        Assign("dt_rate", "dt"),
        when(".NOT. per_time > 0.0d0", Assign("dt_rate", "1.0d0")),
        *(_first_tangent(scene) if scene.keeps_last_rate else []),
        *calls("gradient", "tangent"),
    ]


def _first_tangent(scene: Scene) -> list[Statement]:
    """The tangent at vanishing rate."""
    rate = f"abs(statev({state_place(scene, 'eps_rate')}))"
    by_stage = {name: expression(viscous.normaliser(name)) + "*rate_last**2" for name in scene.kept_regimes}
    last: list[Statement] = [
        Assign("rate_last", f"min({rate}, {decimal(PART_OF_GAP)}*gap/(stretch*dt_rate))"),
        Assign("j2_last", by_stage[scene.kept_regimes[0]]),
    ]
    last += [when("locked", Assign("j2_last", by_stage["bleed"]))] if scene.both_regimes else []
    note = (
        "At vanishing rate (a first iteration without extrapolation, or no time) the tangent is the secant at the last converged "
        "rate, but not one that would use up a tenth of the gap to the limit; J2 as the law's own normaliser has it. The stress "
        "is not touched."
    )
    secant = Assign("g_visc", "g_visc*" + expression(viscous.ratio_of_secants()))
    return [Comment(note), when("j2 <= j2_floor", *last, when("j2_last > j2_eff", secant))]


def _results(scene: Scene, calls: Calls) -> list[Statement]:
    """Stress and energies, now that nothing can go wrong any more."""
    body: list[Statement] = [Assign("stress", "sigma")]
    if scene.energies:
        stored = "energy" if calls("elastic") else "0.0d0"
        body += [Comment("Energies per reference volume."), Assign("sse", stored), Assign("scd", "scd + dt*power")]
    return body


def _state(scene: Scene) -> list[Statement]:
    """State variables at the end of the increment."""
    kept = state_variables(scene)
    body: list[Statement] = [Comment("State at the end of the increment.")] if kept else []
    values = {"dissipation": "{} + dt*power", "fibre_fraction": f"{decimal(scene.fibre_fraction)}/det_f", "locked": "0.0d0"}
    if scene.creep:
        values["eps_rate"] = "rate_end"
    for place, variable in enumerate(kept, 1):
        target = f"statev({place})"
        assign = Assign(target, values.get(variable.name, variable.value).format(target))
        body.append(when("per_time > 0.0d0", assign) if variable.name in _OF_THE_RATE else assign)
        if variable.name == "locked":
            body.append(when("locked", Assign(target, "1.0d0")))
    return body


_OF_THE_RATE = {"eps_rate", "mean_stress", "dt_last"}  # kept by an increment without time
