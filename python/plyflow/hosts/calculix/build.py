"""CalculiX with external materials, built once from the distribution's source package and kept in the cache.

Debian's and Ubuntu's binary package leaves external materials out. This fetches the source package of the
version that the system's package lists offer, builds it with CALCULIX_EXTERNAL_BEHAVIOURS_SUPPORT and puts the
program in the cache folder. The system's own list of package sources is read, not changed: source entries go
into a list of this build alone.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path

from plyflow.errors import ToolError
from plyflow.umat.compile import cache_folder

PACKAGE = "calculix-ccx"
BUILD_PACKAGES = ("gcc", "gfortran", "make", "dpkg-dev", "libspooles-dev", "libarpack2-dev", "liblapack-dev")
SWITCH = "CALCULIX_EXTERNAL_BEHAVIOURS_SUPPORT"
DEFINITIONS = ("ARCH=Linux", "SPOOLES", "ARPACK", "MATRIXSTORAGE", "USE_MT=1", SWITCH)
MARK = b"unable to load function"
_ERROR_LINES = 12

Say = Callable[[str], None]


def supports_external_materials(program: Path) -> bool:
    """Whether a ccx program was built with external materials: their loader's message is in it."""
    try:
        return MARK in program.read_bytes()
    except OSError:
        return False


def find_ccx() -> Path | None:
    """Find a ccx with external materials: $PLYFLOW_CCX, the newest of the cache, one on the PATH, or None.

    Raises
    ------
    ToolError
        $PLYFLOW_CCX names a program that is none, or that lacks external materials.
    """
    chosen = os.environ.get("PLYFLOW_CCX")
    if chosen:
        if not supports_external_materials(Path(chosen)):
            raise ToolError(
                f"PLYFLOW_CCX = {chosen} is no ccx with external materials; unset the variable and build one with "
                "'plyflow calculix build', or name another"
            )
        return Path(chosen)
    on_path = [Path(found) for found in (shutil.which(name) for name in ("ccx", "ccx_MFront")) if found]
    cached = [ccx for folder in _caches() for ccx in sorted(folder.glob("ccx-*/ccx"), reverse=True)]
    return next((program for program in [*cached, *on_path] if supports_external_materials(program)), None)


def _caches() -> list[Path]:
    """The cache in force, then the one that is in force without PLYFLOW_CACHE: a build is too dear to repeat."""
    usual = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "plyflow"
    return list(dict.fromkeys([cache_folder(), usual]))


def require_ccx() -> Path:
    """`find_ccx`, or an error that says how to get one.

    Raises
    ------
    ToolError
        There is none.
    """
    program = find_ccx()
    if program is None:
        raise ToolError(
            "no CalculiX with external materials was found; 'plyflow calculix build' makes one (some minutes, "
            f"once), or set PLYFLOW_CCX to a ccx built with {SWITCH}"
        )
    return program


def ensure_ccx(say: Say = print, jobs: int = 2) -> Path:
    """`find_ccx`; if there is none, build it.

    Parameters
    ----------
    say
        Told what is going on, one line at a time.
    jobs
        Processes of the compilation.

    Raises
    ------
    ToolError
        No apt, no rights to install the libraries, no network, or the source does not compile.
    """
    program = find_ccx()
    if program is not None:
        return program
    if shutil.which("apt-get") is None:
        raise ToolError(
            "apt-get was not found: the automatic build needs Debian or Ubuntu; build CalculiX yourself with "
            f"-D{SWITCH} and set PLYFLOW_CCX to it"
        )
    _install(say)
    cache_folder().mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="ccx-", dir=cache_folder()) as name:
        folder = Path(name)
        source, version = _fetch(folder, say)
        say(f"compiling CalculiX {version} with external materials (1 to 6 minutes)")
        return _kept(_compile(source, jobs, say), version)


def _kept(program: Path, version: str) -> Path:
    """Move the program to its place in the cache, whole or not at all."""
    if not supports_external_materials(program):
        raise ToolError(
            f"the ccx just built from {PACKAGE} {version} has no external materials: its switch may no longer be "
            f"{SWITCH}; set PLYFLOW_CCX to a ccx that has them"
        )
    target = cache_folder() / f"ccx-{version}" / "ccx"
    target.parent.mkdir(exist_ok=True)
    staged = target.with_name(f".ccx-{os.getpid()}")
    shutil.copy2(program, staged)
    os.replace(staged, target)
    return target


def _install(say: Say) -> None:
    """Install the libraries that ccx is linked with, where they are missing."""
    query = ["dpkg-query", "-W", "-f", "${Package} ${Status}\n", *BUILD_PACKAGES]
    listed = subprocess.run(query, capture_output=True, text=True, check=False).stdout.splitlines()
    missing = [name for name in BUILD_PACKAGES if f"{name} install ok installed" not in listed]
    if not missing:
        return
    command = ["apt-get", "install", "-y", "-q", "--no-install-recommends", *missing]
    if os.geteuid() != 0:
        if shutil.which("sudo") is None:
            raise ToolError(f"missing: {' '.join(missing)}; install them as root: {' '.join(command)}")
        command = ["sudo", "-n", *command]
    say(f"installing {' '.join(missing)}")
    _run(command, "installing the libraries of CalculiX")


def _fetch(folder: Path, say: Say) -> tuple[Path, str]:
    """Folder of the unpacked source and its version."""
    options = _private_apt(folder)
    say(f"fetching the source package {PACKAGE}")
    _run(["apt-get", *options, "-q", "update"], "reading the lists of source packages")
    _run(["apt-get", *options, "-q", "source", PACKAGE], f"fetching {PACKAGE}", folder / "source")
    found = sorted((folder / "source").glob(f"{PACKAGE}-*/ccx_*/src/Makefile"))
    described = sorted((folder / "source").glob(f"{PACKAGE}_*.dsc"))
    if not found or not described:
        raise ToolError(
            f"the source package {PACKAGE} has no ccx_*/src/Makefile: its layout is not known; build CalculiX "
            "yourself and set PLYFLOW_CCX"
        )
    return found[0].parent, described[0].stem.partition("_")[2]


def _private_apt(folder: Path) -> list[str]:
    """Options of apt-get for a list of sources of its own, made from where the system gets its packages."""
    for name in ("source", "lists/partial", "cache/archives/partial"):
        (folder / name).mkdir(parents=True)
    wanted = "$(REPO_URI) $(RELEASE) $(COMPONENT)"
    places = _run(
        ["apt-get", "indextargets", "--format", wanted, "Created-By: Packages"],
        "reading the system's list of package sources",
    )
    entries = sorted({f"deb-src {line}" for line in places.splitlines() if line.strip()})
    if not entries:
        raise ToolError("apt knows no package source; run apt-get update as root, then try again")
    (folder / "sources.list").write_text("\n".join(entries) + "\n")
    settings = {
        "Dir::Etc::SourceList": folder / "sources.list",
        "Dir::Etc::SourceParts": "/dev/null",
        "Dir::State::Lists": folder / "lists",
        "Dir::Cache": folder / "cache",
        "APT::Sandbox::User": "root",
    }
    return [text for key, value in settings.items() for text in ("-o", f"{key}={value}")]


def _compile(source: Path, jobs: int, say: Say) -> Path:
    version = source.parent.name
    spooles = Path("/usr/include/spooles")
    if not spooles.is_dir():
        raise ToolError(f"the headers of SPOOLES were not found in {spooles}; install libspooles-dev")
    definitions = " ".join(f"-D{name}" for name in DEFINITIONS)
    command = [
        "nice", "make", f"-j{jobs}", version,
        f"CFLAGS=-O2 -w -I{spooles} {definitions}",
        "FFLAGS=-O2 -w -fallow-argument-mismatch",
    ]  # fmt: skip
    files = sum(path.suffix in (".c", ".f") for path in source.iterdir())
    _make(command, f"compiling CalculiX ({version})", source, files, say)
    return source / version


def _make(command: Sequence[str], what: str, folder: Path, files: int, say: Say) -> None:
    """Run make, telling each tenth of the files compiled."""
    last: deque[str] = deque(maxlen=_ERROR_LINES)
    compiled = told = 0
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace"
    ) as process:
        for line in process.stdout or ():
            last.append(line.strip())
            compiled += " -c " in line
            if 10 * compiled // max(files, 1) > told:
                told = 10 * compiled // files
                say(f"{what}: {10 * told} % of {files} files")
    if process.returncode != 0:
        raise ToolError(f"{what} failed (exit status {process.returncode}): {' | '.join(last)}")


def _run(command: Sequence[str], what: str, folder: Path | None = None) -> str:
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    answer = subprocess.run(
        command, capture_output=True, text=True, check=False, cwd=folder, env=environment, errors="replace"
    )
    if answer.returncode != 0:
        said = [line.strip() for line in (answer.stderr or answer.stdout).splitlines() if line.strip()]
        last = " | ".join(said[-_ERROR_LINES:])
        raise ToolError(f"{what} failed (exit status {answer.returncode}): {last}")
    return answer.stdout
