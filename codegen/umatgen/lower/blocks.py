"""All stages of a scene, in the order in which the point routine calls them."""

from __future__ import annotations

from umatgen.lower.kinematic_stages import kinematics_stage, start_stage, transverse_stage
from umatgen.lower.material_stages import (
    elastic_stage,
    flow_stage,
    gradient_stage,
    moduli_stage,
    stress_stage,
    tangent_stage,
)
from umatgen.lower.stage import Stage


def stages(tangent_kind: str) -> list[Stage]:
    """Stages of the default family of scenes: both flow regimes, elastic part, penalty, fibre along axis 1."""
    return [
        moduli_stage(),
        start_stage(),
        kinematics_stage(),
        transverse_stage(),
        flow_stage("squeeze"),
        flow_stage("bleed"),
        elastic_stage(),
        stress_stage(),
        gradient_stage(tangent_kind),
        tangent_stage(tangent_kind),
    ]
