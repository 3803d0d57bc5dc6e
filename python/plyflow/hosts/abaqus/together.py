"""Several scenes in one source, as one Abaqus job wants them: UMAT chooses by the material's name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from plyflow.errors import InputError
from plyflow.hosts.abaqus.deck import environment
from plyflow.umat.compile import generate_cached
from umatgen.scene import Scene

_LAST_COLUMN, _INDENT = 72, 10


def entry_name(scene: Scene) -> str:
    """Name of a scene's own routine with the 37 arguments, beside others in one executable."""
    return f"PF_{scene.name.upper()}_UMAT"


def material_name(scene: Scene) -> str:
    """Name of *MATERIAL that chooses a scene; anything may follow after a hyphen."""
    return scene.name.upper()


def source_of_scenes(scenes: Sequence[Scene]) -> str:
    """One source of several scenes, valid in both forms, that needs no other file.

    Raises
    ------
    InputError
        Two scenes have the same name.
    """
    for name, count in Counter(scene.name for scene in scenes).items():
        if count > 1:
            raise InputError(f"{count} scenes are called '{name}': give each its own name, it is the material's too")
    own = [replace(scene, entry=entry_name(scene)) for scene in scenes]
    heads = [f"CALL {scene.entry}(".ljust(_LAST_COLUMN - _INDENT) for scene in own]
    return (
        environment()
        .get_template("together.f.j2")
        .render(
            scenes=own,
            heads=heads,
            aba_param=any(scene.include == "aba_param" for scene in own),
            sources=[generate_cached(scene)[0] for scene in own],
        )
    )
