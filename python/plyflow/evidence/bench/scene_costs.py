"""What a call of each shipped scene costs: instructions by callgrind and time beside the default scene, in one session."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pandas as pd

from plyflow.evidence.bench.instructions import build, instructions_per_call, relative_to, seconds_per_call, valgrind
from plyflow.show.progress import Advance
from plyflow.umat.compile import generate_cached
from plyflow.umat.sizes import scene_table
from umatgen.scene import SCENES

REPEATS = 7
STEPS = len(SCENES) * (1 + REPEATS)  # how often `measured_table` calls `advance`


def measured_table(advance: Advance) -> pd.DataFrame:
    """`plyflow.umat.sizes.scene_table` with the instructions of a call and its time over the default scene's.

    Single-stage scenes are measured in their stage, the others in both by turns. Instructions are None without valgrind;
    the spread is half the quartiles' range.

    Raises
    ------
    ToolError
        The compiler is missing, or a scene refuses the benchmark's states.
    """
    frame, programs, counts = scene_table(), {}, {}
    with tempfile.TemporaryDirectory() as folder:
        for name, scene in SCENES.items():
            programs[name] = build(Path(folder), *generate_cached(scene)[:2])
            counts[name] = instructions_per_call(programs[name])
            advance(name)
        times = relative_to(seconds_per_call(programs, REPEATS, advance), "default")
    frame["instructions"] = [counts[name] for name in frame["scene"]]
    frame["time / default"] = [round(times[name].median, 3) for name in frame["scene"]]
    frame["spread"] = [round(times[name].half, 3) for name in frame["scene"]]
    return frame


def note() -> str:
    """What the measured columns are, and what is missing."""
    counted = (
        "instructions a call by callgrind, empty loop subtracted"
        if valgrind()
        else "no instructions: valgrind is not installed (Debian, Ubuntu: apt-get install valgrind)"
    )
    return f"{counted}; time a call over the default scene's, median of {REPEATS} runs in turns, +- half the quartiles' range"
