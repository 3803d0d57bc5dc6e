"""One session of the bench: everything measured in it, then the report, all files or none."""

from __future__ import annotations

import json
import tempfile
import time
from pathlib import Path

from rich.console import Console

from plyflow.case.case import all_cases
from plyflow.errors import InputError
from plyflow.evidence.bench.accuracy import recommended
from plyflow.evidence.bench.all_cases import count_cases
from plyflow.evidence.bench.extras import batch_rates, model_distance, rounding
from plyflow.evidence.bench.figures import draw, looks_of
from plyflow.evidence.bench.generation import generation_costs
from plyflow.evidence.bench.instructions import build, instructions_per_call
from plyflow.evidence.bench.machine import machine
from plyflow.evidence.bench.measure import measure, tasks_of
from plyflow.evidence.bench.peers.fortran import PEERS
from plyflow.evidence.bench.problems import problems, values_for
from plyflow.evidence.bench.report import page
from plyflow.evidence.bench.schemes import DEFAULT, PAPER, PLAIN, Scheme, all_schemes
from plyflow.evidence.bench.session import Session
from plyflow.files import require_writable, write_files
from plyflow.show.figure import svg
from plyflow.show.progress import Advance, progress
from umatgen.scene import SCENES

FEWEST_REPEATS = 3


def run_bench(
    folder: Path, console: Console, *, quick: bool = False, json_file: Path | None = None, repeats: int | None = None
) -> Session:
    """Measure, then write bench.html, bench.json and the figures.

    Parameters
    ----------
    folder : Path
        Where to write; made if missing.
    console : rich.console.Console
        Where progress and verdict go.
    quick : bool
        The three programmes only, fewer repeats and cases, instruction counts of the two schemes compared.
    json_file : Path, optional
        A further place for the JSON.
    repeats : int, optional
        Runs of each combination; default 9, 3 when quick.

    Raises
    ------
    InputError
        Fewer than 3 repeats.
    PlyflowError
        A folder cannot be written, the compiler is missing.
    """
    repeats = repeats if repeats is not None else (3 if quick else 9)
    if repeats < FEWEST_REPEATS:
        raise InputError(f"repeats is {repeats}; at least {FEWEST_REPEATS} are needed for a median and a spread")
    for place in [folder] if json_file is None else [folder, json_file.parent]:
        require_writable(place)
    session = _session(console, quick, repeats)
    text = json.dumps(session.as_dict(), indent=1, allow_nan=False) + "\n"
    written = write_files(folder, {"bench.html": page(session).html(), "bench.json": text, **session.figures})
    if json_file is not None:
        written += write_files(json_file.parent, {json_file.name: text})
    for line in session.verdict():
        console.print(line, highlight=False, markup=False)
    for path in written[:2]:
        console.print(str(path), soft_wrap=True, highlight=False)
    return session


def _session(console: Console, quick: bool, repeats: int) -> Session:
    begin, here, chosen = time.perf_counter(), machine(), problems(quick)
    with progress(console, "compiled", len(SCENES) + len(PEERS) + 1, lines=1) as advance:
        schemes, left_out = all_schemes(advance)
    tasks = tasks_of(chosen, schemes)
    with progress(console, "runs", len(tasks) * (1 + repeats), lines=5) as advance:
        points = measure(tasks, repeats, 1 if quick else 3, advance)
    default = next(scheme for scheme in schemes if scheme.name == DEFAULT)
    loads = [problem for problem in chosen if problem.kind == "load"]
    values = {problem.name: values_for(problem, default.manifest) for problem in chosen}
    every, both = 6 if quick else 1, [s for s in schemes if s.name in (DEFAULT, PLAIN)]
    with progress(console, "cases", len(both) * 2 * len(range(0, len(all_cases()), every)), lines=1) as advance:
        cases = {scheme.name: count_cases(scheme, every, advance) for scheme in both}
    counted = [s for s in schemes if (s.name in (DEFAULT, PAPER) if quick else s.source and s.kind != "newton")]
    with progress(console, "instructions counted", len(counted), lines=1) as advance:
        instructions = _instructions(counted, advance)
    size, looks = 20_000 if quick else 200_000, looks_of(schemes)
    return Session(
        quick, repeats, chosen, schemes, left_out, points,
        recommended=recommended(points, [p.name for p in loads], [s.name for s in schemes if s.general], DEFAULT),
        cases=cases,
        rounding=rounding(loads[0], default),
        distances={p.name: model_distance(p, default, values[p.name]) for p in loads},
        rates=batch_rates(default, default.props(loads[0]), size, 3 if quick else 7),
        batch_points=size,
        instructions=instructions,
        generation=generation_costs([DEFAULT, "baked"] if quick else list(SCENES)),
        machine=here,
        values=values,
        figures={f"{p.name}-{quantity}.svg": svg(draw(p, quantity, [one for one in points if one.problem == p.name], looks))
                 for p in chosen for quantity in p.quantities},
        seconds=time.perf_counter() - begin,
    )  # fmt: skip


def _instructions(schemes: list[Scheme], advance: Advance) -> dict[str, float | None]:
    """Instructions of a call by scheme; None without valgrind."""
    found: dict[str, float | None] = {}
    with tempfile.TemporaryDirectory() as folder:
        for scheme in schemes:
            program = build(Path(folder), scheme.source, scheme.manifest, ".f90" if scheme.kind == "peer" else ".f")
            found[scheme.name] = instructions_per_call(program)
            advance(scheme.name)
    return found
