"""The point routine from the kinematics to the viscous factor: what J2 counts, the limit, the mean over the strain path."""

from __future__ import annotations

from umatgen.expressions import decimal, expression
from umatgen.lower.calls import Calls
from umatgen.lower.interface import HISTORY, state_place
from umatgen.model import creep, printed_invariants, viscous
from umatgen.nodes import Assign, Call, Comment, If, Statement, fault, when
from umatgen.scene import Scene


def counted(scene: Scene, calls: Calls) -> list[Statement]:
    """The right factor of the viscous dyad: the rate that J2 counts."""
    found = calls("counted")
    return [Assign("y_counted", calls.rate), when("widening > 1.0d0", *found)] if found else []


def viscosity(scene: Scene, calls: Calls) -> list[Statement]:
    """The viscous factor of the stage in force."""
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


def limits(scene: Scene) -> list[Statement]:
    """The compaction limit."""
    body: list[Statement] = [
        when(".NOT. gap > 0.0d0", *fault(3, "stretch", "stretch_limit", unless=("x_start <= stretch_limit**2", 14)))
    ]
    if scene.checks:
        body.append(when(".NOT. x_start > stretch_limit**2", *fault(14, "sqrt(x_start)", "stretch_limit")))
    return body


def mean_over_path(scene: Scene, calls: Calls) -> list[Statement]:
    """The mean over the strain path, and what the load does after it."""
    if not scene.creep:
        return []
    places = [state_place(scene, s.name) for s in HISTORY]
    smooth = f"kinc > 1 .AND. dt_last > 0.0d0 .AND. statev({places[0]}) > 0.0d0"
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
            "A load that changes: the mean stress is extrapolated to the end of the increment in its logarithm. Not in the first "
            "increment of a step, where loads may kink, nor where the compaction rests or turns."
        ),
        Assign("history", "0.0d0"),
        Assign("stress_last", "mean_stress"),
        Assign("dt_last", f"statev({places[1]})"),
        when(
            f"{smooth} .AND. eps_rate*statev({state_place(scene, 'eps_rate')}) > 0.0d0",
            Assign("history", "dt/(dt + dt_last)"),
            Assign("stress_last", f"statev({places[0]})"),
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
