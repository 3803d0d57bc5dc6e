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
from plyflow.sweep import parts as parts_module
from plyflow.sweep import workers as workers_module
from plyflow.sweep.parts import run_part
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
    (there[0].parent / ".part-000099.parquet.4711").write_bytes(b"half")
    (tmp_path / ".result.csv.4711").write_text("half")
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
    for place in ("plyflow.sweep.store._count", "plyflow.sweep.store.Store._write_record", "shutil.rmtree"):
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


def test_the_parts_under_way_are_bounded(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    """Cases are taken from the source only as fast as parts finish."""
    taken = 0

    class Future:
        def __init__(self, part: parts_module.Part) -> None:
            self.part = part

        def result(self) -> tuple[int, bytes, int]:
            return run_part(self.part)

        def release(self) -> None: ...

    class Client:
        def nthreads(self) -> dict[str, int]:
            return {"one": 1, "two": 1}

        def submit(self, _: object, part: parts_module.Part, *, pure: bool) -> Future:
            nonlocal taken
            taken += 1
            assert not pure
            return Future(part)

    class InOrder(list[Future]):
        add = list.append

        def __iter__(self):  # type: ignore[no-untyped-def]
            while self:
                yield self.pop(0)

    class Distributed:
        KilledWorker = ValueError
        as_completed = InOrder

        class client:  # noqa: N801
            FutureCancelledError = KeyError

    monkeypatch.setattr(workers_module, "_distributed", lambda: Distributed)
    most = 0
    finished = workers_module._through(Client())(parts_module.parts_of(plan, set(range(plan.chunks))))
    for done, _ in enumerate(finished):
        most = max(most, taken - done)
    assert taken == plan.chunks
    assert most == 2 * workers_module.IN_FLIGHT
