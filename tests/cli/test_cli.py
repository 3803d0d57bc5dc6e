"""The command line: one line on stderr and status 2 for every error, one JSON object for --json."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from plyflow.cli import GROUPS, MODULES, load, main

RUN = ("run", "--material", "IM7-8552", "--temperature", "70", "--layup", "BP")
LAW = ("law1d", "--material", "IM7-8552", "--temperature", "70", "--layup", "CP")
ERRORS: list[tuple[Sequence[str], str]] = [
    ((*RUN, "--material", "steel"), "unknown material 'steel'"),
    ((*RUN, "--material", "a.toml"), "a.toml cannot be read"),
    ((*RUN, "--temperature", "20"), "outside 30 to 90"),
    ((*RUN, "--temperature", "hot"), "--temperature"),
    ((*RUN, "--temperature", "343.15"), "(343.15 K are 70 degC)"),
    ((*RUN, "--ply-thickness", "0"), "--ply-thickness 0 mm must be above 0"),
    (("run", "--material", "IM7-8552", "--layup", "BP"), "no temperature given, and load ramp-dwell has none: give --temperature"),
    ((*RUN, "--layup", "QI"), "unknown layup 'QI'"),
    ((*RUN, "--width", "0"), "width 0 mm"),
    ((*RUN, "--width", "-15"), "width -15 mm"),
    ((*RUN, "--width", "nan"), "width nan mm"),
    ((*RUN, "--load", "sudden"), "unknown load 'sudden'"),
    *(((*RUN, "--width", width), "mm must be from 0.001 to 1e+06 mm") for width in ("1e300", "1e-300")),
    ((*RUN, "--gamma-lock", "0"), "gamma_lock = 0 deg must be from 3"),
    ((*RUN, "--gamma-lock", "1.4"), "give it in degrees, 1.4 radians are 80.21 degrees"),
    ((*RUN, "--set", "eps_lock=-5e-5"), "eps_lock = -5e-05 must be below 0 by at least 0.0001"),
    ((*RUN, "--set", "k=1.1"), "Eq. A.1 gives no gamma_lock for k = 1.1"),
    ((*RUN, "--gamma-lock", "90"), "gamma_lock = 90 deg"),
    ((*RUN, "--set", "eps_lock=0.1"), "eps_lock = 0.1 must be below 0"),
    ((*RUN, "--set", "k=2"), "k = 2 must be below"),
    ((*RUN, "--set", "colour=1"), "unknown parameter 'colour'"),
    ((*RUN, "--set", "kappa"), "write NAME=VALUE"),
    ((*RUN, "--set", "kappa=many"), "write NAME=VALUE"),
    ((*RUN, "--scene", "nowhere"), "'nowhere'"),
    ((*RUN, "--refine", "0"), "refinement 0"),
    (("generate", "nowhere"), "'nowhere'"),
    (("walk",), "No such command 'walk'"),
    ((*LAW, "--layup", "QI"), "unknown layup 'QI'"),
    ((*LAW, "--temperature", "95"), "outside 30 to 90"),
    ((*LAW, "--load", "sudden"), "unknown load 'sudden'"),
    ((*LAW, "--load", "none.csv"), "none.csv cannot be read"),
    ((*LAW, "--every", "0"), "--every 0 s must be above 0"),
    ((*LAW, "--match-time", "0"), "not compacted yet"),
    ((*LAW, "--match-time", "1e4"), "within the load programme, 0 to 1200 s"),
    ((*LAW, "--set", "kappa=1"), "unknown parameter 'kappa'"),
    ((*LAW, "--layup", "BP", "--as-test", "a.csv"), "the options make 2"),
    ((*LAW, "--as-test", "a.csv", "--force-noise", "-1"), "must not be below 0"),
    ((*LAW, "--block-thickness", "0"), "h0 = 0 mm must be above 0"),
    ((*LAW, "--layup", "BP", "--plies", "5"), "5 plies are no whole number of blocks of 4; give a multiple of 4"),
]


@pytest.mark.parametrize(("arguments", "fragment"), ERRORS, ids=[" ".join(error[0][-2:]) for error in ERRORS])
def test_every_error_is_one_line_and_status_2(
    arguments: Sequence[str],
    fragment: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([*arguments, *(("-o", "out") if arguments[0] in {"run", "generate"} else ())]) == 2
    out, error = capsys.readouterr()
    assert error.count("\n") == 1
    assert error.startswith("plyflow: error: ")
    assert fragment in error
    assert out == ""
    assert list(tmp_path.iterdir()) == []


def test_a_missing_compiler_is_one_line_and_status_2(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("FC", "no-such-compiler")
    assert main([*RUN, "-o", str(tmp_path / "out")]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert "no-such-compiler" in error
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", [("generate",), RUN, ("demo",)], ids=["generate", "run", "demo"])
def test_a_folder_that_cannot_be_written_is_one_line_and_status_2(
    command: Sequence[str], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    in_the_way = tmp_path / "file"
    in_the_way.write_text("kept")
    assert main([*command, "-o", str(in_the_way)]) == 2
    _, error = capsys.readouterr()
    assert error.count("\n") == 1
    assert "cannot write into" in error
    assert in_the_way.read_text() == "kept"


def in_its_own_process(*arguments: str) -> subprocess.CompletedProcess[str]:
    code = "import sys; from plyflow.cli import main; sys.exit(main())"
    return subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, check=False)


def test_json_is_one_object_and_nothing_else() -> None:
    finished = in_its_own_process(*RUN, "--width", "15", "--load", "ramp-dwell", "--json")
    assert (finished.returncode, finished.stderr) == (0, "")
    result = json.loads(finished.stdout)
    assert result["thickness_ratio_final"] == pytest.approx(result["thickness_ratio_1d"], abs=1e-3)
    assert result["width_ratio_final"] == pytest.approx(result["width_ratio_1d"], abs=2e-3)


def test_an_error_in_a_process_of_its_own_leaves_no_traceback() -> None:
    finished = in_its_own_process(*RUN, "--temperature", "91", "--json")
    assert (finished.returncode, finished.stdout) == (2, "")
    assert finished.stderr.count("\n") == 1
    assert "Traceback" not in finished.stderr


def test_run_shows_result_and_assumptions_and_writes_its_files(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main([*RUN, "--gamma-lock", "75", "--set", "kappa=5e4", "-o", str(tmp_path / "out")]) == 0
    out = capsys.readouterr().out
    for expected in ("1D law", "gamma_lock = 75 deg", "kappa = 50000", "l0_over_d = 4294", "increments"):
        assert expected in out
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"result.json", "history.csv", "increments.csv"}
    written = json.loads((tmp_path / "out" / "result.json").read_text())
    assert written["provenance"]["inputs"]["kappa"] == 5e4
    rows = (tmp_path / "out" / "history.csv").read_text().splitlines()
    assert len(rows) == written["increments"] + 2


def test_generate_writes_source_and_manifest_and_prints_both_paths(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main(["generate", "-o", str(tmp_path)]) == 0
    source, manifest = tmp_path / "default.for", tmp_path / "default.json"
    assert capsys.readouterr().out.split() == [str(source), str(manifest)]
    assert "SUBROUTINE UMAT" in source.read_text().upper()
    assert json.loads(manifest.read_text())["name"] == "default"
    assert {path.name for path in tmp_path.iterdir()} == {"default.for", "default.json"}


HEAVY = {"numpy", "pandas", "sympy", "matplotlib", "scipy", "dask", "pyarrow", "lmfit", "umatgen", "umataudit"}


def loaded_by(arguments: Sequence[str]) -> set[str]:
    """Packages, and modules of the command line, that a call has imported at its end."""
    code = f"import sys; from plyflow.cli import main; main({list(arguments)!r}); print(*sys.modules, file=sys.stderr)"
    finished = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names = finished.stderr.split()
    return {name.split(".")[0] for name in names} | {name for name in names if name.startswith("plyflow.cli.")}


@pytest.mark.parametrize("arguments", [["--help"], ["-h"], ["--version"], []])
def test_the_help_of_all_commands_imports_nothing_heavy_and_no_command(arguments: Sequence[str]) -> None:
    loaded = loaded_by(arguments)
    assert "typer" in loaded and not loaded & HEAVY
    assert not {name for name in loaded if name.startswith("plyflow.cli.")}


@pytest.mark.parametrize("name", [next(iter(commands)) for _, _, commands in GROUPS])
def test_the_help_of_a_command_imports_nothing_heavy_but_its_own_module(name: str) -> None:
    loaded = loaded_by([name, "--help"])
    assert not loaded & HEAVY
    assert {one for one in loaded if one.startswith("plyflow.cli.")} == {f"plyflow.cli.{MODULES[name]}", "plyflow.cli.shared"}


def test_the_table_of_commands_says_what_the_commands_say(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["-h"]) == 0
    shown = capsys.readouterr().out
    places = []
    for panel, _, commands in GROUPS:
        assert panel in shown
        for name, said in commands.items():
            assert load(name).help.split("\n\n")[0].replace("\n", " ") == said
            places.append(shown.index(f"│ {name} "))
    assert places == sorted(places)


def test_version_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("plyflow ")
