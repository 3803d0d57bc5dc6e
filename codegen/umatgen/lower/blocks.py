"""All stages of a scene, in the order in which the point routine calls them."""

from __future__ import annotations

from dataclasses import dataclass

from umatgen.lower.kinematic_stages import kinematics_stage, start_stage, transverse_stage
from umatgen.lower.material_stages import (
    elastic_stage,
    flow_stage,
    gradient_stage,
    moduli_stage,
    stress_stage,
    tangent_stage,
)
from umatgen.lower.option_stages import blend_stage, lock_gradient_stage, printed_gradient_stage, printed_stage
from umatgen.lower.stage import Stage


@dataclass(frozen=True)
class Choices:
    """What of a scene decides the stages."""

    tangent: str
    invariants: str
    device: str
    blend: bool


def stages(choices: Choices) -> list[Stage]:
    """Stages of the default family of scenes: both flow regimes, elastic part, fibre along axis 1."""
    printed = choices.invariants == "printed"
    optional = [printed_stage("squeeze"), printed_stage("bleed")] if printed else []
    optional += [blend_stage(), lock_gradient_stage()] if choices.blend else []
    return [
        moduli_stage(),
        start_stage(),
        kinematics_stage(),
        transverse_stage(),
        flow_stage("squeeze"),
        flow_stage("bleed"),
        *optional,
        elastic_stage(choices.device),
        stress_stage(),
        printed_gradient_stage(choices.tangent) if printed else gradient_stage(choices.tangent),
        tangent_stage(choices.tangent, choices.device, choices.blend),
    ]
