"""What is handed on: the wheel works in an empty folder by itself, the source distribution holds all that it is built from."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from email import message_from_bytes
from email.message import Message
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = {"bench": "tensortrax", "laminate": "felupe", "docs": "mkdocs-material"}
BUILT_FROM = ("driver", "umat", "codegen", "python", "CMakeLists.txt", "pyproject.toml", "LICENSE", "README.md")
RUN = ("run", "--material", "IM7-8552", "--temperature", "70", "--layup", "BP", "--json")
# Hides a library that is installed: its name, then the command.
WITHOUT = "import sys; sys.modules[sys.argv.pop(1)] = None; from plyflow.cli import main; sys.exit(main(sys.argv[1:]))"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built in a folder of its own: that of the installation is in use."""
    folder = tmp_path_factory.mktemp("wheel")
    options = ["--no-build-isolation", "--no-deps", f"--config-settings=build-dir={folder / 'build'}", "-w", str(folder)]
    command = [sys.executable, "-m", "pip", "wheel", "-q", *options, str(ROOT)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return next(folder.glob("plyflow-*.whl"))


@pytest.fixture(scope="module")
def unpacked(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("unpacked")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
    return folder


def metadata(unpacked: Path) -> Message:
    return message_from_bytes(next(unpacked.glob("*.dist-info/METADATA")).read_bytes())


def without_site(arguments: list[str], unpacked: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    """Python with the wheel in front, its requirements behind it and no hooks of the installation."""
    others = [path for path in sys.path if path.endswith("site-packages")]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(unpacked), *others])}
    return subprocess.run(
        [sys.executable, "-S", *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def test_the_wheel_runs_a_case_in_an_empty_folder(unpacked: Path, tmp_path: Path) -> None:
    where = without_site(["-c", "import plyflow, umatgen; print(plyflow.__file__, umatgen.__file__)"], unpacked, tmp_path)
    assert all(Path(file).is_relative_to(unpacked) for file in where.stdout.split()), where.stdout
    done = without_site(["-c", "from plyflow.cli import main; import sys; sys.exit(main())", *RUN], unpacked, tmp_path)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["thickness_ratio_final"] == pytest.approx(found["thickness_ratio_1d"], abs=1e-5)
    assert list(tmp_path.iterdir()) == []


def test_the_wheel_is_typed_and_says_who_and_under_which_licence(unpacked: Path) -> None:
    said = metadata(unpacked)
    assert all((unpacked / name / "py.typed").is_file() for name in ("plyflow", "umatgen", "umataudit"))
    assert (said["Author"], said["License-Expression"]) == ("The plyflow authors", "MIT")
    assert "Typing :: Typed" in said.get_all("Classifier", [])
    assert str(said.get_payload()).startswith("# plyflow")
    assert set(said.get_all("Provides-Extra", [])) >= {"test", *EXTRAS}


def test_the_source_distribution_holds_all_that_the_wheel_is_built_from(tmp_path: Path) -> None:
    script = f"from scikit_build_core.build import build_sdist; print(build_sdist({str(tmp_path)!r}))"
    subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, check=True)
    with tarfile.open(next(tmp_path.glob("*.tar.gz"))) as archive:
        held = {name.partition("/")[2] for name in archive.getnames()}
    listed = subprocess.run(["git", "ls-files", *BUILT_FROM], cwd=ROOT, capture_output=True, text=True, check=True)
    tracked = listed.stdout.split()
    assert len(tracked) > 250
    assert [name for name in tracked if name not in held] == []


def test_the_citation_has_the_version_and_the_licence_of_the_package() -> None:
    cited = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"version: {PROJECT['version']}\n" in cited and f"license: {PROJECT['license']}\n" in cited


@pytest.mark.parametrize(
    ("extra", "library", "command"),
    [
        ("bench", "tensortrax", ["bench", "--quick"]),
        ("laminate", "felupe", ["laminate", "--material=IM7-8552", "--temperature=70", "--layup=BP"]),
    ],
)
def test_a_missing_extra_is_named(extra: str, library: str, command: list[str], tmp_path: Path) -> None:
    call = [sys.executable, "-c", WITHOUT, library, *command]
    done = subprocess.run(call, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert f"{library} is not installed" in done.stderr and f"pip install 'plyflow[{extra}]'" in done.stderr
    assert done.stderr.count("\n") == 1 and list(tmp_path.iterdir()) == []
