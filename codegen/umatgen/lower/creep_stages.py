"""Stages of the creep-exact increment, and the loop over the strain path as a procedure (`umatgen.model.creep`)."""

from __future__ import annotations

import sympy as sp

from umatgen.expressions import decimal
from umatgen.lower.assign import Assignment, element, from_definitions
from umatgen.lower.stage import Stage, make_stage
from umatgen.model import creep
from umatgen.model.chain import Chain
from umatgen.model.tangent import VARIABLES, slope_name
from umatgen.nodes import Assign, Call, Declare, Do, If, Procedure, Statement, when
from umatgen.notation import sym


def path_routine() -> Procedure:
    """Mean of the viscosity's power over the stretches s from `near` to `far`, and its derivative by `near`."""
    near, far, place, left, step, wide, mean = (element(n) for n in ["near", "far", "place", "left", "step", "wide", "mean"])
    (limit,), gap = sym("stretch_limit"), creep.GAP
    value, turned = creep.log_integrand(), creep.slope_of_log_integrand()
    pairs = (creep.panel_series(), creep.panel())
    series, exact = ([Assign("panel", average), Assign("panel_slope", by_step)] for average, by_step in pairs)
    turn = element("panel") * element("slope_left") + element("panel_slope") * (element("slope_here") - element("slope_left"))
    quotient, quotient_slope = (one.subs(creep.DELTA, element("delta")) for one in creep.quotient())
    body: list[Statement] = [
        Assign("gap", near - limit),
        Assign("delta", (far - near) / gap),
        Assign("quotient", 1 + element("delta") / 2),
        Assign("quotient_slope", "0.5d0"),
        when(f"abs(delta) > {decimal(creep.SMALL_STRAIN)}", Assign("quotient", quotient), Assign("quotient_slope", quotient_slope)),
        Assign("wide", element("delta") / element("quotient")),
        Assign("log_near", value.subs(creep.S, near)),
        Assign("slope_near", turned.subs(creep.S, near)),
        *(Assign(name, "0.0d0") for name in ("mean", "slope", "rise_left", "slope_left")),
        Assign("left", "1.0d0"),
        Assign("ratio", sp.exp(wide / creep.PANELS)),
        Do("i", "1", f"{creep.PANELS}", (
            Assign("place", f"i/{creep.PANELS}.0d0"),
            Assign("gap", gap * element("ratio")),
            Assign("s", limit + gap),
            Assign("rise", value - element("log_near") + place * wide),
            Assign("slope_here", (1 - place) * turned - element("slope_near")),
            Assign("step", element("rise") - element("rise_left")),
            If(((f"abs(step) < {decimal(creep.SMALL_STEP)}", series), ("", exact))),
            Assign("mean", mean + left * element("panel")),
            Assign("slope", element("slope") + left * turn),
            Assign("left", left * sp.exp(step)),
            Assign("rise_left", "rise"),
            Assign("slope_left", "slope_here"),
        )),
        Assign("mean", mean / (creep.PANELS * element("quotient"))),
        Assign("slope", (
            element("slope") / (creep.PANELS * element("quotient"))
            + mean * (1 + element("delta")) * element("quotient_slope") / element("quotient")
        ) / (near - limit)),
    ]  # fmt: skip
    heading = (
        "Mean of (eta/eta_near)**m near/s over the stretches s from near to far, the strain path of the increment: ln of the "
        f"integrand is taken as linear in ln(s - limit) in each of {creep.PANELS} panels.",
        "eta = constant (closeness**2 + plus)/s**power, closeness = limit/(s - limit)",
        "Equation: 3, 4, 5",
        "In:  near, far stretches at the end and at the start of the path [-], stretch_limit [-], plus and power of the stage, m",
        "Out: mean [-], slope its derivative by near at fixed far [-]",
    )
    ins = tuple(Declare(name, (), "in") for name in ("near", "far", "stretch_limit", "plus", "power", "exponent"))
    outs = (Declare("mean", (), "out"), Declare("slope", (), "out"))
    return Procedure("path", heading, (*ins, *outs), body, (Declare("i", kind="INTEGER"),))


def ramp_routines() -> list[Procedure]:
    """The end of a load that rises linearly over this increment and the last, from the means over the two."""
    miss, by_y, log_growth, history = creep.ramp()
    bound = f"min(log_rise, {decimal(creep.LARGEST_ORDER)}/order)"
    ends = {"log_growth": creep.LOG_RISE / (1 + creep.RATIO), "history": 1 / (1 + creep.RATIO)}
    rising: list[Statement] = [
        Assign("order", creep.EXPONENT + 1),
        Assign("known", bound),
        Assign("y", creep.first_guess().subs(creep.LOG_RISE, element("known"))),
        Do("i", "1", f"{creep.ROUNDS}", (
            Assign("excess", sp.exp(creep.Y) - 1),
            Call("reach", ("-excess", "y", "order", "exponent", "ahead", "ahead_slope"), 4),
            Assign("reach", creep.RATIO * creep.EXCESS),
            Call("reach", ("reach", "log(max(1.0d-300, 1.0d0 - reach))", "order", "exponent", "behind", "behind_slope"), 4),
            Assign("miss", miss.subs(creep.LOG_RISE, element("known"))),
            Assign("by_y", by_y),
            Assign("y", creep.Y - element("miss") / creep.BY_Y),
        )),
        Assign("history", history),
        Assign("y", creep.Y + element("miss") / creep.BY_Y),
        Assign("log_growth", log_growth - element("history") * element("miss")),
    ]  # fmt: skip
    ramp = Procedure(
        "ramp",
        (
            "Load at the end of the increment over its mean s in it, where it rises linearly over this increment and the last: "
            "y = ln(p1/p0) by Newton's method from above. Where it falls, the same to first order.",
            "s = p0 P(-e)**(1/m), s_last = p0 P(ratio e)**(1/m), e = exp(y) - 1",
            "Equation: 3",
            "In:  log_rise = ln(s/s_last) [-], ratio length of the last increment over that of this one [-], m",
            "Out: log_growth = ln(p1/s) [-], history its derivative by log_rise [-]",
        ),
        (*(Declare(name, (), "in") for name in ("log_rise", "ratio", "exponent")),
         *(Declare(name, (), "out") for name in ends)),
        [*(Assign(*end) for end in ends.items()), when("log_rise > 0.0d0", *rising)],
        (Declare("i", kind="INTEGER"),),
    )  # fmt: skip
    series, exact = ([Assign("mean", mean), Assign("slope", slope)] for mean, slope in creep.ramp_mean())
    reach = Procedure(
        "reach",
        (
            "Mean of the power m of a load that falls linearly from 1 and is 1 - reach at the end, nothing below zero.",
            "P = (1 - max(0, 1 - reach)**(m + 1))/((m + 1) reach)",
            "Equation: 3",
            "In:  reach [-], log_end = ln(max(0, 1 - reach)), order = m + 1, m",
            "Out: mean = P [-], slope its derivative by reach [-]",
        ),
        (*(Declare(name, (), "in") for name in ("reach", "log_end", "order", "exponent")),
         *(Declare(name, (), "out") for name in ("mean", "slope"))),
        [
            If((
                (f"abs(order*reach) < {decimal(creep.SMALL_REACH)}", series),
                ("", [Assign("part", sp.exp(creep.EXPONENT * element("log_end"))), *exact]),
            )),
        ],
    )  # fmt: skip
    return [ramp, reach]


def join_stage() -> Stage:
    """The mean over a path that passes the lock: its bleed part and its squeeze part on the scale of the viscosity at the end."""
    stretch, limit, l0_over_d, eps_lock = sym("stretch", "stretch_limit", "l0_over_d", "eps_lock")
    b_squeeze, b_bleed = sym("b_squeeze", "b_bleed")
    lock, start, exponent = element("lock_stretch"), element("stretch_start"), creep.EXPONENT
    near, slope, far = (element(n) for n in ("near_mean", "near_slope", "far_mean"))
    constants = eps_lock - 2 * sp.log(l0_over_d) + b_squeeze - b_bleed
    shapes = {name: creep.shape().subs(dict(zip((creep.PLUS, creep.POWER), creep.PATH[name], strict=True))) for name in creep.PATH}
    log_ratio = exponent * (constants + sp.log(shapes["squeeze"].subs(creep.S, lock)) - sp.log(shapes["bleed"].subs(creep.S, stretch)))
    ratio = element("ratio")
    part = (start - lock) / lock * ratio * far
    by_end = -exponent * creep.PATH["bleed"][1] / stretch - 2 * exponent / (stretch - limit)  # of ln shape of the bleed stage
    total = (lock - stretch) * near + stretch * part
    body = [
        Assignment("ratio", sp.exp(log_ratio)),
        Assignment("far_part", part),
        Assignment("path_mean", (total / (start - stretch)).subs(part, element("far_part"))),
        Assignment(
            "path_slope",
            ((lock - stretch) * slope - near + element("far_part") * (1 - stretch * by_end) + element("path_mean"))
            / (start - stretch),
        ),
    ]
    return make_stage(
        "join", "Mean over a path that passes the lock", "3, 4, 5",
        "stretch stretch_start lock_stretch stretch_limit l0_over_d eps_lock b_squeeze b_bleed exponent near_mean near_slope far_mean",
        "path_mean path_slope", body, sharing="none",
        formula=("ratio = (eta_squeeze(lock)/eta_bleed(end))**m",),
    )  # fmt: skip


def creep_stage() -> Stage:
    """R of the increment, the mean effective stress and the power that goes with it."""
    stretch, det_f, j2, j2_eff, j2_unit = sym("stretch", "det_f", "j2", "j2_eff", "j2_unit")
    chain, g = Chain(creep.definitions()), element("g_flow")
    delta, quotient, across = creep.DELTA, creep.QUOTIENT, creep.ACROSS
    by_end = {delta: -(1 + delta) / stretch, across: -8 * across * (1 - across) / stretch}
    by_end[quotient] = element("quotient_slope") * by_end[delta]

    def slope(expr: sp.Expr) -> sp.Expr:
        return sp.Add(*(chain.derivative(expr, v) * element(f"d_{v.name}") for v in by_end))

    mean = quotient * element("path_mean")
    log_r = creep.log_factor().subs(creep.MEAN, element("mean"))
    body = [Assignment(f"d_{v.name}", d) for v, d in by_end.items()]
    body += from_definitions(creep.definitions())
    body += [
        Assignment("mean", mean),
        Assignment("d_mean", element("d_quotient") * element("path_mean") + quotient * element("path_slope")),
        Assignment("g_mean", g * sp.exp(log_r)),
        Assignment("dlnr", slope(log_r) + sp.diff(log_r, element("mean")) * element("d_mean")),
        Assignment("dlnq", slope(creep.log_of_rate_measure())),
        Assignment("mean_stress", element("g_mean") / det_f * sp.sqrt(j2_unit * j2_eff) * sp.exp(creep.log_of_rate_measure())),
        Assignment("power", element("g_mean") * j2 * creep.FIRST / creep.SECOND),
        Assignment("rate_slowed", sym("eps_rate")[0] * element("mean") / creep.U33),
    ]
    return make_stage(
        "creep", "Viscous factor of the mean over the strain path, mean effective stress and viscous power", "1, 3, 15",
        "a_rate det_f stretch eps_rate delta quotient quotient_slope across path_mean path_slope j2 j2_eff j2_unit g_flow",
        "g_mean dlnr dlnq mean_stress power rate_slowed", body, sharing="none",
        formula=(
            "s = [(1/dt) integral of eta**m d|eps|]**(1/m) in place of eta(eps1) rate**(a+1): g R with "
            "R = mean**(a+1)/(second**(a/2) first), u = rate of C over twice that of eps. At the end the rate under the same load is "
            "the mean one times mean.",
        ),
    )  # fmt: skip


def load_stage() -> Stage:
    """Viscous factor at the end of the increment, with the slopes of ln g."""
    theta, stretch, a_norm2, j2_eff = sym("history", "stretch", "a_norm2", "j2_eff")
    flow = {v: element(f"dflow_{v.name}") for v in VARIABLES}
    # what ln s has beside ln g: the square root of j2_unit, 2 A:A (squeeze) or 2 stretch^4 (bleed), and of J2, and the measure
    squeeze = element("squeeze")
    beside = {"stretch": element("dlnq") + 2 * (1 - squeeze) / stretch, "a_norm2": squeeze / (2 * a_norm2), "j2": 1 / (2 * j2_eff)}
    body = [
        Assignment("growth", sp.exp(element("log_growth"))),
        Assignment("g_visc", element("g_mean") * element("growth")),
        Assignment("rate_end", element("rate_slowed") * element("growth") ** creep.EXPONENT),
    ]
    for v in VARIABLES:
        slope = flow[v] + (element("dlnr") if v.name == "stretch" else 0)
        if v.name == "det_f":
            body.append(Assignment(slope_name(v).name, slope))
        else:
            body.append(Assignment(slope_name(v).name, (1 + theta) * slope + theta * beside[v.name]))
    inputs = "log_growth history squeeze stretch a_norm2 j2_eff exponent rate_slowed g_mean dlnr dlnq"
    inputs += "".join(f" {s.name}" for s in flow.values())
    outputs = "g_visc rate_end " + " ".join(slope_name(v).name for v in VARIABLES)
    return make_stage(
        "load", "Viscous factor at the end of the increment", "15", inputs, outputs, body, sharing="none",
        formula=("ln p at the end = ln s + log_growth: s is the mean over the increment.",),
    )  # fmt: skip
