"""The point routine as nodes: one increment of one material point, in order, shared by every host."""

from __future__ import annotations

from collections.abc import Sequence

from umatgen.lower.calls import Calls
from umatgen.lower.constants import named_where_needed
from umatgen.lower.faults import NO_FAULT
from umatgen.lower.interface import PROPERTIES, Property
from umatgen.lower.point_answer import elastic, power, results, state, stress, tangent, thermal_stress
from umatgen.lower.point_start import at_temperature, checked, deformation, in_frame, stage_of_flow, time
from umatgen.lower.point_viscous import counted, limits, mean_over_path, viscosity
from umatgen.lower.stage import Stage
from umatgen.model.temperature import QUANTITIES
from umatgen.nodes import Statement, names
from umatgen.scene import Scene


def point_body(scene: Scene, stages: Sequence[Stage], constants: Sequence[tuple[int, str]]) -> list[Statement]:
    """All statements of the point routine; `constants` are numbers and names of PROPS."""
    calls = Calls(scene, stages)
    body: list[Statement] = [
        *at_temperature(scene),
        *in_frame(scene, calls),
        *deformation(calls),
        *stage_of_flow(scene),
        *time(scene),
        *calls("kinematics"),
        *counted(scene, calls),
        *viscosity(scene, calls),
        *limits(scene),
        *mean_over_path(scene, calls),
        *elastic(calls),
        *power(scene),
        *stress(scene, calls),
        *thermal_stress(scene),
        *tangent(scene, calls),
        *results(scene, calls),
        *state(scene),
    ]
    return [*NO_FAULT, *checked(scene), *named_where_needed(body, {name: f"props({i})" for i, name in constants})]


def wanted_variables(scene: Scene, stages: Sequence[Stage]) -> set[str]:
    """Results of the stages that the point routine itself reads, beside those it returns."""
    body = point_body(scene, stages, ())
    renamed = {"g0", "g1"} if scene.free else set()
    renamed |= {"y_counted"}
    renamed |= {"p_stretch", "p_norm2"} if scene.compaction == "printed" else set()
    return {"stress", "ddsdde"} | names(body) | renamed


def properties(scene: Scene, stages: Sequence[Stage]) -> list[Property]:
    """The material constants that a scene uses, in the fixed order."""
    used = {v.name for stage in stages for v in stage.inputs} | names(point_body(scene, stages, ()))
    used -= set(QUANTITIES.values()) if scene.table else set()
    return [p for p in PROPERTIES if p.fortran in used]


def property_places(scene: Scene, stages: Sequence[Stage]) -> dict[str, str]:
    """Place in PROPS of each constant by manifest name."""
    return {p.name: f"props({i})" for i, p in enumerate(properties(scene, stages), 1)}
