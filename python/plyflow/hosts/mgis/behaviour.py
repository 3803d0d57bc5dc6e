"""A UMAT as a behaviour of MFront's generic interface: metadata and functions in C, around the routine as it is emitted."""

from __future__ import annotations

import hashlib
import os
import shlex
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from plyflow.errors import InputError, ToolError
from plyflow.hosts.deck import render
from plyflow.provenance import package_version
from plyflow.umat.compile import cache_folder, compiler, compiler_version, support_source
from plyflow.umat.prepare import generate_scene

STANDINS, MECHANICS = "abaqus_standins.f90", "mgis/generic_behaviour.h"
# OpenMP keeps the messages of each thread apart; two behaviours in one host each find their own UMAT.
FLAGS = ("-O2", "-fPIC", "-fopenmp", "-shared", "-Wl,-Bsymbolic")
HYPOTHESES = {6: ("Tridimensional",), 4: ("PlaneStrain", "GeneralisedPlaneStrain", "Axisymmetrical")}


@dataclass(frozen=True)
class Behaviour:
    """A behaviour: its name, the files that make its library by name, the command that does it, and the manifest."""

    name: str
    files: Mapping[str, str]
    command: tuple[str, ...]
    manifest: Mapping[str, Any]

    @property
    def library(self) -> str:
        """File name of the shared library."""
        return f"lib{self.name}.so"


def behaviour_of(scene: str) -> Behaviour:
    """The behaviour of a shipped scene or of a file NAME.toml.

    Raises
    ------
    InputError
        Unknown scene, or one without a tangent, which no MGIS host can do without.
    """
    source, manifest, _ = generate_scene(scene)
    if manifest["scene"]["tangent"] == "none":
        raise InputError(f"scene '{manifest['name']}' has no tangent, which MGIS hosts need; choose 'consistent' in a scene file")
    return wrapped(source, manifest)


def wrapped(source: str, manifest: Mapping[str, Any], host_start: bool = False, stem: str = "") -> Behaviour:
    """A UMAT's source and manifest (name, scene, ntens, props, statev) as a behaviour.

    `host_start`: whether DFGRD0 is what the host says, in place of where the point was last. `stem`: name of the source without
    its ending; default that of the manifest.
    """
    scene = manifest["scene"]
    name = "Plyflow" + "".join(part.capitalize() for part in manifest["name"].split("_"))
    fortran = f"{stem or manifest['name']}.{'for' if scene['form'] == 'fixed' else 'f90'}"
    command = (*FLAGS, STANDINS, f"{name}.c", fortran, "-o", f"lib{name}.so")
    text = render(
        "mgis.c.j2",
        behaviour=name,
        source=fortran,
        symbol=scene["entry"].lower() + "_",
        version=package_version(),
        frame=f"Fibre along axis {scene['fibre']}, ply normal along axis {scene['normal']} of the material frame.",
        command="gfortran " + shlex.join(command),
        ntens=manifest["ntens"],
        props=manifest["props"],
        statev=manifest["statev"],
        energies=scene["energies"],
        host_start=host_start,
        hypotheses=HYPOTHESES[manifest["ntens"]],
    )
    support = {Path(one).name: support_source(one).read_text(encoding="utf-8") for one in (STANDINS, MECHANICS)}
    return Behaviour(name, {fortran: source, f"{name}.c": text} | support, command, manifest)


def compiled(behaviour: Behaviour) -> Path:
    """The shared library of a behaviour, from the cache if it is there.

    Raises
    ------
    ToolError
        No compiler, or it refuses a source; C sources need the C compiler that comes with gfortran.
    """
    parts = (*behaviour.files.values(), *behaviour.command, compiler_version())
    key = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]
    target = cache_folder() / "mgis" / key / behaviour.library
    if not target.is_file():
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=target.parent) as name:
            os.replace(_compile(behaviour, Path(name)), target)
    return target


def _compile(behaviour: Behaviour, folder: Path) -> Path:
    for name, text in behaviour.files.items():
        (folder / name).write_text(text, encoding="utf-8")
    answer = subprocess.run([compiler(), *behaviour.command], cwd=folder, capture_output=True, text=True, check=False)
    if answer.returncode != 0:
        first = " | ".join(line.strip() for line in answer.stderr.splitlines() if line.strip())[:600]
        raise ToolError(f"the compiler refused the behaviour {behaviour.name}: {first}")
    return folder / behaviour.library
