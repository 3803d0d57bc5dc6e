"""One sweep from plan to result: what is there is kept, what is missing is run, all is joined at the end."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from plyflow.errors import InputError, RunError
from plyflow.show.progress import progress
from plyflow.sweep.parts import Part, parts_of
from plyflow.sweep.plan import Plan
from plyflow.sweep.store import RECORD, RESULT, TABLE, Store

if TYPE_CHECKING:
    from plyflow.sweep.cluster import Runner

PLAIN_LINES = 10
# Starting processes takes some five seconds of CPU; so many cases are run in less than twice that.
MOST_HERE = {"law1d": 50_000, "umat": 3_000, "laminate": 2}


@dataclass(frozen=True)
class SweepOutcome:
    """Counts of a finished sweep: cases in all, failed, run by this call; first failures; files."""

    cases: int
    failed: int
    run: int
    examples: list[dict[str, Any]]
    files: list[Path]


def run_sweep(
    plan: Plan,
    folder: Path,
    console: Console,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    overwrite: bool = False,
) -> SweepOutcome:
    """Run what is missing of a sweep and write its table.

    Scripts that call it with local processes need `if __name__ == "__main__":`, since these load the script.

    Parameters
    ----------
    plan : Plan
        What to run.
    folder : Path
        Where result.parquet, result.csv and sweep.json go; parts are kept there until all are done.
    console : rich.console.Console
        Where progress goes.
    workers : int, optional
        Processes of the local cluster; 0 runs in this process; default one for each processor, and this process alone
        if there are fewer cases than pay for them (`MOST_HERE`).
    scheduler : str, optional
        Address of an existing scheduler, used instead.
    overwrite : bool
        Discard another sweep that the folder holds.

    Raises
    ------
    PlyflowError
        The folder cannot be used, fewer than 0 workers or a scheduler besides, the workers fail, or every case failed
        (after the result is written).
    """
    store = Store(folder, plan)
    total, run = len(plan.source), 0
    with store.locked():
        record = store.begin(overwrite)
        if record:
            console.print("complete already: nothing to run", highlight=False)
        else:
            run = _run_missing(plan, store, console, workers, scheduler)
            record = store.finish()
    files = [folder / name for name in (RESULT, TABLE, RECORD)]
    if record["failed"] == total:
        raise RunError(f"all {total} cases failed, see {files[1]}; the first: {record['examples'][0]['reason']}")
    return SweepOutcome(total, record["failed"], run, record["examples"], files)


def _run_missing(plan: Plan, store: Store, console: Console, workers: int | None, scheduler: str | None) -> int:
    """Number of cases run now."""
    total, sizes, done = len(plan.source), plan.sizes, store.done()
    todo = {number: size for number, size in enumerate(sizes) if number not in done}
    cases, failed = sum(todo.values()), sum(done.values())
    if cases < total:
        console.print(f"{total - cases} of {total} cases are done already", highlight=False)
    if not todo:
        return 0
    if workers is None and scheduler is None:
        workers = 0 if cases <= MOST_HERE[plan.model] else processors()
    with _runner(len(todo), workers, scheduler) as (run, who):
        if not console.is_terminal:
            console.print(f"{cases} cases on {who}", highlight=False)
        what = f"cases on {who}" if console.is_terminal else "cases"
        with progress(console, what, total, done=total - cases, lines=PLAIN_LINES) as advance:
            for number, content, failures in run(parts_of(plan, todo)):
                store.write(number, content)
                failed += failures
                advance(f"{failed or 'none'} failed", sizes[number])
    return cases


def processors() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def _runner(parts: int, workers: int | None, scheduler: str | None) -> Iterator[tuple[Runner, str]]:
    """A function that runs parts and yields them as they finish, and who does it in words."""
    if workers is not None and (scheduler is not None or workers < 0):
        reason = "give --workers or --scheduler, not both" if scheduler else "it must be 0 or more"
        raise InputError(f"--workers {workers}: {reason}")
    count = min(workers or 0, parts)
    if scheduler is None and count == 0:
        yield (lambda some: map(Part.run, some)), "this process"
        return
    # Loading Dask takes a second, so only sweeps with workers pay for it.
    from plyflow.sweep.cluster import existing, local  # noqa: PLC0415

    if scheduler is not None:
        with existing(scheduler) as run:
            yield run, f"scheduler {scheduler}"
    else:
        with local(count) as run:
            yield run, f"{count} local process{'es' if count > 1 else ''}"
