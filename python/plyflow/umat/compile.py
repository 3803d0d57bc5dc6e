"""Generated source and compiled UMATs, each made once: a cache keyed by everything the result depends on."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import umatgen
from plyflow.errors import ToolError
from umatgen.scene import Scene

FLAGS: tuple[str, ...] = ("-O2", "-fPIC", "-ffixed-form", "-std=legacy", "-frecursive")
PROMOTE = "-freal-8-real-16"
QUAD_FLAGS: tuple[str, ...] = (*FLAGS, PROMOTE)


def cache_folder() -> Path:
    """Folder of the cache: $PLYFLOW_CACHE, else plyflow under $XDG_CACHE_HOME, else under ~/.cache."""
    chosen = os.environ.get("PLYFLOW_CACHE")
    return Path(chosen) if chosen else Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "plyflow"


def compiler() -> str:
    """Path of the Fortran compiler: $FC, else gfortran.

    Raises
    ------
    ToolError
        There is none; says how to get it.
    """
    wanted = os.environ.get("FC") or "gfortran"
    found = shutil.which(wanted)
    if found is None:
        raise ToolError(
            f"the Fortran compiler '{wanted}' was not found; install it (Debian, Ubuntu: apt-get install gfortran) "
            "or give the path of one, without options, in the environment variable FC"
        )
    return found


def compiler_version() -> str:
    """First line of the compiler's --version."""
    return _version_of(compiler())


@functools.lru_cache
def _version_of(path: str) -> str:
    answer = subprocess.run([path, "--version"], capture_output=True, text=True, check=False)
    return answer.stdout.splitlines()[0] if answer.stdout else "unknown"


def support_source(name: str = "abaqus_standins.f90") -> Path:
    """A hand-written Fortran file that goes with the generated source; by default Abaqus's stand-ins.

    Raises
    ------
    ToolError
        The installation is incomplete.
    """
    beside_source = Path(umatgen.__file__).resolve().parents[2] / "umat" / name
    for candidate in (Path(str(resources.files("plyflow"))) / "data" / "umat" / name, beside_source):
        if candidate.is_file():
            return candidate
    raise ToolError(f"{name} is missing from the installation; install plyflow again")


def generate_cached(scene: Scene) -> tuple[str, dict[str, Any], bool]:
    """Source and manifest of a scene, and whether they were in the cache.

    The key covers the scene and the text of the generator itself, so a changed generator generates again.
    """
    entry = cache_folder() / "source" / f"{_scene_key(scene)}.json"
    cached = entry.is_file()
    if not cached:
        from umatgen.pipeline import generate  # noqa: PLC0415 - SymPy takes a second to start, the cache does without

        made = generate(scene)
        _write(entry, json.dumps({"source": made.source, "manifest": made.manifest}).encode())
    stored = json.loads(entry.read_text())
    return stored["source"], stored["manifest"], cached


def generate_batch_cached(scene: Scene) -> str:
    """Source of the batch routine of a scene, from the cache if it is there.

    Raises
    ------
    SceneError
        The scene has none.
    """
    entry = cache_folder() / "source" / f"{_scene_key(scene)}_batch.f90"
    if not entry.is_file():
        from umatgen.pipeline import generate_batch  # noqa: PLC0415 - as above

        _write(entry, generate_batch(scene).encode())
    return entry.read_text()


def _scene_key(scene: Scene) -> str:
    return _digest([json.dumps(scene.as_dict(), sort_keys=True), _generator_digest()])


@functools.lru_cache
def _generator_digest() -> str:
    root = Path(umatgen.__file__).parent
    files = sorted(p for p in root.rglob("*") if p.suffix in {".py", ".j2", ".toml"})
    return _digest([p.relative_to(root).as_posix() + p.read_text() for p in files])


def compile_umat(source: str, flags: Sequence[str] = FLAGS) -> Path:
    """Shared library of a UMAT source with the Abaqus stand-ins, compiled unless it is in the cache.

    With `QUAD_FLAGS` every double precision number is promoted to quadruple precision, and the library holds
    plyflow_quad_call (see `plyflow.umat.library.QuadLibrary`).

    Raises
    ------
    ToolError
        No compiler, or the compiler refuses the source (its first messages are shown).
    """
    path = compiler()
    support = [support_source()] + ([support_source("quad_call.f90")] if PROMOTE in flags else [])
    key = _digest([source, *(p.read_text() for p in support), compiler_version(), " ".join(flags)])
    library = cache_folder() / "library" / f"umat-{key}.so"
    if not library.is_file():
        with tempfile.TemporaryDirectory() as folder:
            _write(library, _compile(path, source, flags, support, Path(folder)).read_bytes())
    return library


def compile_batch(source: str, flags: Sequence[str], cpu: str) -> Path:
    """Shared library of a batch routine, compiled unless it is in the cache; `cpu` tells for which CPU.

    Raises
    ------
    ToolError
        No compiler, or the compiler refuses the source or the flags.
    """
    path = compiler()
    library = cache_folder() / "library" / f"batch-{_digest([source, compiler_version(), ' '.join(flags), cpu])}.so"
    if not library.is_file():
        with tempfile.TemporaryDirectory() as folder:
            text, target = Path(folder) / "batch.f90", Path(folder) / "batch.so"
            text.write_text(source)
            _run([path, *flags, f"-J{folder}", "-shared", str(text), "-o", str(target)])
            _write(library, target.read_bytes())
    return library


def _compile(path: str, source: str, flags: Sequence[str], support: Sequence[Path], folder: Path) -> Path:
    text, target = folder / "umat.for", folder / "umat.so"
    text.write_text(source)
    plain = [flag for flag in flags if not flag.startswith(("-ffixed-form", "-std="))]
    objects = [str(folder / f"{file.stem}.o") for file in support]
    for file, made in zip(support, objects, strict=True):
        # The caller of the promoted UMAT spells its kinds out; promoting it too would change its own interface.
        own = plain if file.stem == "abaqus_standins" else [flag for flag in plain if flag != PROMOTE]
        _run([path, *own, "-std=f2018", "-fopenmp", f"-J{folder}", "-c", str(file), "-o", made])
    _run([path, *flags, f"-J{folder}", "-shared", str(text), *objects, "-o", str(target)])
    if not target.is_file():
        raise ToolError(
            f"'{path}' wrote no library: is it a Fortran compiler? Name gfortran in the environment variable FC"
        )
    return target


def _run(command: list[str]) -> None:
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    if answer.returncode != 0:
        first = " | ".join(line.strip() for line in answer.stderr.splitlines() if line.strip())[:600]
        raise ToolError(f"the Fortran compiler refused the source: {first}")


def _digest(parts: Sequence[str]) -> str:
    return hashlib.sha256("".join(f"{part}\0" for part in parts).encode()).hexdigest()[:32]


def _write(target: Path, content: bytes) -> None:
    """Write a whole file or none."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=target.parent)
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
        os.replace(name, target)
    except OSError as error:
        raise ToolError(
            f"cannot write the cache folder {cache_folder()}: {error.strerror}; set PLYFLOW_CACHE to a writable folder"
        ) from error
