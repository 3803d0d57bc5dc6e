"""Shared libraries that CalculiX loads: the native face of a scene, and any UMAT behind the adapter."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from plyflow.errors import InputError, ToolError
from plyflow.umat.compile import FLAGS, cache_folder, compiler, compiler_version, support_source
from umatgen.pipeline import calculix_names, native_calculix
from umatgen.scene import Scene, SceneError

OWN_FLAGS = ("-O2", "-fPIC", "-std=f2018", "-fopenmp")
STANDINS, ADAPTER = "calculix_standins.f90", "abaqusnl_adapter.f90"
ADAPTER_SYMBOL = "PFUMAT"


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
    """Source of the native door's face of a scene.

    Raises
    ------
    InputError
        The scene has no such face; the message says which choice is in the way.
    """
    try:
        return native_calculix(scene)
    except SceneError as error:
        raise InputError(str(error)) from error


def library_name(scene: Scene) -> str:
    """Name of the library of a scene without lib and .so."""
    return calculix_names(scene)[0]


def native_material(scene: Scene) -> str:
    """Name of *MATERIAL behind the native door."""
    return calculix_names(scene)[1]


def native_face(scene: Scene) -> Face:
    """Return the native door's face of a scene: S(C1, C0) and dS/dE.

    Raises
    ------
    InputError
        The scene has no such face.
    ToolError
        No compiler.
    """
    path = build_library({STANDINS: own_source(STANDINS), "native.for": native_text(scene)})
    return Face(native_material(scene), library_name(scene), path)


def adapter_face(source: str, name: str, flags: Sequence[str] = FLAGS) -> Face:
    """Any UMAT behind the @ABAQUSNL_ door.

    Parameters
    ----------
    source
        Text of a UMAT in fixed form.
    name
        Of the library: capital letters and digits.
    flags
        Of the compiler for the UMAT.

    Raises
    ------
    InputError
        The name is none that CalculiX can read.
    ToolError
        No compiler, or it refuses the source.
    """
    if not (name.isalnum() and name.isascii() and name == name.upper() and len(name) <= 40):
        raise InputError(f"library name '{name}': use at most 40 capital letters and digits, CalculiX reads no other")
    path = build_library({STANDINS: own_source(STANDINS), ADAPTER: own_source(ADAPTER), "umat.for": source}, flags)
    return Face(f"@ABAQUSNL_{name}_{ADAPTER_SYMBOL}", name, path)


def own_source(name: str) -> str:
    """Text of a hand-written Fortran file of umat/calculix.

    Raises
    ------
    ToolError
        The installation is incomplete.
    """
    return support_source(f"calculix/{name}").read_text(encoding="utf-8")


def build_library(sources: Mapping[str, str], flags: Sequence[str] = FLAGS) -> Path:
    """Shared library of sources by file name, modules before their users; from the cache if it is there.

    Files ending in .f90 are compiled with the flags of hand-written code, others with `flags`.

    Raises
    ------
    ToolError
        No compiler, or it refuses a source.
    """
    key = hashlib.sha256()
    for text in (*sources, *sources.values(), compiler_version(), *flags, *OWN_FLAGS):
        key.update(text.encode() + b"\0")
    target = cache_folder() / "calculix" / f"face-{key.hexdigest()[:32]}.so"
    if not target.is_file():
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=target.parent) as name:
            os.replace(_link(sources, flags, Path(name)), target)
    return target


def _link(sources: Mapping[str, str], flags: Sequence[str], folder: Path) -> Path:
    objects = []
    for name, text in sources.items():
        (folder / name).write_text(text, encoding="utf-8")
        chosen = OWN_FLAGS if name.endswith(".f90") else flags
        objects.append(folder / f"{name}.o")
        _compile([*chosen, f"-J{folder}", "-c", str(folder / name), "-o", str(objects[-1])])
    result = folder / "face.so"
    _compile(["-shared", "-fopenmp", *(str(path) for path in objects), "-o", str(result)])
    return result


def _compile(arguments: Sequence[str]) -> None:
    answer = subprocess.run([compiler(), *arguments], capture_output=True, text=True, check=False)
    if answer.returncode != 0:
        first = " | ".join(line.strip() for line in answer.stderr.splitlines() if line.strip())[:600]
        raise ToolError(f"the Fortran compiler refused the source for CalculiX: {first}")
