"""The stages, in order: scene -> lowered stages -> Fortran text and manifest. The only file that names them all."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass

from umatgen import __version__
from umatgen.fortran import abaqus
from umatgen.fortran.interface import properties, property_rows, state_rows, state_variables, wanted_variables
from umatgen.lower.blocks import Choices, stages
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
