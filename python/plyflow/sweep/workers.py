"""Who runs the parts: this process, a Dask cluster of local processes, or an existing Dask scheduler."""

from __future__ import annotations

import importlib
import logging
import os
import signal
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from itertools import islice
from multiprocessing import resource_tracker
from typing import Any

from plyflow.errors import InputError, RunError, ToolError
from plyflow.provenance import package_version
from plyflow.sweep.parts import Part, run_part

Finished = tuple[int, bytes, int]
Runner = Callable[[Iterable[Part]], Iterator[Finished]]
FEW_PARTS = 4  # done sooner than a cluster starts
IN_FLIGHT = 3  # parts for each thread: one runs, two wait, so that no worker is idle and memory is bounded
CONNECT_SECONDS = 20
# The scheduler's own diary holds on to the parts it is about, a thousand by default: some 150 MB.
SETTINGS = {"distributed.comm.timeouts.connect": "60s", "distributed.admin.low-level-log-length": 20}


def processors() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def runner(parts: int, workers: int | None, scheduler: str | None) -> Iterator[tuple[Runner, str]]:
    """A function that runs parts and yields them as they finish, and who does it in words.

    Parameters
    ----------
    parts : int
        How many there are.
    workers : int, optional
        Processes of the local cluster; 0 runs in this process; default one for each processor, and this process if
        there are 4 parts at most.
    scheduler : str, optional
        Address of an existing scheduler, used instead.

    Raises
    ------
    InputError
        Fewer than 0 workers, or both given.
    ToolError
        The scheduler does not answer, has no workers, or they have another plyflow.
    """
    if workers is not None and (scheduler is not None or workers < 0):
        reason = "give --workers or --scheduler, not both" if scheduler else "it must be 0 or more"
        raise InputError(f"--workers {workers}: {reason}")
    if scheduler is not None:
        with _connected(scheduler) as client:
            yield _through(client), f"scheduler {scheduler}"
        return
    count = min(processors() if workers is None else workers, parts)
    if count == 0 or (workers is None and parts <= FEW_PARTS):
        yield (lambda some: map(run_part, some)), "this process"
        return
    with _local(count) as client:
        yield _through(client), f"{count} local process{'es' if count > 1 else ''}"


def _distributed() -> Any:
    """Dask's scheduler and client; loading them takes a second, so only sweeps with workers pay for it."""
    return importlib.import_module("distributed")


@contextmanager
def _local(count: int) -> Iterator[Any]:
    with _loop() as loop, _cluster(count, loop) as cluster, _distributed().Client(cluster) as client:
        yield client


@contextmanager
def _loop() -> Iterator[Any]:
    """Event loop whose thread has the interrupt of the keyboard blocked, and with it the processes that it starts.

    They are stopped by this process; otherwise each would answer Ctrl-C with a traceback of its own.
    """
    runner = importlib.import_module("distributed.utils").LoopRunner()
    resource_tracker.ensure_running()  # it lifts the block in the thread that starts it
    masks = hasattr(signal, "pthread_sigmask")
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT}) if masks else set()
    try:
        runner.start()
    finally:
        if masks:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
    try:
        yield runner.loop
    finally:
        runner.stop()


@contextmanager
def _cluster(count: int, loop: Any) -> Iterator[Any]:
    """Local processes, started in a thread: an interrupt meanwhile waits until they can be closed."""
    with ThreadPoolExecutor(1) as pool:
        starting = pool.submit(_start, count, loop)
        try:
            cluster = starting.result()
        except KeyboardInterrupt:
            starting.result().close()
            raise
    with cluster:
        yield cluster


def _start(count: int, loop: Any) -> Any:
    importlib.import_module("dask").config.set(SETTINGS)
    try:
        return _distributed().LocalCluster(
            n_workers=count,
            loop=loop,
            threads_per_worker=1,
            processes=True,
            dashboard_address=":0",
            memory_limit=0,
            silence_logs=logging.CRITICAL,
        )
    except (RuntimeError, OSError, TimeoutError) as error:
        raise ToolError(
            f"the {count} local processes did not start ({error}): try fewer with --workers, 0 for none besides this"
        ) from error


@contextmanager
def _connected(address: str) -> Iterator[Any]:
    try:
        client = _distributed().Client(address, timeout=CONNECT_SECONDS)
    except (OSError, ValueError, TimeoutError) as error:
        raise ToolError(f"no Dask scheduler answers at {address} ({error}): start `dask scheduler`") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=CONNECT_SECONDS)
        except TimeoutError as error:
            raise ToolError(f"the scheduler at {address} has no workers: start `dask worker {address}`") from error
        _same_version(client)
        yield client


def _same_version(client: Any) -> None:
    try:
        found = client.run(package_version)
    except Exception as error:
        raise ToolError(f"the workers cannot load plyflow ({error}): install it where they run") from error
    for worker, version in found.items():
        if version != package_version():
            raise ToolError(f"worker {worker} has plyflow {version}, this is {package_version()}: install the same")


def _through(client: Any) -> Runner:
    def run(parts: Iterable[Part]) -> Iterator[Finished]:
        waiting = iter(parts)
        room = IN_FLIGHT * max(sum(client.nthreads().values()), 1)
        futures = _distributed().as_completed(_submit(client, part) for part in islice(waiting, room))
        for future in futures:
            yield _result(future)
            for part in islice(waiting, 1):
                futures.add(_submit(client, part))

    return run


def _submit(client: Any, part: Part) -> Any:
    return client.submit(run_part, part, pure=False)


def _result(future: Any) -> Finished:
    distributed = _distributed()
    try:
        finished: Finished = future.result()
    except (distributed.KilledWorker, distributed.client.FutureCancelledError) as error:
        raise RunError(
            "the workers stopped while they ran a part; what is done stays: find out why, then run the same "
            f"command again ({type(error).__name__})"
        ) from error
    future.release()
    return finished
