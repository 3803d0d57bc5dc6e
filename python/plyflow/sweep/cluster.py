"""Dask runs the parts: a cluster of local processes, or an existing scheduler."""

from __future__ import annotations

import importlib
import logging
import signal
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from itertools import islice
from multiprocessing import resource_tracker
from typing import Any

from plyflow.errors import RunError, ToolError
from plyflow.provenance import package_version
from plyflow.sweep.parts import Finished, Part

dask: Any = importlib.import_module("dask")  # their own types are incomplete
distributed: Any = importlib.import_module("distributed")
Runner = Callable[[Iterable[Part]], Iterator[Finished]]
IN_FLIGHT = 3  # parts for each thread: one runs, two wait, so that no worker is idle and memory is bounded
CONNECT_SECONDS = 20
# The scheduler's own diary holds on to the parts it is about, a thousand by default: some 150 MB.
SETTINGS = {"distributed.comm.timeouts.connect": "60s", "distributed.admin.low-level-log-length": 20}


@contextmanager
def local(count: int) -> Iterator[Runner]:
    """Run parts in so many processes of a cluster of its own.

    Raises
    ------
    ToolError
        They did not start.
    """
    with ExitStack() as stack:
        with _interrupts_waiting():
            client = stack.enter_context(distributed.Client(stack.enter_context(_start(count))))
        yield lambda parts: run_through(client, parts)


@contextmanager
def existing(address: str) -> Iterator[Runner]:
    """Run parts through a scheduler that is there.

    Raises
    ------
    ToolError
        The scheduler does not answer, has no workers, or they have another plyflow.
    """
    try:
        client = distributed.Client(address, timeout=CONNECT_SECONDS)
    except (OSError, ValueError, TimeoutError) as error:
        raise ToolError(f"no Dask scheduler answers at {address} ({error}): start `dask scheduler`") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=CONNECT_SECONDS)
        except TimeoutError as error:
            raise ToolError(f"the scheduler at {address} has no workers: start `dask worker {address}`") from error
        _same_version(client)
        yield lambda parts: run_through(client, parts)


def run_through(client: Any, parts: Iterable[Part]) -> Iterator[Finished]:
    """Finished parts as they come; parts are taken only as fast as they finish.

    Raises
    ------
    RunError
        The workers stopped.
    """
    futures = (client.submit(Part.run, part, pure=False) for part in parts)
    under_way = distributed.as_completed(islice(futures, IN_FLIGHT * max(sum(client.nthreads().values()), 1)))
    for future in under_way:
        try:
            yield future.result()
        except (distributed.KilledWorker, distributed.client.FutureCancelledError) as error:
            raise RunError(
                "the workers stopped while they ran a part; what is done stays: find out why, then run the same "
                f"command again ({type(error).__name__})"
            ) from error
        future.release()
        under_way.update(islice(futures, 1))


@contextmanager
def _interrupts_waiting() -> Iterator[None]:
    """Ctrl-C waits for the end of the block, and the processes started in it never see it: this one stops them."""
    seen: list[int] = []
    resource_tracker.ensure_running()  # it lifts the block in the thread that starts it
    before = signal.signal(signal.SIGINT, lambda number, _: seen.append(number))
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
        signal.signal(signal.SIGINT, before)
    if seen:
        raise KeyboardInterrupt


def _start(count: int) -> Any:
    dask.config.set(SETTINGS)
    try:
        return distributed.LocalCluster(
            n_workers=count,
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


def _same_version(client: Any) -> None:
    try:
        found = client.run(package_version)
    except Exception as error:
        raise ToolError(f"the workers cannot load plyflow ({error}): install it where they run") from error
    for worker, version in found.items():
        if version != package_version():
            raise ToolError(f"worker {worker} has plyflow {version}, this is {package_version()}: install the same")
