"""Stages of the creep-exact increment, and the loop over the strain path as a procedure (`umatgen.model.creep`)."""

from __future__ import annotations

import sympy as sp

from umatgen.expressions import decimal
from umatgen.lower.assign import Assignment, element, from_definitions
from umatgen.lower.stage import Stage, make_stage
from umatgen.model import creep
from umatgen.model.chain import Chain
from umatgen.model.tangent import VARIABLES, slope_name
from umatgen.nodes import Assign, Declare, Do, If, Procedure, Statement
from umatgen.notation import sym


def path_routine() -> Procedure:
    """Mean of the viscosity's power over the stretches s from `near` to `far`, and its derivative by `near`."""
    near, far, place, left, step = (element(n) for n in ("near", "far", "place", "left", "step"))
    rise, slope = creep.log_integrand(), creep.slope_of_log_integrand()
    pairs = (creep.panel_series(), creep.panel())
    series, exact = ([Assign("panel", mean), Assign("panel_slope", by_step)] for mean, by_step in pairs)
    width = (place - element("place_left")) * left
    turn = element("panel") * element("slope_left") + element("panel_slope") * (element("slope_here") - element("slope_left"))
    body: list[Statement] = [
        Assign("log_near", rise.subs(creep.S, near)),
        Assign("slope_near", slope.subs(creep.S, near)),
        *(Assign(name, "0.0d0") for name in ("mean", "slope", "place_left", "rise_left", "slope_left")),
        Assign("left", "1.0d0"),
        Do("i", "1", f"{creep.PANELS}", (
            Assign("place", f"(i/{creep.PANELS}.0d0)**2"),
            Assign("s", near + place * (far - near)),
            Assign("rise", rise - element("log_near")),
            Assign("slope_here", (1 - place) * slope - element("slope_near")),
            Assign("step", element("rise") - element("rise_left")),
            If(((f"abs(step) < {decimal(creep.SMALL_STEP)}", series), ("", exact))),
            Assign("mean", element("mean") + width * element("panel")),
            Assign("slope", element("slope") + width * turn),
            Assign("left", left * sp.exp(step)),
            *(Assign(f"{name}_left", name) for name in ("place", "rise")),
            Assign("slope_left", "slope_here"),
        )),
    ]  # fmt: skip
    heading = (
        "Mean of (eta/eta_near)**m near/s over the stretches s from near to far, the strain path of the increment: ln of the "
        f"integrand is taken as linear in each of {creep.PANELS} panels that narrow towards near.",
        "eta = constant (closeness**2 + plus)/s**power, closeness = limit/(s - limit)",
        "Equation: 3, 4, 5",
        "In:  near, far stretches at the end and at the start of the path [-], stretch_limit [-], plus and power of the stage, m",
        "Out: mean [-], slope its derivative by near at fixed far [-]",
    )
    ins = tuple(Declare(name, (), "in") for name in ("near", "far", "stretch_limit", "plus", "power", "exponent"))
    outs = (Declare("mean", (), "out"), Declare("slope", (), "out"))
    return Procedure("path", heading, (*ins, *outs), body, (Declare("i", kind="INTEGER"),))


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
    """Viscous factor at the end of the increment: the mean stress extrapolated in its logarithm, with the slopes of ln g."""
    theta, stretch, a_norm2, j2_eff = sym("history", "stretch", "a_norm2", "j2_eff")
    flow = {v: element(f"dflow_{v.name}") for v in VARIABLES}
    # what ln s has beside ln g: the square root of j2_unit, 2 A:A (squeeze) or 2 stretch^4 (bleed), and of J2, and the measure
    squeeze = element("squeeze")
    beside = {"stretch": element("dlnq") + 2 * (1 - squeeze) / stretch, "a_norm2": squeeze / (2 * a_norm2), "j2": 1 / (2 * j2_eff)}
    body = [
        Assignment("growth", (element("mean_stress") / element("stress_last")) ** theta),
        Assignment("g_visc", element("g_mean") * element("growth")),
        Assignment("rate_end", element("rate_slowed") * element("growth") ** creep.EXPONENT),
    ]
    for v in VARIABLES:
        slope = flow[v] + (element("dlnr") if v.name == "stretch" else 0)
        if v.name == "det_f":
            body.append(Assignment(slope_name(v).name, slope))
        else:
            body.append(Assignment(slope_name(v).name, (1 + theta) * slope + theta * beside[v.name]))
    inputs = "history stress_last squeeze stretch a_norm2 j2_eff exponent rate_slowed g_mean mean_stress dlnr dlnq"
    inputs += "".join(f" {s.name}" for s in flow.values())
    outputs = "g_visc rate_end " + " ".join(slope_name(v).name for v in VARIABLES)
    return make_stage(
        "load", "Viscous factor at the end of the increment", "15", inputs, outputs, body, sharing="none",
        formula=("ln s at the end = ln s + history (ln s - ln s_last): s is the mean over the increment.",),
    )  # fmt: skip
