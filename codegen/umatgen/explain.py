"""What a scene leaves out against the default one, and why: computed, not listed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from umatgen.lower.blocks import derive, lower
from umatgen.lower.faults import fault_texts
from umatgen.lower.interface import state_variables, table_quantities
from umatgen.lower.point import properties, property_places
from umatgen.lower.stage import Stage
from umatgen.scene import Scene


@dataclass(frozen=True)
class Omission:
    """Something that the default scene has and a scene does not.

    Parameters
    ----------
    kind : "procedure", "result", "constant", "state", "component" or "check".
    name : what it is called.
    reason : why it could go.
    """

    kind: str
    name: str
    reason: str


def explain(scene: Scene) -> list[Omission]:
    """Piece by piece, what a scene leaves out against the default one and why it could go.

    Computed from the lowered stages of both, not from a list: a piece is gone because the scene says so, because nothing
    that is left needs it, or because it is a constant.
    """
    full, slim = _stages(Scene()), _stages(scene)
    have = {s.name: {v.name for v in s.outputs} for s in slim}
    found = []
    for stage in full:
        if stage.name not in have:
            found.append(Omission("procedure", stage.name, _reason(stage.name, scene, stage.title)))
            continue
        for variable in stage.outputs:
            if variable.name not in have[stage.name]:
                found.append(Omission("result", f"{stage.name}: {variable.name}", "nothing that is left needs it"))
    kept = {p.name for p in properties(scene, slim)}
    for prop in properties(Scene(), full):
        if scene.baked:
            found.append(Omission("constant", prop.name, "its value is written into the source"))
        elif prop.name in table_quantities(scene):
            found.append(Omission("constant", prop.name, "it follows the temperature by the table in the source"))
        elif prop.name not in kept:
            found.append(Omission("constant", prop.name, "no procedure that is left reads it"))
    names = {s.name for s in state_variables(scene)}
    found += [
        Omission("state", s.name, "the law does not read it back, and the scene does not report it")
        for s in state_variables(Scene())
        if s.name not in names
    ]
    if scene.ntens == 4:
        found.append(Omission("component", "13 and 23 of every tensor", "stress_state is 'plane': they are zero"))
    return found + _checks_left_out(scene, slim, full)


def _checks_left_out(scene: Scene, slim: Sequence[Stage], full: Sequence[Stage]) -> list[Omission]:
    """Checks that the default scene makes and this one does not."""
    default, kept = _faults(Scene(), full), _faults(scene, slim)
    gone = "the constants are in the source" if scene.baked else "what it looks at is not there"
    reason = gone if scene.checks else "checks is false"
    return [Omission("check", default[n].rstrip(";:"), reason) for n in default if n not in kept]


def _stages(scene: Scene) -> list[Stage]:
    return lower(scene, derive(scene))


def _faults(scene: Scene, lowered: Sequence[Stage]) -> dict[int, str]:
    return dict(fault_texts(scene, property_places(scene, lowered)))


def _reason(name: str, scene: Scene, title: str) -> str:
    reasons = {
        "squeeze": f"regimes is '{scene.regimes}'",
        "bleed": f"regimes is '{scene.regimes}'",
        "moduli": "elastic is false",
        "elastic": "neither elastic part nor volumetric term is kept",
        "gradient": "tangent is 'none'",
        "tangent": "tangent is 'none'",
    }
    return reasons.get(name, f"nothing that is left needs it ({title})")
