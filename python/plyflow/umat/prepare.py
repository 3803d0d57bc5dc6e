"""A UMAT ready to run: generated (or taken from the cache), compiled, loaded."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from plyflow.errors import InputError
from plyflow.provenance import Provenance, package_version, source_hash
from plyflow.umat.batch import BatchRoutine
from plyflow.umat.compile import FLAGS, compile_umat, compiler_version, generate_cached
from plyflow.umat.library import UmatLibrary
from plyflow.umat.scenes import find_scene
from umatgen.scene import SceneError


@dataclass(frozen=True)
class Umat:
    """Source, manifest and loaded library of a scene; whether the source came from the cache."""

    source: str
    manifest: dict[str, Any]
    library: UmatLibrary
    cached: bool
    provenance: Provenance


def generate_scene(
    name: str, form: str | None = None, fibre_fraction: float | None = None
) -> tuple[str, dict[str, Any], bool]:
    """Source and manifest of a shipped scene or of a file NAME.toml, and whether they came from the cache.

    form and fibre_fraction [-], the V0 of a case, take the place of the scene's own.

    Raises
    ------
    InputError
        Unknown scene; the message lists the known ones. A scene file with another fibre fraction.
    """
    scene = find_scene(name, fibre_fraction)
    try:
        return generate_cached(scene if form is None else replace(scene, form=form))
    except SceneError as error:
        raise InputError(f"--form {form}: {error}") from error


def prepare_umat(scene: str = "default", fibre_fraction: float | None = None) -> Umat:
    """Generate, compile and load a scene, for a case with the initial fibre fraction V0 [-] if given.

    Raises
    ------
    InputError
        Unknown scene, or a file with another fibre fraction.
    ToolError
        The compiler is missing or refuses the source.
    """
    source, manifest, cached = generate_scene(scene, fibre_fraction=fibre_fraction)
    flags = tuple(flag.replace("fixed", manifest["scene"]["form"]) for flag in FLAGS)
    batch = BatchRoutine(find_scene(scene, fibre_fraction))
    library = UmatLibrary(compile_umat(source, flags), batch)
    provenance = Provenance(
        package_version(), manifest["generator_version"], dict(manifest["scene"]), source_hash(source), compiler_version(),
        " ".join(flags), batch.says,
    )  # fmt: skip
    return Umat(source, manifest, library, cached, provenance)
