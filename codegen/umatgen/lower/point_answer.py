"""The point routine from the viscous factor on: stress, tangent, energies, state variables."""

from __future__ import annotations

from umatgen.expressions import decimal, expression
from umatgen.lower.calls import Calls
from umatgen.lower.interface import state_place, state_variables
from umatgen.model import temperature, viscous
from umatgen.nodes import Assign, Comment, Statement, fault, when
from umatgen.scene import Scene

PART_OF_GAP = 0.1  # what a first iteration may take of it: after a fast ramp the last rate would carry a long increment past the limit
_OF_THE_RATE = {"eps_rate", "mean_stress", "dt_last"}  # kept by an increment without time


def elastic(calls: Calls) -> list[Statement]:
    """Elastic and volumetric coefficients."""
    found = calls("elastic")
    head = [Comment("Elastic and volumetric part (Eqs. 8, 10).")] if found else []
    return [*head, *calls("moduli"), *found]


def power(scene: Scene) -> list[Statement]:
    """Viscous power, where the integrator does not give it."""
    return [Assign("power", viscous.power())] if scene.energies and not scene.creep else []


def stress(scene: Scene, calls: Calls) -> list[Statement]:
    """Cauchy stress, if it is finite."""
    total = " + ".join(f"sigma({i})" for i in range(1, scene.ntens + 1))
    finite = when(f".NOT. @finite({total})", *fault(5, "sum(abs(sigma))", "huge(dt)"))
    return [
        Comment(f"{calls.title('stress')} and tangent (Eqs. 8, 9, 16, 17)."),
        *calls("stress"),
        *([finite] if scene.checks else []),
    ]


def thermal_stress(scene: Scene) -> list[Statement]:
    """Change of the stress with temperature, for scenes with a table."""
    if not scene.table:
        return []
    return [
        Comment("Change of the stress with temperature: through k, a and b of the viscous part, at fixed deformation."),
        Assign("dlng_dtheta", temperature.slope_of_log_g()),
        Assign("ddsddt", temperature.stress_slope()),
    ]


def tangent(scene: Scene, calls: Calls) -> list[Statement]:
    """DDSDDE, at vanishing rate by the last one."""
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


def results(scene: Scene, calls: Calls) -> list[Statement]:
    """Stress and energies, now that nothing can go wrong any more."""
    body: list[Statement] = [Assign("stress", "sigma")]
    if scene.energies:
        stored = "energy" if calls("elastic") else "0.0d0"
        body += [Comment("Energies per reference volume."), Assign("sse", stored), Assign("scd", "scd + dt*power")]
    return body


def state(scene: Scene) -> list[Statement]:
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
