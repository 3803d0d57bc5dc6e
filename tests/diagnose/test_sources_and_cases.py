"""What `plyflow drive` takes: fixed and free form, libraries, case files and programmes; and what it refuses."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from plyflow.cli import main
from plyflow.diagnose.case import read_case
from plyflow.diagnose.check import diagnose, refused_counts
from plyflow.diagnose.library import load_umat
from plyflow.errors import InputError
from plyflow.umat.library import UmatLibrary
from plyflow.umat.prepare import prepare_umat

SOURCE = Path(__file__).parent / "umats" / "neo_hooke.f"
CASE = """
library = ./another.so     ! the one on the command line counts
history = unwanted.csv
props = 1.3 4.1
props = {mistake}
begin controls
  initial_increment = 0.1
  maximum_increment = 0.1
end controls
begin step
  duration = 1.0
  F11 = 1.2    ! stretched
  F12 = 0.3
  S22 = 0.0
end step
"""


@pytest.fixture
def case_file(tmp_path: Path) -> Path:
    path = tmp_path / "case.txt"
    path.write_text(CASE.format(mistake=2))
    return path


def free_form(fixed: str) -> str:
    """The test's source in free form: comments with !, continuations with & at the line before."""
    lines: list[str] = []
    for line in fixed.splitlines():
        if line.startswith("C"):
            lines.append("!" + line[1:])
        elif re.match(r" {5}\d", line):
            lines[-1] += " &"
            lines.append("      " + line[6:])
        else:
            lines.append(line)
    return "\n".join(lines) + "\n"


def test_a_case_file_runs_with_the_umat_of_the_command_line(neo_hooke: UmatLibrary, case_file: Path) -> None:
    diagnosis = diagnose(neo_hooke, read_case(case_file))
    assert diagnosis.history.completed
    assert diagnosis.history.increments == 10
    assert diagnosis.mistakes[0].startswith("no Jaumann terms")
    assert sorted(path.name for path in case_file.parent.iterdir()) == ["case.txt"]


def test_free_form_and_a_library_give_the_same_diagnosis(
    neo_hooke: UmatLibrary, case_file: Path, tmp_path: Path
) -> None:
    source = tmp_path / "umat.f90"
    source.write_text(free_form(SOURCE.read_text()).replace("INCLUDE 'ABA_PARAM.INC'", "IMPLICIT REAL*8(A-H,O-Z)"))
    expected = diagnose(neo_hooke, read_case(case_file)).worst.difference
    for path in (source, neo_hooke.path):
        assert diagnose(load_umat(path), read_case(case_file)).worst.difference == pytest.approx(expected, rel=1e-9)


def test_the_command_returns_1_for_a_wrong_tangent_and_0_for_a_right_one(
    case_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["drive", str(SOURCE), str(case_file)]) == 1
    said = capsys.readouterr().out
    assert "DDSDDE is wrong in 10 of 10 increments" in said
    assert "no Jaumann terms" in said
    assert main(["drive", str(SOURCE), "general", "--props", "1.3,4.1,0", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["tangent_right"] is True
    assert answer["increments_checked"] == 10
    assert answer["props"] == [1.3, 4.1, 0.0]
    assert "Fortran" in answer["compiler"]


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("begin step\n", "the block 'step' does not end"),
        ("end step\n", "line 1: 'end step' where 'begin NAME' is due"),
        ("begin step\nbegin controls\n", "line 2: 'begin controls' where 'end step' is due"),
    ],
)
def test_a_case_whose_blocks_do_not_fit_is_refused(text: str, what: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.txt"
    path.write_text(text)
    with pytest.raises(InputError, match=re.escape(what)):
        read_case(path)


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (["missing.f", "general"], "missing.f is no file"),
        ([str(SOURCE), "nosuch"], "neither a file nor one of uniaxial"),
        ([str(SOURCE), "general", "--props", "1,x"], "'x' is no number"),
        ([__file__, "general"], "the ending '.py' is not known"),
    ],
)
def test_what_cannot_be_used_is_named_in_one_line(
    arguments: list[str], what: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["drive", *arguments]) == 2
    said = capsys.readouterr().err
    assert what in said
    assert said.count("\n") == 1


WRONG_LINES = [
    ("  S22 = 0.0", "  S22x = 0.0", "unknown key 's22x'"),
    ("history = unwanted.csv", "history = unwanted.csv\nstrange = 3", "unknown key 'strange'"),
    ("props = 1.3 4.1", "props = 1.3 4.x", "4.x"),
]


@pytest.mark.parametrize(("right", "wrong", "what"), WRONG_LINES)
def test_what_the_driver_refuses_is_named_by_its_line_in_the_users_file(
    right: str, wrong: str, what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = CASE.format(mistake=0).replace(right, wrong)
    path = tmp_path / "mine.txt"
    path.write_text(text)
    line = next(number for number, entry in enumerate(text.splitlines(), 1) if entry == wrong.splitlines()[-1])
    assert main(["drive", str(SOURCE), str(path)]) == 2
    said = capsys.readouterr().err
    assert f"{path}:{line}: " in said
    assert what in said
    assert "case.txt" not in said


def test_what_the_driver_refuses_of_a_programme_names_no_file(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["drive", str(SOURCE), "general", "--n-statev", "-4"]) == 2
    said = capsys.readouterr().err
    assert "programme general: '-4' is no valid value of 'n_statev'" in said
    assert "case.txt" not in said


def test_the_counts_that_a_umat_wants_are_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A UMAT of plyflow refuses wrong counts; followed, the advice lets it run."""
    umat = prepare_umat()
    source = tmp_path / "default.for"
    source.write_text(umat.source)
    constants, states = len(umat.manifest["props"]), len(umat.manifest["statev"])
    wanted = f"give --props with {constants} numbers and --n-statev {states}"
    for given in ([], ["--props", "1,2", "--n-statev", "1"]):
        assert main(["drive", str(source), "volumetric", *given]) == 2
        said = capsys.readouterr().err
        assert wanted in said
        assert "no increment could be checked" not in said
    props = ",".join(str(row["default"]) for row in umat.manifest["props"])
    assert main(["drive", str(source), "volumetric", "--props", props]) == 2
    assert f"0 given): give --n-statev {states}" in capsys.readouterr().err
    assert main(["drive", str(source), "general", "--props", props, "--n-statev", str(states)]) == 0


def test_a_case_file_is_told_what_to_write_in_it(tmp_path: Path) -> None:
    path = tmp_path / "mine.txt"
    path.write_text("props = 1 2\nbegin step\nduration = 1.0\nF11 = 1.1\nend step\n")
    with pytest.raises(InputError, match=re.escape(f"17 numbers in props and n_statev = 10 in {path}")):
        diagnose(prepare_umat().library, read_case(path))


def test_a_message_without_counts_names_none() -> None:
    assert refused_counts("UMAT stopped the analysis; NPROPS is odd") == {}
    assert refused_counts("NPROPS value NaN, bound 3") == {}


def test_the_manifest_beside_a_source_gives_what_the_case_leaves_open(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["generate", "bdf1", "-o", str(tmp_path)]) == 0
    source, case = tmp_path / "bdf1.for", tmp_path / "case.txt"
    case.write_text("begin step\nduration = 1.0\nF33 = 0.99\nS22 = 0.0\nend step\n")
    for which in ("general", str(case)):
        assert main(["drive", str(source), which]) == 0
        assert "DDSDDE is right" in capsys.readouterr().out
    for given, what in (("--n-statev=3", "gives 3 state variables"), ("--props=1,2", "gives 2 constants")):
        assert main(["drive", str(source), "general", given]) == 2
        assert f"programme general {what}, {tmp_path / 'bdf1.json'} has" in capsys.readouterr().err
