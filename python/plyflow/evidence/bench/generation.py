"""What generating costs: derivation and emission in a fresh process with an empty cache, and from the cache."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass

from plyflow.errors import ToolError

LIMITS = {"cold": 10.0, "more": 5.0, "cached": 0.5}  # s
_SCRIPT = """
import json, sys
from time import process_time as clock
begin = clock()
from plyflow.umat.compile import generate_cached
from umatgen.scene import SCENES
found = {"": clock() - begin}
for name in sys.argv[2:]:
    begin = clock()
    if str(generate_cached(SCENES[name])[2]) != sys.argv[1]:
        sys.exit("the cache of sources missed: the generator was changed meanwhile; run again")
    found[name] = clock() - begin
print(json.dumps(found))
"""


@dataclass(frozen=True)
class GenerationCosts:
    """Seconds of processor time (what an idle machine takes; the work is done by one thread).

    Parameters
    ----------
    start : starting Python's modules, which every command pays.
    cold : derivation and emission of each scene with an empty cache, in the given order in one process, so that what the
        first has derived helps the others as it does a user who generates several; the first starts SymPy.
    cached : fetching each from the cache, in another fresh process.
    """

    start: float
    cold: dict[str, float]
    cached: dict[str, float]


def generation_costs(names: Sequence[str]) -> GenerationCosts:
    """Generate the scenes in fresh processes, first with an empty cache, then with a full one.

    Raises
    ------
    ToolError
        A process failed, or the cache missed.
    """
    with tempfile.TemporaryDirectory() as folder:
        cold, cached = (_process(names, folder, expected) for expected in (False, True))
    return GenerationCosts(cold.pop(""), cold, {name: cached[name] for name in names})


def _process(names: Sequence[str], cache: str, cached: bool) -> dict[str, float]:
    answer = subprocess.run(
        [sys.executable, "-c", _SCRIPT, str(cached), *names], env={**os.environ, "PLYFLOW_CACHE": cache},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if answer.returncode != 0:
        raise ToolError(f"generating {', '.join(names)} failed: {' '.join(answer.stderr.split())[-300:]}")
    found: dict[str, float] = json.loads(answer.stdout)
    return found
