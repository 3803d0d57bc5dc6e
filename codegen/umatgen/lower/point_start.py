"""The point routine up to its kinematics: what is checked, the frame, the deformation, the stage of flow, the time."""

from __future__ import annotations

from umatgen.expressions import decimal, expression
from umatgen.lower.calls import Calls
from umatgen.lower.faults import FAULT
from umatgen.lower.interface import state_place, table_quantities
from umatgen.model import lock, rates, viscous
from umatgen.model.temperature import QUANTITIES
from umatgen.nodes import Assign, Call, Comment, Return, Statement, fault, when
from umatgen.scene import Scene


def checked(scene: Scene) -> list[Statement]:
    """Checks of the constants and of the time increment."""
    if not scene.checks:
        return []
    given = ("dt",) if scene.baked else ("dt", "props")
    return [Call("check", (*given, *FAULT), len(given)), when("ifault /= 0", Return())]


def at_temperature(scene: Scene) -> list[Statement]:
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
        Comment("eps_lock by the k of this temperature, unless PROPS set it (Eqs. A.1, 6; V0 as in the scene)."),
        Assign("deps_lock", "0.0d0"),
        when("eps_lock >= 0.0d0", *_lock_by_k(scene)),
    ]


def _lock_by_k(scene: Scene) -> list[Statement]:
    """eps_lock and its slope in k; where the bulk locks first it is a constant."""
    terms = lock.lock_by_k(scene.fibre_fraction)
    bulk = expression(terms.pop("bulk"))
    first = when(f"eps_lock < {bulk}", Assign("eps_lock", bulk), Assign("deps_lock", "0.0d0"))
    return [*(Assign(name, term) for name, term in terms.items()), first]


def in_frame(scene: Scene, calls: Calls) -> list[Statement]:
    """The deformation gradients turned into the material frame, where that is free."""
    if not scene.free:
        return []
    parallel = when(".NOT. sine2 > 1.0d-12", *fault(17, "sine2", "1.0d-12"))
    return [Comment("Material frame: fibre along axis 1, ply normal along axis 3."), *calls("frame"), parallel]


def deformation(calls: Calls) -> list[Statement]:
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


def stage_of_flow(scene: Scene) -> list[Statement]:
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


def time(scene: Scene) -> list[Statement]:
    """The rate of an increment that takes no time is zero, and its tangent that of one second at the last rate."""
    body: list[Statement] = [
        Comment("Kinematics (Eq. 9); the floor keeps the tangent finite at zero rate. An increment without time has no rate."),
        Assign("per_time", "0.0d0"),
        when("dt >= 1.0d-100", Assign("per_time", "1.0d0/dt")),
        Assign("j2_floor", rates.floor()),
    ]
    return body
