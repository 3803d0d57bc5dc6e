"""Several scenes in one source, as one Abaqus job wants them: UMAT chooses by the material's name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from plyflow.errors import InputError
from plyflow.hosts.deck import render
from plyflow.umat.compile import generate_cached
from umatgen.scene import Scene


def source_of_scenes(scenes: Sequence[Scene]) -> str:
    """One source of several scenes in fixed form that needs no other file.

    UMAT calls the scene whose name, in capitals, the material has; anything may follow after a hyphen.

    Raises
    ------
    InputError
        Two scenes have the same name.
    """
    for name, count in Counter(scene.name for scene in scenes).items():
        if count > 1:
            raise InputError(f"{count} scenes are called '{name}': give each its own name, it is the material's too")
    own = [replace(scene, entry=f"PF_{scene.name.upper()}_UMAT", form="fixed") for scene in scenes]
    return render(
        "together.f.j2",
        scenes=own,
        aba_param=any(scene.include == "aba_param" for scene in own),
        sources=[generate_cached(scene)[0] for scene in own],
    )
