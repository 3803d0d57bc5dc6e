"""All stages of a scene, in the order in which the point routine calls them: derived, then lowered by the passes."""

from __future__ import annotations

from collections.abc import Sequence

from umatgen.lower.creep_stages import creep_stage, join_stage, load_stage
from umatgen.lower.frame_stage import frame_stage
from umatgen.lower.kinematic_stages import compaction_stage, counted_stage, kinematics_stage, start_stage
from umatgen.lower.material_stages import (
    elastic_stage,
    flow_stage,
    gradient_stage,
    moduli_stage,
    pushed_stress_stage,
    stress_stage,
    tangent_stage,
)
from umatgen.lower.passes import counted, fold, in_plane, prune, share_subexpressions, vanishing
from umatgen.lower.point import wanted_variables
from umatgen.lower.printed_stages import printed_gradient_stage, printed_stage
from umatgen.lower.stage import Stage
from umatgen.scene import Scene


def derive(scene: Scene) -> list[Stage]:
    """Stages of a scene as they follow from the model, before any pass."""
    printed = scene.compaction == "printed"
    result = [
        *([frame_stage(scene)] if scene.free else []),
        *([moduli_stage()] if scene.elastic else []),
        start_stage(scene),
        compaction_stage(scene),
        kinematics_stage(scene),
        *([counted_stage(scene)] if scene.both_regimes and scene.tangent != "none" else []),
        *(flow_stage(name, bool(scene.table), bool(scene.baked)) for name in scene.kept_regimes),
        *(printed_stage(name) for name in scene.kept_regimes if printed),
        *(([join_stage()] if scene.both_regimes else []) + [creep_stage(), load_stage()] if scene.creep else []),
        *elastic_stage(scene),
    ]
    if scene.tangent == "none":
        return [*result, pushed_stress_stage(scene)]
    gradient = printed_gradient_stage(scene.tangent) if printed else gradient_stage(scene)
    return [*result, stress_stage(scene), gradient, tangent_stage(scene)]


def lower(scene: Scene, derived: Sequence[Stage]) -> list[Stage]:
    """Stages after the passes: in plane, constants folded, unneeded left out, subexpressions shared."""
    result = list(derived)
    if scene.ntens == 4:
        result = counted("plane", result, in_plane)
    result = counted("fold", result, fold)
    result = counted("fold", result, vanishing)
    result = counted("prune", result, prune(wanted_variables(scene, result)))
    return counted("cse", result, share_subexpressions)
