"""The point routine as nodes: one increment of one material point, in order, shared by every host."""

from __future__ import annotations

from collections.abc import Sequence

from umatgen.expressions import decimal, expression
from umatgen.lower.interface import HISTORY, PROPERTIES, Property, state_place, state_variables, table_quantities
from umatgen.lower.stage import Stage
from umatgen.model import law_1d, rates, temperature, viscous
from umatgen.model.temperature import QUANTITIES
from umatgen.nodes import Assign, Call, Comment, If, Return, Statement, fault, names, when
from umatgen.scene import Scene

HUGE = "huge(dt)"
NO_FAULT = (Assign("ifault", "0"), Assign("fault_value", "0.0d0"), Assign("fault_bound", "0.0d0"))
FAULT = ("ifault", "fault_value", "fault_bound")


class Calls:
    """CALL statements of the stages that a scene has, with the names that the point routine gives their arguments."""

    def __init__(self, scene: Scene, stages: Sequence[Stage]) -> None:
        self._stages = {stage.name: stage for stage in stages}
        turned = {"f0": "g0", "f1": "g1"} if scene.fibre == "free" else {}
        self._renamed = {name: dict(turned) for name in self._stages if name != "frame"}
        for name in ("gradient", "tangent"):
            if scene.two_step and name in self._stages:
                self._renamed[name]["dt"] = "dt_rate"
        for name in scene.kept_regimes:
            if scene.invariants == "printed":
                self._renamed[name] |= {"stretch": "p_stretch", "a_norm2": "p_norm2"}

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
    frame = calls("frame")
    return [
        *NO_FAULT,
        *_checked(scene),
        *(Assign(name, f"props({index})") for index, name in constants),
        *_temperature(scene),
        *([Comment("Material frame: fibre along axis 1."), *frame] if frame else []),
        *_start(calls),
        *_stage_of_flow(scene),
        *_history(scene),
        *_kinematics(scene, calls),
        *_viscous(scene, calls),
        *_limits(scene),
        *_landing(scene),
        *_elastic(calls),
        *_power(scene),
        *_stress(scene, calls),
        *_thermal_stress(scene),
        *_tangent(scene, calls),
        *_energies(scene, calls),
        *_state(scene),
    ]


def wanted_variables(scene: Scene, stages: Sequence[Stage]) -> set[str]:
    """Results of the stages that the point routine itself reads, beside those it returns."""
    body = point_body(scene, stages, ())
    renamed = {"g0", "g1"} if scene.fibre == "free" else set()
    renamed |= {"p_stretch", "p_norm2"} if scene.invariants == "printed" else set()
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


def _start(calls: Calls) -> list[Statement]:
    return [
        Comment("The start of the increment."),
        *calls("start"),
        when(
            f".NOT. (det_f_start > 0.0d0 .AND. det_f_start <= {HUGE})",
            *fault(11, "det_f_start", unless=(f".NOT. sum(abs(f0)) <= {HUGE}", 12)),
        ),
    ]


def _stage_of_flow(scene: Scene) -> list[Statement]:
    """Which stage of flow the increment belongs to."""
    reached = "x_start <= (lock_stretch*(1.0d0 + landing_tolerance))**2"
    if scene.both_regimes:
        return [
            Comment("Stage of flow: decided by the start of the increment (sec. 4.4, Eq. 6)."),
            Assign("lock_stretch", "0.0d0"),
            Assign("locked", f"statev({state_place(scene, 'locked')}) >= 0.5d0"),
            when(".NOT. locked", Assign("lock_stretch", "exp(eps_lock)"), Assign("locked", reached)),
        ]
    if scene.regimes == "squeeze":
        return [
            Comment("Only the squeezing stage is kept: it ends at the lock."),
            Assign("lock_stretch", "exp(eps_lock)"),
            Assign("locked", ".FALSE."),
            when(reached, *fault(15, "0.5d0*log(x_start)", "eps_lock")),
        ]
    return [
        Comment("Only the bleeding stage is kept: it begins at the lock."),
        when(
            "x_start > (exp(eps_lock)*(1.0d0 + landing_tolerance))**2", *fault(16, "0.5d0*log(x_start)", "eps_lock")
        ),
    ]


def _half_contraction(name: str, ntens: int) -> str:
    return f"0.5d0*sum({name}(1:3)**2) + sum({name}(4:{ntens})**2)"


def _history(scene: Scene) -> list[Statement]:
    """Weight of the last increment in a two-step rate."""
    if not scene.two_step:
        return []
    first, *_, last = [state_place(scene, s.name) for s in HISTORY if state_place(scene, s.name)]
    return [
        Comment(
            "Weight of the last increment: none in the first increment of a step (loads may kink there), after the lock and after an\n"
            "increment at rest, which tells nothing of the rate that follows."
        ),
        Assign("history", "0.0d0"),
        Assign("dt_last", f"statev({last})"),
        Assign("rate_last", f"statev({first}:{last - 1})"),
        Assign("j2_last", _half_contraction("rate_last", scene.ntens)),
        Assign("j2_floor", rates.floor()),
        when("kinc > 1 .AND. dt_last > 0.0d0 .AND. j2_last > j2_floor", Assign("history", "dt/(dt + dt_last)")),
    ]


def _kinematics(scene: Scene, calls: Calls) -> list[Statement]:
    return [
        Comment("Kinematics (Eq. 9, sec. 4.2-4.3); the floor keeps the tangent finite at zero rate."),
        *([] if scene.two_step else [Assign("j2_floor", rates.floor())]),
        *calls("kinematics"),
        when(
            f".NOT. (det_f > 0.0d0 .AND. det_f <= {HUGE})",
            *fault(2, "det_f", unless=(f".NOT. sum(abs(f1)) <= {HUGE}", 1)),
        ),
        *calls("transverse"),
        *([Assign("eps", "log(stretch)")] if scene.outputs == "full" else []),
    ]


def _viscous(scene: Scene, calls: Calls) -> list[Statement]:
    branches = {name: _flow(scene, calls, name) for name in scene.kept_regimes}
    body: list[Statement] = [Comment("Viscous factor (Eqs. 13-15)."), Assign("j2_eff", viscous.floored_j2())]
    if scene.both_regimes:
        return [*body, If((("locked", branches["bleed"]), ("", branches["squeeze"])))]
    return body + branches[scene.regimes]


def _flow(scene: Scene, calls: Calls, name: str) -> list[Statement]:
    """The viscous factor of one stage of flow, and the constraint that goes with it."""
    body: list[Statement] = [Assign("b_log", f"b_{name}")]
    body += [Assign("db_log", f"db_{name}")] if scene.table else []
    squeeze = name == "squeeze"
    body += [Assign("kappa_eff", "kappa" if squeeze else "0.0d0")] if scene.has_volume else []
    if scene.augmented:
        body.append(Assign("p_start", f"statev({state_place(scene, 'pressure')})" if squeeze else "0.0d0"))
    return body + calls(f"printed_{name}", name)


def _limits(scene: Scene) -> list[Statement]:
    """The compaction limit, and the reality of the printed invariants."""
    body: list[Statement] = []
    if scene.invariants == "printed":
        smooth = f" .AND. abs(dstretch_di1) <= {HUGE}" if scene.tangent in ("consistent", "symmetric") else ""
        body.append(when(f".NOT. (p_stretch > 0.0d0{smooth})", *fault(4, "(i1 - 1.0d0)**2 - 4.0d0*det_f**2")))
    beyond = fault(3, "stretch", "stretch_limit")
    beyond[-1:-1] = [when("x_start <= stretch_limit**2", Assign("ifault", "14"))]
    if scene.lands:
        chord = "log(x_start/lock_stretch**2)/log(x_start/stretch**2)"
        asked = Assign("pnewdt", f"min(pnewdt, max(smallest_fraction**2, {chord}))")
        beyond[-1:-1] = [when(".NOT. locked", asked)]
    body.append(when(".NOT. gap > 0.0d0", *beyond))
    if scene.checks:
        body.append(when(".NOT. x_start > stretch_limit**2", *fault(14, "sqrt(x_start)", "stretch_limit")))
    return body


def _landing(scene: Scene) -> list[Statement]:
    """Ask for the fraction of the increment that ends at the lock."""
    if not scene.lands:
        return []
    ratio = expression(law_1d.squeeze_viscosity_ratio())
    rate = f"abs(eps_rate)*dt*({ratio})**(1.0d0/(a_rate + 1.0d0))"
    return [
        Comment(
            "Landing on the lock: ask for the fraction of the increment that ends there. Strain is far from linear in time: the mean\n"
            "(geometric) of the chord and of the time that the creep rate at the lock under the same load would take (Eqs. 1-5)."
        ),
        when(
            ".NOT. locked .AND. stretch < lock_stretch*(1.0d0 - landing_tolerance)",
            Assign("chord", "log(x_start/lock_stretch**2)/log(x_start/stretch**2)"),
            Assign("fraction", f"0.5d0*log(x_start/lock_stretch**2)/({rate})"),
            Assign("fraction", "sqrt(chord*min(chord, max(smallest_fraction, fraction)))"),
            Assign("pnewdt", "min(pnewdt, max(smallest_fraction**2, fraction))"),
        ),
    ]


def _elastic(calls: Calls) -> list[Statement]:
    found = calls("elastic")
    head = [Comment("Elastic and volumetric part (Eqs. 8, 10).")] if found else []
    return [*head, *calls("moduli"), *found]


def _power(scene: Scene) -> list[Statement]:
    """Viscous power; with a two-step rate the work on the increment itself, which did not go with the rate at its end."""
    if not scene.energies:
        return []
    if not scene.two_step:
        return [Assign("power", viscous.power())]
    mixed = f"0.5d0*sum(cdot(1:3)*rate_mean(1:3)) + sum(cdot(4:{scene.ntens})*rate_mean(4:{scene.ntens}))"
    return [
        Comment("Work of the viscous stress on the increment itself: the rate at its end is not the one it went with."),
        Assign("power", f"g_visc*max(0.0d0, {mixed})"),
    ]


def _stress(scene: Scene, calls: Calls) -> list[Statement]:
    total = " + ".join(f"stress({i})" for i in range(1, scene.ntens + 1))
    finite = when(f".NOT. abs({total}) <= {HUGE}", *fault(5, "sum(abs(stress))", HUGE))
    return [
        Comment("Cauchy stress (Eq. 9) and tangent (Eqs. 16-17)."),
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
    body: list[Statement] = []
    if scene.two_step and scene.tangent != "none":
        body += [
            Comment("dCdot = (dt/dt_rate) dr: the two-step formula weighs the rate of this increment more."),
            Assign("dt_rate", f"dt/({expression(rates.rate_formula(scene.integrator).slope)})"),
        ]
    body += _first_tangent(scene) if scene.keeps_last_rate else []
    return body + calls("gradient", "tangent")


def _first_tangent(scene: Scene) -> list[Statement]:
    """The tangent at vanishing rate."""
    rate = f"statev({state_place(scene, 'eps_rate')})"
    by_stage = {name: expression(viscous.normaliser(name)) + f"*{rate}**2" for name in scene.kept_regimes}
    last: list[Statement] = [Assign("j2_last", by_stage[scene.kept_regimes[0]])]
    last += [when("locked", Assign("j2_last", by_stage["bleed"]))] if scene.both_regimes else []
    scaled: list[Statement] = [Assign("g_visc", "g_visc*" + expression(viscous.ratio_of_secants()))]
    at_rest = "j2 <= j2_floor"
    note = (
        "At vanishing rate (a first iteration without extrapolation) the tangent is the secant at the last converged rate, with\n"
        "J2 as the law's own normaliser has it; the stress is not touched."
    )
    comments: list[Statement] = [Comment(note)]
    if scene.integrator == "bdf2":
        comments.append(Comment("The rate is the mean one: where it vanishes, that at the end would run against the last."))
        at_rest = f"{_half_contraction('rate_mean', scene.ntens)} <= j2_floor"
        scaled.append(Assign("dlng_j2", "0.0d0"))
    if scene.integrator == "bdf2log":
        scaled += [Assign("dt_rate", "dt"), Assign("turn_slope", "0.0d0"), Assign("turn_dyad", "0.0d0")]
    return [*comments, when(at_rest, *last, when("j2_last > j2_eff", *scaled))]


def _energies(scene: Scene, calls: Calls) -> list[Statement]:
    if not scene.energies:
        return []
    stored = "energy" if calls("elastic") else "0.0d0"
    return [Comment("Energies per reference volume."), Assign("sse", stored), Assign("scd", "scd + dt*power")]


def _state(scene: Scene) -> list[Statement]:
    """State variables at the end of the increment."""
    kept = state_variables(scene)
    body: list[Statement] = [Comment("State at the end of the increment.")] if kept else []
    reached = "stretch <= lock_stretch*(1.0d0 + landing_tolerance)"
    for place, variable in enumerate(kept, 1):
        target = f"statev({place})"
        if variable.name == "locked":
            body += [Assign(target, "0.0d0"), when(f"locked .OR. {reached}", Assign(target, "1.0d0"))]
        elif variable.name == "dissipation":
            body.append(Assign(target, f"{target} + dt*power"))
        else:
            body.append(Assign(target, variable.value))
        if variable.name == "dt_last" and scene.lands and scene.both_regimes:
            body.append(when(f".NOT. locked .AND. {reached}", Assign(target, "0.0d0")))
    return body
