"""One session of the bench: everything measured in it, then the report, all files or none."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from plyflow.errors import InputError
from plyflow.evidence.bench.accuracy import recommended
from plyflow.evidence.bench.extras import Rounding, batch_rates, model_distance, rounding
from plyflow.evidence.bench.figures import figures, scheme_colours
from plyflow.evidence.bench.generation import GenerationCosts, generation_costs
from plyflow.evidence.bench.instructions import Workshop, instructions_per_call
from plyflow.evidence.bench.machine import machine
from plyflow.evidence.bench.measure import Point, measure, tasks_of
from plyflow.evidence.bench.peers.fortran import PEERS, peer_source
from plyflow.evidence.bench.problems import Problem, problems, values_for
from plyflow.evidence.bench.report import to_json, to_markdown, verdict_lines
from plyflow.evidence.bench.schemes import AS_PRINTED, DEFAULT, PAPER, PAPER_REAL, Scheme, all_schemes
from plyflow.files import require_writable, write_files
from plyflow.umat.compile import generate_cached
from umatgen.scene import SCENES

Advance = Callable[[str], None]
FEWEST_REPEATS = 3
BEST_OF = 3
PLAIN_LINE_EVERY = 500


@dataclass
class Session:
    """Everything one session measured; `seconds` is its whole length."""

    quick: bool
    repeats: int
    problems: list[Problem]
    schemes: list[Scheme]
    left_out: dict[str, str]
    points: list[Point]
    recommended: str
    rounding: Rounding
    distances: dict[str, float]
    rates: dict[int, list[float]]
    batch_points: int
    instructions: dict[str, float | None]
    generation: GenerationCosts
    machine: dict[str, Any]
    values: dict[str, dict[str, float]]
    seconds: float = 0.0
    figures: dict[str, str] = field(default_factory=dict)


def run_bench(
    folder: Path, console: Console, *, quick: bool = False, json_file: Path | None = None, repeats: int | None = None
) -> Session:
    """Measure, then write bench.md, bench.json and the figures.

    Parameters
    ----------
    folder : Path
        Where to write; made if missing.
    console : rich.console.Console
        Where progress and verdict go.
    quick : bool
        Two problems instead of four, fewer repeats, no instruction counts but those of the two schemes compared.
    json_file : Path, optional
        A further place for the JSON.
    repeats : int, optional
        Runs of each combination; default 9, 5 when quick.

    Raises
    ------
    InputError
        Fewer than 3 repeats.
    PlyflowError
        A folder cannot be written, the compiler is missing.
    """
    repeats = repeats if repeats is not None else (5 if quick else 9)
    if repeats < FEWEST_REPEATS:
        raise InputError(f"repeats is {repeats}; at least {FEWEST_REPEATS} are needed for a median and a spread")
    require_writable(folder)
    if json_file is not None:
        require_writable(json_file.parent)
    session = _session(console, quick, repeats)
    files = {"bench.md": to_markdown(session), "bench.json": to_json(session), **session.figures}
    written = write_files(folder, files)
    if json_file is not None:
        written += write_files(json_file.parent, {json_file.name: to_json(session)})
    for line in verdict_lines(session):
        console.print(line, highlight=False, markup=False)
    for path in written[:2]:
        console.print(str(path), soft_wrap=True, highlight=False)
    return session


def _session(console: Console, quick: bool, repeats: int) -> Session:
    begin, here = time.perf_counter(), machine()
    chosen = problems(quick)
    with _progress(console) as stage:
        schemes, left_out = all_schemes(stage("compiling", len(SCENES) + len(PEERS) + 1))
        tasks = tasks_of(chosen, schemes)
        slow = 1 if quick else 3
        points = measure(tasks, repeats, slow, stage("runs", len(tasks) * repeats), BEST_OF)
        names = [scheme.name for scheme in schemes]
        default = next(scheme for scheme in schemes if scheme.name == DEFAULT)
        loads = [problem for problem in chosen if problem.kind == "load"]
        best = recommended(points, [p.name for p in loads], [s.name for s in schemes if s.general], DEFAULT)
        values = {problem.name: values_for(problem, default.manifest) for problem in chosen}
        counted = [DEFAULT, PAPER] if quick else [*(n for n in names if n in SCENES), PAPER, *PEERS]
        size = 20_000 if quick else 200_000
        session = Session(
            quick, repeats, chosen, schemes, left_out, points, best,
            rounding=rounding(loads[0], default),
            distances={p.name: model_distance(p, default, values[p.name]) for p in loads},
            rates=batch_rates(default, default.props(loads[0]), size, 3 if quick else 7),
            batch_points=size,
            instructions=_instructions(counted, stage("instructions", len(counted))),
            generation=generation_costs([DEFAULT, "baked"] if quick else list(SCENES)),
            machine=here,
            values=values,
        )  # fmt: skip
    session.figures = figures(chosen, points, scheme_colours(names, _told_apart(schemes)))
    session.seconds = time.perf_counter() - begin
    return session


def _told_apart(schemes: list[Scheme]) -> list[str]:
    """Schemes with a colour of their own: default, paper, other integrators, peers; the others lie close to the default."""
    return [s.name for s in schemes
            if s.name in (DEFAULT, PAPER_REAL, PAPER) or s.kind == "peer" or s.traits["integrator"] != "bdf1"]  # fmt: skip


def _instructions(names: list[str], advance: Advance) -> dict[str, float | None]:
    found: dict[str, float | None] = {}
    with Workshop() as workshop:
        for name in names:
            source, manifest, _ = generate_cached(SCENES.get(name, AS_PRINTED if name == PAPER else SCENES[DEFAULT]))
            program = (
                workshop.program(peer_source(name), manifest, ("-ffree-form", "-std=f2018"))
                if name in PEERS
                else workshop.program(source, manifest)
            )
            found[name] = instructions_per_call(program, workshop.empty(program))
            advance(name)
    return found


@contextmanager
def _progress(console: Console) -> Iterator[Callable[[str, int], Advance]]:
    """Stages with a bar each, or plain lines where the output is not a terminal."""
    if not console.is_terminal:
        yield lambda title, total: _plain(console, title, total)
        return
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console) as progress:

        def stage(title: str, total: int) -> Advance:
            bar = progress.add_task(title, total=total)
            return lambda name: progress.update(bar, advance=1, description=f"{title}: {name}"[:44].ljust(44))

        yield stage


def _plain(console: Console, title: str, total: int) -> Advance:
    done = 0

    def advance(name: str) -> None:
        nonlocal done
        done += 1
        if done % PLAIN_LINE_EVERY == 0 or done == total:
            console.print(f"{title}: {done}/{total}, last {name}", highlight=False)

    return advance
