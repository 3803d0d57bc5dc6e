"""The build of CalculiX is found again, is not repeated, and says what is in its way."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from plyflow.errors import ToolError
from plyflow.hosts.calculix import build


@pytest.fixture
def nothing_here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """No ccx in any cache or on the PATH."""
    monkeypatch.setenv("PLYFLOW_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "usual"))
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    monkeypatch.delenv("PLYFLOW_CCX", raising=False)
    return tmp_path


def place(folder: Path, content: bytes = build.MARK) -> Path:
    program = folder / "ccx"
    program.parent.mkdir(parents=True)
    program.write_bytes(content)
    return program


def test_the_program_in_use_has_external_materials(ccx: Path) -> None:
    assert build.supports_external_materials(ccx)
    answer = subprocess.run([str(ccx), "-v"], capture_output=True, text=True, check=False)
    assert "Version" in answer.stdout


def test_a_second_call_runs_nothing(ccx: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def forbidden(*arguments: Any, **settings: Any) -> None:
        raise AssertionError(f"ran {arguments}")

    monkeypatch.setattr(subprocess, "run", forbidden)
    assert build.ensure_ccx() == ccx


def test_a_build_is_found_in_the_cache_in_force_and_in_the_usual_one(nothing_here: Path) -> None:
    assert build.find_ccx() is None
    usual = place(nothing_here / "usual" / "plyflow" / "ccx-2.20-1")
    assert build.find_ccx() == usual
    own = place(nothing_here / "cache" / "ccx-2.20-1")
    assert build.find_ccx() == own


def test_a_program_without_external_materials_is_no_build(nothing_here: Path) -> None:
    place(nothing_here / "cache" / "ccx-2.20-1", b"any other program")
    assert build.find_ccx() is None
    with pytest.raises(ToolError, match="plyflow calculix build"):
        build.require_ccx()


def test_a_program_named_by_the_user_has_to_be_one(nothing_here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PLYFLOW_CCX", str(place(nothing_here / "mine", b"any other program")))
    with pytest.raises(ToolError, match="is no ccx with external materials"):
        build.find_ccx()


def test_without_apt_the_way_by_hand_is_told(nothing_here: Path) -> None:
    with pytest.raises(ToolError, match="-DCALCULIX_EXTERNAL_BEHAVIOURS_SUPPORT and set PLYFLOW_CCX"):
        build.ensure_ccx()


def test_the_sources_are_fetched_from_where_the_system_gets_its_packages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    commands: list[Sequence[str]] = []

    def run(command: Sequence[str], what: str, folder: Path | None = None) -> str:
        commands.append(command)
        return "mirror.test/debian/ stable main\nmirror.test/debian/ stable main\n"

    monkeypatch.setattr(build, "_run", run)
    options = build._private_apt(tmp_path)
    assert (tmp_path / "sources.list").read_text() == "deb-src mirror.test/debian/ stable main\n"
    assert f"Dir::Etc::SourceList={tmp_path / 'sources.list'}" in options
    assert "Dir::Etc::SourceParts=/dev/null" in options
    assert [command[1] for command in commands] == ["indextargets"]


def test_no_registry_is_written_into_the_project() -> None:
    text = Path(build.__file__).read_text()
    assert "://" not in text


def test_the_compilation_tells_how_far_it_is(tmp_path: Path) -> None:
    script = "for i in 1 2 3 4; do echo gcc -c $i.c; done"
    told: list[str] = []
    build._make(["sh", "-c", script], "compiling", tmp_path, 4, told.append)
    assert told == [f"compiling: {part} % of 4 files" for part in (20, 50, 70, 100)]


def test_a_compilation_that_fails_is_quoted(tmp_path: Path) -> None:
    with pytest.raises(ToolError, match=r"compiling failed \(exit status 2\): .*undefined reference"):
        build._make(["sh", "-c", "echo undefined reference; exit 2"], "compiling", tmp_path, 4, print)


def test_a_failing_command_is_quoted() -> None:
    with pytest.raises(ToolError, match=r"trying failed \(exit status 3\): what went wrong"):
        build._run(["sh", "-c", "echo what went wrong >&2; exit 3"], "trying")
