"""Workers of a sweep: an existing scheduler, one that is not there, one without workers, workers that die."""

from __future__ import annotations

import io
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import distributed
import psutil
import pytest
from rich.console import Console
from sweeping import contents, grid_plan, sweep_into

from plyflow.errors import RunError, ToolError
from plyflow.sweep import cluster as cluster_module
from plyflow.sweep import run as run_module
from plyflow.sweep.parts import Part, parts_of
from plyflow.sweep.run import run_sweep

PLAN = ("material=IM7-8552", "layup=CP,BP", "temperature=30:90:10", "width=15,30")


@pytest.fixture(scope="module")
def cluster() -> Iterator[distributed.LocalCluster]:
    with distributed.LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=":0") as found:
        yield found


def run_on(address: str, folder: Path) -> None:
    run_sweep(grid_plan(*PLAN, chunk=4), folder, Console(file=io.StringIO()), scheduler=address)


def test_an_existing_scheduler_gives_the_same_bytes(cluster: distributed.LocalCluster, tmp_path: Path) -> None:
    run_on(cluster.scheduler_address, tmp_path / "there")
    sweep_into(tmp_path / "here", grid_plan(*PLAN, chunk=4))
    assert contents(tmp_path / "there") == contents(tmp_path / "here")


def test_workers_with_another_plyflow_are_refused(
    cluster: distributed.LocalCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster_module, "package_version", lambda: "0.0.0")
    monkeypatch.setattr(distributed.Client, "run", lambda *_: {"tcp://there": "9.9"})
    with pytest.raises(ToolError, match=r"has plyflow 9\.9, this is 0\.0\.0"):
        run_on(cluster.scheduler_address, tmp_path)


def test_a_scheduler_that_is_not_there_or_has_no_workers_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster_module, "CONNECT_SECONDS", 2)
    with pytest.raises(ToolError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9"):
        run_on("tcp://127.0.0.1:9", tmp_path)
    with (
        distributed.LocalCluster(n_workers=0, processes=False, dashboard_address=":0") as empty,
        pytest.raises(ToolError, match="has no workers: start `dask worker"),
    ):
        run_on(empty.scheduler_address, tmp_path)


def test_the_parts_under_way_are_bounded(cluster: distributed.LocalCluster) -> None:
    """Cases are taken from the source only as fast as parts finish."""
    plan = grid_plan(*PLAN, chunk=1)
    taken = most = 0

    def counted() -> Iterator[Part]:
        nonlocal taken
        for part in parts_of(plan, range(28)):
            taken += 1
            yield part

    with distributed.Client(cluster) as client:
        for done, _ in enumerate(cluster_module.run_through(client, counted())):
            most = max(most, taken - done)
    assert taken == 28
    assert most == 2 * cluster_module.IN_FLIGHT


def test_processes_are_started_only_for_cases_enough(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    started = []
    local = cluster_module.local
    monkeypatch.setattr(cluster_module, "local", lambda count: started.append(count) or local(count))
    monkeypatch.setattr(run_module, "processors", lambda: 1)
    for most in (28, 27):
        monkeypatch.setitem(run_module.MOST_HERE, "law1d", most)
        run_sweep(grid_plan(*PLAN), tmp_path / str(most), Console(file=io.StringIO()))
        assert started == [1] * (most < 28)
    assert contents(tmp_path / "27") == contents(tmp_path / "28")


def test_what_is_done_stays_when_workers_die(
    cluster: distributed.LocalCluster, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = distributed.Future.result
    done = 0

    def result(future: distributed.Future, *arguments: object, **named: object) -> object:
        nonlocal done
        done += 1
        if done > 3:
            raise distributed.scheduler.KilledWorker("part", None, 3)
        return real(future, *arguments, **named)

    with monkeypatch.context() as patch, pytest.raises(RunError, match="what is done stays"):
        patch.setattr(distributed.Future, "result", result)
        run_on(cluster.scheduler_address, tmp_path)
    kept = len(list(tmp_path.glob("parts-*/part-*.parquet")))
    assert kept == 3
    assert sweep_into(tmp_path, grid_plan(*PLAN, chunk=4)).run == 28 - 4 * kept


MAIN = "import sys; from plyflow.cli import main; sys.exit(main())"
LONG = ("--grid", "material=IM7-8552", "--grid", "layup=CP,BP", "--grid", "temperature=30:90:0.01", "--chunk", "20")


def interrupted_while_workers_start(code: str, folder: Path) -> tuple[int, str]:
    """Ctrl-C, which a terminal sends to all processes of a command, as soon as there is a worker; status and stderr."""
    command = [sys.executable, "-c", code, "sweep", *LONG, "--workers", "2", "-o", str(folder)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, start_new_session=True) as process:
        family = psutil.Process(process.pid)
        end = time.monotonic() + 30.0
        while not any("spawn_main" in " ".join(one.cmdline()) for one in family.children()) and time.monotonic() < end:
            time.sleep(0.05)
        time.sleep(0.5)
        os.killpg(process.pid, signal.SIGINT)
        error = process.communicate(timeout=60)[1]
    return process.returncode, error


def check_one_line(error: str) -> None:
    assert error == "plyflow: stopped; what is done stays, the same command goes on from there\n"


def test_an_interrupt_while_workers_start_is_one_line(tmp_path: Path) -> None:
    status, error = interrupted_while_workers_start(MAIN, tmp_path / "out")
    check_one_line(error)
    assert status == 130
    with pytest.raises(AssertionError):  # a worker that answers the interrupt itself is noticed
        check_one_line(f"Traceback (most recent call last):\nKeyboardInterrupt\n{error}")
