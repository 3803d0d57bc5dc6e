"""A killed sweep goes on where it was: nothing lost, nothing doubled, the same bytes."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from sweeping import contents, grid_plan, result_of, sweep_into

from plyflow.errors import OutputError
from plyflow.sweep.plan import Plan
from plyflow.sweep.store import Store

ENTRIES = ("material=IM7-8552,IMA-M21", "layup=CP,BP", "width=15:30@10", "temperature=30:90@50")
CHUNK, CASES = 10, 2000
DEADLINE = 120.0


@pytest.fixture(scope="module")
def plan() -> Plan:
    return grid_plan(*ENTRIES, chunk=CHUNK)


@pytest.fixture(scope="module")
def uninterrupted(plan: Plan, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("uninterrupted")
    assert sweep_into(folder, plan).run == CASES
    return folder


def parts_in(folder: Path) -> list[Path]:
    return sorted(folder.glob("parts-*/part-*.parquet"))


def kill_half_way(folder: Path, workers: int) -> list[psutil.Process]:
    """Start the sweep as a command, SIGKILL it when some parts are there; the processes it had started."""
    options = [word for entry in ENTRIES for word in ("--grid", entry)]
    code = "import sys; from plyflow.cli import main; sys.exit(main())"
    command = [sys.executable, "-c", code, "sweep", *options, "-o", str(folder), "--chunk", str(CHUNK)]
    process = subprocess.Popen([*command, "--workers", str(workers)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    begin = time.monotonic()
    while len(parts_in(folder)) < 4:
        assert process.poll() is None, "it ended before it could be killed"
        assert time.monotonic() - begin < DEADLINE
        time.sleep(0.002)
    children = psutil.Process(process.pid).children(recursive=True)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    return children


@pytest.mark.parametrize("workers", [0, 2])
def test_killed_and_resumed_the_result_is_the_same_bytes(
    workers: int, plan: Plan, uninterrupted: Path, tmp_path: Path
) -> None:
    folder, spoilt = tmp_path / "killed", tmp_path / "spoilt"
    children = kill_half_way(folder, workers)
    there = len(parts_in(folder))
    assert 4 <= there < CASES // CHUNK
    assert not (folder / "result.csv").exists()
    shutil.copytree(folder, spoilt)
    assert sweep_into(folder, plan).run == CASES - there * CHUNK
    assert contents(folder) == contents(uninterrupted)
    # Planted: one finished part stands in another's place, so 10 cases are doubled and 10 lost.
    first, second = parts_in(spoilt)[:2]
    shutil.copyfile(first, second)
    sweep_into(spoilt, plan)
    assert contents(spoilt) != contents(uninterrupted)
    assert result_of(spoilt)["case"].duplicated().sum() == CHUNK
    _, alive = psutil.wait_procs(children, timeout=30)
    assert alive == []


def test_no_case_is_lost_or_doubled(uninterrupted: Path) -> None:
    assert list(result_of(uninterrupted)["case"]) == list(range(1, CASES + 1))


def test_a_torn_part_is_run_again_and_leftovers_go(plan: Plan, uninterrupted: Path, tmp_path: Path) -> None:
    kill_half_way(tmp_path, 0)
    there = parts_in(tmp_path)
    there[0].write_bytes(there[0].read_bytes()[:-40])
    for left in (".part-000099.parquet", ".result.csv"):
        (there[0].parent / left).write_bytes(b"half")
    assert sweep_into(tmp_path, plan).run == CASES - (len(there) - 1) * CHUNK
    assert contents(tmp_path) == contents(uninterrupted)


def test_killed_while_the_parts_are_joined(
    plan: Plan, uninterrupted: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Killed(BaseException):
        pass

    def stopped(*_: object, **__: object) -> None:
        raise Killed

    Store(tmp_path, plan).begin(overwrite=False)
    for place in ("pandas.DataFrame.to_csv", "plyflow.sweep.store.Store._write_record", "shutil.rmtree"):
        with monkeypatch.context() as patch, pytest.raises(Killed):
            patch.setattr(place, stopped)
            sweep_into(tmp_path, plan)
        assert parts_in(tmp_path)
    outcome = sweep_into(tmp_path, plan)
    assert outcome.run == 0
    assert contents(tmp_path) == contents(uninterrupted)


def test_two_sweeps_do_not_write_into_one_folder(plan: Plan, tmp_path: Path) -> None:
    with Store(tmp_path, plan).locked(), pytest.raises(OutputError, match="another sweep is writing"):
        sweep_into(tmp_path, plan)
