"""The face of a scene for CalculiX's native door: its sources, and the shared library that CalculiX loads."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from plyflow.errors import InputError, ToolError
from plyflow.hosts.deck import render
from plyflow.umat.compile import cache_folder, compiler, compiler_version, support_source
from plyflow.umat.scenes import find_scene
from umatgen.pipeline import calculix_names, native_calculix
from umatgen.scene import Scene, SceneError

FLAGS = ("-O2", "-fPIC", "-shared", "-fopenmp")
STANDINS = "calculix_standins.f90"


@dataclass(frozen=True)
class Face:
    """A material as CalculiX names and loads it.

    Parameters
    ----------
    material : name of *MATERIAL.
    library : name of the library without lib and .so.
    path : the library, in the cache.
    """

    material: str
    library: str
    path: Path

    def put_into(self, folder: Path) -> None:
        """Copy the library into a job's folder, where CalculiX is to find it."""
        shutil.copy2(self.path, folder / f"lib{self.library}.so")


def native_text(scene: Scene) -> str:
    """Source of the native door's face of a scene: S(C1, C0) and dS/dE.

    Raises
    ------
    InputError
        The scene has no such face; the message says which choice is in the way.
    """
    try:
        return native_calculix(scene)
    except SceneError as error:
        raise InputError(str(error)) from error


def native_face(scene: Scene, text: str | None = None) -> Face:
    """Compile the face of a scene, or a `text` in place of its source; from the cache if it is there.

    Raises
    ------
    InputError
        The scene has no such face.
    ToolError
        No compiler, or it refuses the source.
    """
    library, material = calculix_names(scene)
    return compiled_face(material, library, text or native_text(scene))


def compiled_face(material: str, library: str, source: str) -> Face:
    """Compile a source for CalculiX; from the cache if it is there.

    Raises
    ------
    ToolError
        No compiler, or it refuses the source.
    """
    standins = support_source(f"calculix/{STANDINS}")
    key = hashlib.sha256("\0".join((source, standins.read_text(), compiler_version(), *FLAGS)).encode())
    target = cache_folder() / "calculix" / f"face-{key.hexdigest()[:32]}.so"
    if not target.is_file():
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=target.parent) as name:
            os.replace(_compile(source, standins, Path(name)), target)
    return Face(material, library, target)


def _compile(source: str, standins: Path, folder: Path) -> Path:
    (folder / "native.for").write_text(source, encoding="utf-8")
    command = [compiler(), *FLAGS, str(standins), "native.for", "-o", "face.so"]
    answer = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if answer.returncode != 0:
        first = " | ".join(line.strip() for line in answer.stderr.splitlines() if line.strip())[:600]
        raise ToolError(f"the Fortran compiler refused the source for CalculiX: {first}")
    return folder / "face.so"


def face_files(name: str) -> dict[str, str]:
    """Name and text of the files of a scene's face, for those who compile it themselves.

    Raises
    ------
    InputError
        Unknown scene, or one without a native face.
    """
    scene = find_scene(name)
    library, material = calculix_names(scene)
    readme = render(
        "calculix_README.txt.j2", scene=scene.name, library=library, material=material, standins=STANDINS, flags=FLAGS
    )
    return {
        f"{scene.name}_native.for": native_text(scene),
        STANDINS: support_source(f"calculix/{STANDINS}").read_text(encoding="utf-8"),
        "README.txt": readme,
    }
