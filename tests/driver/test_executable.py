"""The executable: built by plain CMake, its case files, its tables, its exit status, its replay files."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from plyflow.driver.drive import Controls, DriverError, Step, UmatAddress, drive, run_case_file

Umat = Callable[[str], UmatAddress]

CASE = """
library = {library}       ! a comment
material = RUBBER
n_statev = 1
props = 1.3,
props = 4.1
begin controls
  initial_increment = 0.1
  tangent_check = 1
end controls
begin step
  duration = 1.0
  F11 = 1.5
  S22 = 0.0
  P33 = 0.2
end step
BEGIN STEP
  duration = 2
  instant = yes
  f12 = 0.3
end step
"""


def run(executable: Path, case: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(executable), case.name], cwd=case.parent, capture_output=True, text=True, timeout=60, check=False
    )


def write_case(folder: Path, text: str) -> Path:
    case = folder / "case.txt"
    case.write_text(text)
    return case


def test_executable_and_python_do_the_same(executable: Path, umat: Umat, tmp_path: Path) -> None:
    case = write_case(tmp_path, CASE.format(library=umat("neo_hooke").path))
    done = run(executable, case)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    table = pd.read_csv(tmp_path / "case.csv")
    steps = [Step(1.0, {"11": 1.5, "22": 0.0, "33": 0.2}, {"22": "S", "33": "P"}), Step(2.0, {"12": 0.3}, instant=True)]
    history = drive(umat("neo_hooke"), [1.3, 4.1], 1, steps, Controls(0.1, tangent_check=1))
    for column, values in {
        "total_time": history.time,
        "F22": history.deformation_gradient[:, 1, 1],
        "F12": history.deformation_gradient[:, 0, 1],
        "S33": history.stress[:, 2],
        "work": history.work,
        "SDV1": history.statev[:, 0],
        "iterations": history.iterations,
    }.items():
        # The same code, maybe other compiler flags: rounding only.
        assert table[column].to_numpy() == pytest.approx(values, rel=1e-12, abs=1e-12)
    assert "largest difference of DDSDDE" in done.stdout
    assert (run_case_file(case).stress == history.stress).all()


def test_increment_table_looks_like_a_sta_file(executable: Path, umat: Umat, tmp_path: Path) -> None:
    text = CASE.format(library=umat("misbehaving").path).replace("n_statev = 1", "n_statev = 6")
    text = text.replace("props = 1.3,\nprops = 4.1", "props = 1 2.0 0.04")
    done = run(executable, write_case(tmp_path, text))
    assert done.returncode == 0, done.stderr
    lines = (tmp_path / "case.sta").read_text().splitlines()
    assert lines[0].split()[:4] == ["STEP", "INC", "ATT", "EQUIL"]
    assert lines[2].split()[:4] == ["1", "1", "1U", "1"]
    assert lines[2].endswith("PNEWDT asked for less")
    assert lines[3].split()[:3] == ["1", "1", "2"]
    assert float(lines[3].split()[6]) == pytest.approx(0.03)
    assert lines[-1] == " THE ANALYSIS HAS COMPLETED SUCCESSFULLY"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("material = RUBBER", "colour = blue", "case.txt:3: unknown key 'colour'"),
        ("duration = 1.0", "duration = long", "case.txt:12: 'long' is no valid value of 'duration'"),
        ("duration = 1.0", "", "the step has no positive duration"),
        ("F11 = 1.5", "F44 = 1.5", "case.txt:13: unknown key 'f44' in a step"),
        ("F11 = 1.5", "S21 = 1.5", "case.txt:13: unknown key 's21'"),
        ("F11 = 1.5", "S22 = 1.5", "case.txt:14: component 22 is prescribed twice"),
        ("end controls", "", "begins inside block 'controls'"),
        ("end step\nBEGIN", "end controls\nBEGIN", "does not end block 'step'"),
        ("tangent_check = 1", "tangent = 1", "'tangent = 1' is no control"),
        ("F11 = 1.5", "F11 1.5", "is neither 'key = value'"),
        ("library = ", "library = /nowhere/no.so !", "/nowhere/no.so"),
        ("material = RUBBER", "symbol = other_", "has no symbol 'other_'"),
        ("material = RUBBER", "begin start\nstatev = 1 2\nend start", "statev has 2 values; it needs 1"),
        ("begin step", "begin stage", "unknown block 'stage'"),
    ],
)
def test_bad_cases_end_with_status_2_and_the_line(
    executable: Path, umat: Umat, tmp_path: Path, old: str, new: str, message: str
) -> None:
    good = CASE.format(library=umat("neo_hooke").path)
    assert old in good
    case = write_case(tmp_path, good.replace(old, new, 1))
    done = run(executable, case)
    assert done.returncode == 2
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not list(tmp_path.glob("case.*[av]"))
    with pytest.raises(DriverError, match=r"case\.txt"):
        run_case_file(case)


def test_missing_case_and_missing_argument(executable: Path, tmp_path: Path) -> None:
    missing = run(executable, tmp_path / "none.txt")
    assert missing.returncode == 2
    assert "none.txt: cannot be opened" in missing.stderr
    bare = subprocess.run([str(executable)], capture_output=True, text=True, check=False)
    assert bare.returncode == 2
    assert "usage" in bare.stderr
    asked = subprocess.run([str(executable), "--help"], capture_output=True, text=True, check=False)
    assert asked.returncode == 0
    assert "usage" in asked.stdout


def test_failing_call_is_repeated_by_its_replay_file(executable: Path, umat: Umat, tmp_path: Path) -> None:
    """NaN from 0.55 s on: the replay makes that one call, from the same state to the same F."""
    text = CASE.format(library=umat("misbehaving").path).replace("n_statev = 1", "n_statev = 6")
    text = text.replace("props = 1.3,\nprops = 4.1", "props = 2 2.0 0.55")
    done = run(executable, write_case(tmp_path, text))
    assert done.returncode == 1
    assert "NaN or Inf from the UMAT" in done.stderr
    replay = tmp_path / "case.replay.txt"
    assert replay.exists()
    again = run(executable, replay)
    assert again.returncode == 1
    assert "NaN or Inf from the UMAT" in again.stderr
    assert "1 calls of the UMAT" in again.stdout
    history = run_case_file(replay)
    first = run_case_file(tmp_path / "case.txt")
    assert first.failure is not None
    assert history.failure is not None
    for name in ("deformation_gradient_start", "deformation_gradient_end", "stress", "strain", "statev"):
        assert (getattr(history.failure, name) == getattr(first.failure, name)).all(), name
    for name in ("increment_size", "total_time", "step_time", "step", "increment", "outcome"):
        assert getattr(history.failure, name) == getattr(first.failure, name), name


def test_diverging_iterations_are_repeated_by_their_replay_file(umat: Umat, tmp_path: Path) -> None:
    """Too few iterations allowed: the replay starts from the same guess and meets the same residuals."""
    step = Step(1.0, {"11": 9.0, "22": 0.0, "33": 0.0}, {"11": "S", "22": "S", "33": "S"})
    controls = Controls(0.25, 0.25, 0.5, max_iterations=3, max_attempts=1, residual_tolerance=1e-7)
    replay = tmp_path / "replay.txt"
    first = drive(umat("neo_hooke"), [1.3, 4.1], 1, [step], controls, replay=replay)
    assert not first.completed
    assert "too many iterations" in first.message
    again = run_case_file(replay)
    assert "too many iterations" in again.message
    assert first.failure is not None
    assert again.failure is not None
    ends = first.failure.deformation_gradient_end, again.failure.deformation_gradient_end
    assert (ends[0] == ends[1]).all()
    assert first.message.split("residual")[1] == again.message.split("residual")[1]


def test_completed_run_leaves_no_replay_file(umat: Umat, tmp_path: Path) -> None:
    replay = tmp_path / "replay.txt"
    drive(umat("neo_hooke"), [1.3, 4.1], 1, [Step(1.0, {"11": 1.1})], replay=replay)
    assert not replay.exists()


def test_replay_without_a_library_path_is_refused(umat: Umat, tmp_path: Path) -> None:
    nameless = UmatAddress(umat("neo_hooke").address)
    with pytest.raises(DriverError, match="path"):
        drive(nameless, [1.3, 4.1], 1, [Step(1.0, {"11": 1.1})], replay=tmp_path / "replay.txt")


def test_numbers_in_the_csv_have_all_their_digits(executable: Path, umat: Umat, tmp_path: Path) -> None:
    run(executable, write_case(tmp_path, CASE.format(library=umat("neo_hooke").path)))
    table = pd.read_csv(tmp_path / "case.csv")
    gradient = np.array([table[f"F{i}{j}"].iloc[-1] for i in (1, 2, 3) for j in (1, 2, 3)]).reshape(3, 3)
    jacobian = np.linalg.det(gradient)
    s33 = (1.3 * (gradient[2, 2] ** 2 - 1) + 4.1 * np.log(jacobian)) / jacobian
    assert table["S33"].iloc[-1] == pytest.approx(s33, rel=1e-13)
