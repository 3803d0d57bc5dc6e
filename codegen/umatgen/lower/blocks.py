"""All stages of a scene, in the order in which the point routine calls them, after the passes."""

from __future__ import annotations

from dataclasses import dataclass

from umatgen.lower.kinematic_stages import frame_stage, kinematics_stage, start_stage, transverse_stage
from umatgen.lower.material_stages import (
    elastic_stage,
    flow_stage,
    gradient_stage,
    moduli_stage,
    pushed_stress_stage,
    stress_stage,
    tangent_stage,
)
from umatgen.lower.option_stages import blend_stage, lock_gradient_stage, printed_gradient_stage, printed_stage
from umatgen.lower.passes import counted, fold, in_plane, prune, share_subexpressions, vanishing
from umatgen.lower.stage import Stage


@dataclass(frozen=True)
class Choices:
    """What of a scene decides the stages.

    Parameters
    ----------
    tangent : "consistent", "paper", "symmetric" or "none".
    invariants : "transverse" or "printed".
    device : "penalty", "augmented" or "none".
    blend : whether the lock is a blend.
    regimes : the flow stages kept.
    elastic : whether the elastic potential is kept.
    plane : whether only in-plane components are kept (NTENS = 4).
    fibre : axis of the fibre, 1 to 3 (a free direction is rotated to axis 1 beforehand: 0).
    integrator : "bdf1", "bdf2" or "bdf2log".
    thermal : whether the slopes of ln g in k and a are wanted (a temperature table).
    baked : whether the constants are in the source, so that exp(b) costs nothing.
    wanted : variables that the point routine itself reads.
    """

    tangent: str
    invariants: str
    device: str
    blend: bool
    regimes: tuple[str, ...] = ("squeeze", "bleed")
    elastic: bool = True
    plane: bool = False
    fibre: int = 1
    integrator: str = "bdf1"
    thermal: bool = False
    baked: bool = False
    wanted: frozenset[str] | None = None


def raw_stages(choices: Choices) -> list[Stage]:
    """Stages before any pass."""
    printed = choices.invariants == "printed"
    optional = [printed_stage(name) for name in choices.regimes] if printed else []
    optional += [blend_stage()] if choices.blend else []
    optional += [lock_gradient_stage()] if choices.blend and choices.device != "none" else []
    result = [
        *([frame_stage()] if choices.fibre == 0 else []),
        *([moduli_stage()] if choices.elastic else []),
        start_stage(choices.fibre),
        kinematics_stage(choices.fibre, choices.integrator, choices.tangent != "none"),
        transverse_stage(choices.fibre),
        *(flow_stage(name, choices.thermal, choices.baked) for name in choices.regimes),
        *optional,
        *elastic_stage(choices.device, choices.elastic),
    ]
    if choices.tangent == "none":
        return [*result, pushed_stress_stage(choices.device, choices.elastic, choices.fibre)]
    result.append(stress_stage(choices.device, choices.elastic))
    result.append(printed_gradient_stage(choices.tangent) if printed else gradient_stage(choices.tangent, choices.integrator))
    result.append(tangent_stage(choices.tangent, choices.device, choices.blend, choices.elastic, choices.integrator))
    return result


def stages(choices: Choices) -> list[Stage]:
    """Stages after the passes: in plane, constants folded, unneeded left out, subexpressions shared."""
    result = raw_stages(choices)
    if choices.plane:
        result = counted("plane", result, in_plane)
    result = counted("fold", result, fold)
    result = counted("fold", result, vanishing)
    if choices.wanted is not None:
        result = counted("prune", result, prune({"stress", "ddsdde"} | choices.wanted))
    return counted("cse", result, share_subexpressions)
