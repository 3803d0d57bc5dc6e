"""What a call of each shipped scene costs: instructions by callgrind and time beside the default scene, in one session."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from plyflow.evidence.bench.instructions import (
    Program,
    Workshop,
    instructions_per_call,
    relative_to,
    seconds_per_call,
    valgrind,
)
from plyflow.umat.compile import generate_cached
from umatgen.scene import SCENES

DEFAULT = "default"
REPEATS = 7
Advance = Callable[[], None]


@dataclass(frozen=True)
class SceneCost:
    """Instructions of one call (None without valgrind); time over the default scene's, median and half its quartiles' range."""

    instructions: float | None
    time: float
    spread: float


def scene_costs(advance: Advance = lambda: None, repeats: int = REPEATS) -> dict[str, SceneCost]:
    """Measure every shipped scene; single-stage scenes in their stage, the others in both by turns.

    Raises
    ------
    ToolError
        The compiler is missing, or a scene refuses the benchmark's states.
    """
    with Workshop() as workshop:
        programs: dict[str, Program] = {}
        counts: dict[str, float | None] = {}
        for name, scene in SCENES.items():
            source, manifest, _ = generate_cached(scene)
            programs[name] = workshop.program(source, manifest)
            counts[name] = instructions_per_call(programs[name], workshop.empty(programs[name]))
            advance()
        times = relative_to(seconds_per_call(programs, repeats, advance), DEFAULT)
    return {name: SceneCost(counts[name], *times[name]) for name in programs}


def steps(repeats: int = REPEATS) -> int:
    """How often `scene_costs` calls `advance`."""
    return len(SCENES) * (1 + repeats)


def note() -> str:
    """What the measured columns are, and what is missing."""
    counted = (
        "instructions a call by callgrind, empty loop subtracted"
        if valgrind()
        else "no instructions: valgrind is not installed (Debian, Ubuntu: apt-get install valgrind)"
    )
    return f"{counted}; time a call over the default scene's, median of {REPEATS} runs in turns, +- half the quartiles' range"
