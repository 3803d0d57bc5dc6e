"""The one progress bar: on a terminal a bar, elsewhere a few plain lines or nothing."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn


class Advance(Protocol):
    """Tells the bar that some more is done, and a few words about it."""

    def __call__(self, note: str = "", count: int = 1) -> None:
        """Go on by a count."""


@contextmanager
def progress(
    console: Console, what: str, total: int, *, done: int = 0, lines: int = 0, transient: bool = False
) -> Iterator[Advance]:
    """Show how far a long work is.

    Parameters
    ----------
    console : rich.console.Console
        Where to show it.
    what : str
        Name of the work in front of the bar, and of what is counted in the plain lines ("12/84 cases, note").
    total, done : int
        Steps in all, and those done before.
    lines : int
        About how many plain lines to print where the console is not a terminal; 0 for none.
    transient : bool
        Whether the bar goes away at the end.
    """
    if not console.is_terminal:
        yield _plain_lines(console, what, total, done, lines)
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[note]}", markup=False))
    with Progress(*columns, TimeElapsedColumn(), TimeRemainingColumn(), console=console, transient=transient) as bar:
        task = bar.add_task(what, total=total, completed=done, note="")
        yield lambda note="", count=1: bar.update(task, advance=count, note=note)


def _plain_lines(console: Console, what: str, total: int, done: int, lines: int) -> Advance:
    shown = done

    def advance(note: str = "", count: int = 1) -> None:
        nonlocal done, shown
        done += count
        if lines and (done - shown >= total / lines or done == total):
            shown = done
            console.print(f"{done}/{total} {what}{', ' if note else ''}{note}", highlight=False, markup=False)

    return advance
