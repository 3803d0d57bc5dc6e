"""From a scene to Fortran in four calls: derive, lower, assemble, print."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass

from umatgen import __version__
from umatgen.fortran import abaqus, batch, calculix
from umatgen.lower.blocks import derive, lower
from umatgen.lower.interface import PROPERTIES, property_rows, state_rows, state_variables
from umatgen.lower.material_frame_stages import derive_material_frame
from umatgen.lower.point import properties
from umatgen.lower.routines import Material, assemble
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
    """Derive, lower, assemble and print a scene.

    Deterministic: the same scene and version give the same bytes on every machine.
    """
    derived = derive(scene)
    lowered = lower(scene, derived)
    material = assemble(scene, lowered)
    text = abaqus.source(scene, material)
    return Generated(text, _manifest(scene, material, text))


def generate_batch(scene: Scene) -> str:
    """Source of the routine that takes many points at once (NAME_batch.f90), from the same stages and nodes as the UMAT.

    Raises
    ------
    SceneError
        The scene has no such routine; the message names the choice that is in the way.
    """
    batch.check(scene)
    derived = derive(scene)
    lowered = lower(scene, derived)
    material = assemble(scene, lowered)
    return batch.source(scene, material)


def native_calculix(scene: Scene) -> str:
    """Source of CalculiX's native face of a scene: S and dS/dE, nothing pushed forward.

    Raises
    ------
    SceneError
        The scene has no such face; the message names the choice that is in the way.
    """
    calculix.check(scene)
    derived = derive_material_frame(scene)
    lowered = lower(scene, derived)
    material = assemble(scene, lowered)
    return calculix.source(scene, material)


def calculix_names(scene: Scene) -> tuple[str, str]:
    """Name of the library of a scene (without lib and .so) and of *MATERIAL behind CalculiX's native door."""
    library = calculix.library_name(scene)
    return library, f"@{library}_{calculix.SYMBOL}"


def _manifest(scene: Scene, material: Material, text: str) -> dict[str, object]:
    """Names, units and defaults of PROPS and STATEV, the scene, and the blocks with their operation counts."""
    return {
        "name": scene.name,
        "generator_version": __version__,
        "scene": scene.as_dict(),
        "ntens": scene.ntens,
        "unsymmetric": abaqus.unsymmetric(scene),
        "props": [] if scene.baked else property_rows(properties(scene, material.stages)),
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
            for s in material.stages
        ],
        "source_sha256": hashlib.sha256(text.encode()).hexdigest(),
    }
