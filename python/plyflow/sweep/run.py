"""One sweep from plan to result: what is there is kept, what is missing is run, all is joined at the end."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from plyflow.errors import RunError
from plyflow.sweep.parts import parts_of
from plyflow.sweep.plan import Plan
from plyflow.sweep.store import RECORD, RESULT, TABLE, Store
from plyflow.sweep.workers import runner

PLAIN_LINES = 10
Advance = Callable[[int, int], None]


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
    workers, scheduler
        See `plyflow.sweep.workers.runner`.
    overwrite : bool
        Discard another sweep that the folder holds.

    Raises
    ------
    PlyflowError
        The folder cannot be used, the workers fail, or every case failed (after the result is written).
    """
    store = Store(folder, plan)
    with store.locked():
        store.begin(overwrite)
        record = store.complete()
        todo: set[int] = set() if record else store.missing()
        if record is None:
            _run_missing(plan, store, todo, console, (workers, scheduler))
            record = store.finish()
        else:
            store.discard_parts()
            console.print("complete already: nothing to run", highlight=False)
    return _outcome(plan, folder, record, todo)


def _run_missing(
    plan: Plan, store: Store, todo: set[int], console: Console, who: tuple[int | None, str | None]
) -> None:
    total = len(plan.source)
    ran = _cases_in(plan, todo)
    if ran < total:
        console.print(f"{total - ran} of {total} cases are done already", highlight=False)
    if not todo:
        return
    failed_before = store.failed_before(todo)
    with runner(len(todo), *who) as (run, name), _progress(console, total, total - ran, failed_before, name) as advance:
        for number, content, failed in run(parts_of(plan, todo)):
            store.write(number, content)
            advance(_cases_in(plan, {number}), failed)


def _cases_in(plan: Plan, numbers: set[int]) -> int:
    last = plan.chunks - 1
    short = plan.chunks * plan.chunk_size - len(plan.source)
    return len(numbers) * plan.chunk_size - (short if last in numbers else 0)


@contextmanager
def _progress(console: Console, total: int, done: int, failed: int, who: str) -> Iterator[Advance]:
    """A bar on a terminal, else about ten plain lines."""
    state = {"done": done, "failed": failed, "shown": done}

    def words() -> str:
        return f"{state['failed']} failed" if state["failed"] else "none failed"

    if not console.is_terminal:
        console.print(f"{total - done} cases on {who}", highlight=False)

        def advance_plain(cases: int, failures: int) -> None:
            state["done"] += cases
            state["failed"] += failures
            if state["done"] - state["shown"] >= total / PLAIN_LINES or state["done"] == total:
                state["shown"] = state["done"]
                console.print(f"{state['done']}/{total} cases, {words()}", highlight=False)

        yield advance_plain
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[failed]}"))
    with Progress(*columns, TimeElapsedColumn(), TimeRemainingColumn(), console=console) as bar:
        task = bar.add_task(f"cases on {who}", total=total, completed=done, failed=words())

        def advance(cases: int, failures: int) -> None:
            state["failed"] += failures
            bar.update(task, advance=cases, failed=words())

        yield advance


def _outcome(plan: Plan, folder: Path, record: Mapping[str, Any], todo: set[int]) -> SweepOutcome:
    files = [folder / name for name in (RESULT, TABLE, RECORD)]
    outcome = SweepOutcome(len(plan.source), record["failed"], _cases_in(plan, todo), record["examples"], files)
    if outcome.failed == outcome.cases:
        raise RunError(f"all {outcome.cases} cases failed, see {files[1]}; the first: {outcome.examples[0]['reason']}")
    return outcome
