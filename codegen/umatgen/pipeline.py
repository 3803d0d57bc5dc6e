"""The stages, in order: scene -> lowered stages -> Fortran text and manifest. The only file that names them all."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

from umatgen import __version__
from umatgen.fortran import abaqus, calculix
from umatgen.fortran.faults import fault_texts
from umatgen.fortran.interface import (
    PROPERTIES,
    properties,
    property_rows,
    state_rows,
    state_variables,
    table_quantities,
    wanted_variables,
)
from umatgen.lower.blocks import Choices, stages
from umatgen.lower.material_frame_stages import material_frame_stages
from umatgen.lower.stage import Stage
from umatgen.scene import Scene


@dataclass(frozen=True)
class Generated:
    """What a scene generates.

    Parameters
    ----------
    source : Fortran source of the UMAT.
    manifest : names, units, defaults of PROPS and STATEV, the scene, the generator's version, operation counts.
    """

    source: str
    manifest: dict[str, object]

    def manifest_text(self) -> str:
        """The manifest as JSON text, the same on every run."""
        return json.dumps(self.manifest, indent=2) + "\n"


def choices_of(scene: Scene) -> Choices:
    """What of a scene decides its stages."""
    return Choices(
        tangent=scene.tangent,
        invariants=scene.invariants,
        device=scene.incompressibility if scene.has_volume else "none",
        blend=scene.lock == "blend",
        regimes=scene.kept_regimes,
        elastic=scene.elastic,
        plane=scene.ntens == 4,
        fibre=0 if scene.fibre == "free" else int(scene.fibre),
        integrator=scene.integrator,
        thermal=bool(scene.table),
        baked=bool(scene.baked),
        wanted=wanted_variables(scene),
    )


def generate(scene: Scene) -> Generated:
    """Derive, lower and emit a scene.

    Deterministic: the same scene and version give the same bytes on every machine.
    """
    lowered = stages(choices_of(scene))
    text = abaqus.source(scene, lowered)
    manifest: dict[str, object] = {
        "name": scene.name,
        "generator_version": __version__,
        "scene": scene.as_dict(),
        "ntens": scene.ntens,
        "unsymmetric": abaqus.unsymmetric(scene),
        "props": [] if scene.baked else property_rows(properties(scene, lowered)),
        "defaults": {p.name: p.default for p in PROPERTIES[:17]} | dict(scene.baked),
        "statev": state_rows(state_variables(scene)),
        "blocks": [
            {
                "name": s.name,
                "equation": s.equation,
                "inputs": [v.name for v in s.inputs],
                "outputs": [v.name for v in s.outputs],
                "operations": {c.name: [c.before, c.after] for c in s.counts},
            }
            for s in lowered
        ],
        "source_sha256": hashlib.sha256(text.encode()).hexdigest(),
    }
    return Generated(text, manifest)


def native_calculix(scene: Scene) -> str:
    """Source of CalculiX's native face of a scene: S and dS/dE, nothing pushed forward.

    Raises
    ------
    SceneError
        The scene has no such face; the message names the choice that is in the way.
    """
    calculix.check(scene)
    return calculix.native_source(scene, material_frame_stages(choices_of(scene)))


def calculix_names(scene: Scene) -> tuple[str, str]:
    """Name of the library of a scene (without lib and .so) and of *MATERIAL behind CalculiX's native door."""
    library = calculix.library_name(scene)
    return library, f"@{library}_{calculix.SYMBOL}"


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
    full, slim = stages(choices_of(Scene())), stages(choices_of(scene))
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


def _faults(scene: Scene, lowered: Sequence[Stage]) -> dict[int, str]:
    places = {p.name: f"props({i})" for i, p in enumerate(properties(scene, lowered), 1)}
    return dict(fault_texts(scene, places))


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
