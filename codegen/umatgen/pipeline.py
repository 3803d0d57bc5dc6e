"""The stages, in order: scene -> lowered stages -> Fortran text and manifest. The only file that names them all."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass

from umatgen import __version__
from umatgen.fortran import abaqus
from umatgen.fortran.interface import property_rows, state_rows
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


def generate(scene: Scene) -> Generated:
    """Derive, lower and emit a scene.

    Deterministic: the same scene and version give the same bytes on every machine.
    """
    lowered = stages(Choices(scene.tangent, scene.invariants, scene.incompressibility, scene.lock == "blend"))
    text = abaqus.source(scene, lowered)
    manifest: dict[str, object] = {
        "name": scene.name,
        "generator_version": __version__,
        "scene": scene.as_dict(),
        "ntens": 6,
        "unsymmetric": abaqus.unsymmetric(scene),
        "props": property_rows(),
        "statev": state_rows(),
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
