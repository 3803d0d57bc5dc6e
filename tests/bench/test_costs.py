"""Costs beside the runs: instructions and time of a call, generation in fresh processes, spread of repeats."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from plyflow.cli import main
from plyflow.errors import ToolError
from plyflow.evidence.bench import scene_costs
from plyflow.evidence.bench.generation import LIMITS, GenerationCosts, generation_costs
from plyflow.evidence.bench.instructions import (
    Program,
    build,
    instructions_per_call,
    relative_to,
    seconds_per_call,
    valgrind,
)
from plyflow.evidence.bench.peers.fortran import peer_source
from plyflow.evidence.bench.spread import spread_of
from plyflow.umat.compile import generate_cached, support_source
from umatgen.scene import SCENES


def ignore(note: str = "", count: int = 1) -> None:
    """No progress shown."""


def test_counts_order_the_schemes_and_the_empty_loop_is_taken_off(tmp_path: Path) -> None:
    programs = {name: build(tmp_path, *generate_cached(SCENES[name])[:2]) for name in ("default", "stressonly")}
    manifest = generate_cached(SCENES["bdf1"])[1]
    programs["four_index"] = build(tmp_path, peer_source("four_index"), manifest, ".f90")
    counts = {name: instructions_per_call(program) for name, program in programs.items()}
    times = seconds_per_call(programs, 3, ignore, calls=2000)
    nothing = instructions_per_call(build(tmp_path, support_source("benchmark/empty.f").read_text() + "! again\n", manifest))
    if valgrind() is None:
        assert set(counts.values()) == {None}
    else:
        assert nothing is not None and abs(nothing) < 10  # a separate build of the same loop
        assert counts["stressonly"] < counts["default"] / 2 < counts["four_index"] / 10  # type: ignore[operator]
        assert 1000 < counts["default"] < 10_000  # type: ignore[operator]
    assert all(len(found) == 3 and min(found) > 0.0 for found in times.values())


def test_a_refusal_is_no_measurement(tmp_path: Path) -> None:
    source, manifest, _ = generate_cached(SCENES["squeeze"])
    program = build(tmp_path, source, {**manifest, "scene": {**manifest["scene"], "regimes": "bleed"}})
    with pytest.raises(ToolError, match="refuses the benchmark"):
        seconds_per_call({"squeeze": program}, 1, ignore, calls=10)


def test_without_valgrind_the_count_is_none_and_the_note_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    assert ("valgrind is not installed" in scene_costs.note()) == (valgrind() is None)
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert instructions_per_call(Program(Path("none"), (), "")) is None
    assert "valgrind is not installed" in scene_costs.note()


def test_spreads_are_medians_and_quartiles_and_ratios_are_taken_turn_by_turn() -> None:
    found = spread_of([100.0, 2.0, 1.0, 4.0, 3.0])
    assert found == (3.0, 2.0, 4.0) and found.half == 1.0 and found.relative == pytest.approx(1 / 3)
    ratios = relative_to({"base": [1.0, 10.0, 2.0], "mine": [2.0, 20.0, 4.0]}, "base")
    assert ratios == {"base": (1.0, 1.0, 1.0), "mine": (2.0, 2.0, 2.0)} and ratios["mine"].half == 0.0


def test_the_measured_table_has_every_scene(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    few = {name: SCENES[name] for name in ("default", "bleed")}
    for module in ("umat.sizes", "evidence.bench.scene_costs"):
        monkeypatch.setattr(f"plyflow.{module}.SCENES", few)
    assert main(["scenes", "--measure", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    rows = {row["scene"]: row for row in data["scenes"]}
    assert set(rows) == set(few)
    assert rows["default"]["time / default"] == 1.0
    assert rows["default"]["operations"] < rows["default"]["after prune"] <= rows["default"]["operations, raw"]
    assert (rows["default"]["instructions"] is None) == (valgrind() is None)
    assert "fortran" in data["compiler"].lower()


def broken(costs: GenerationCosts) -> list[str]:
    """Limits that do not hold: the default scene cold, any other on top of it, any from the cache."""
    others = [seconds for name, seconds in costs.cold.items() if name != "default"]
    worst = {"cold": costs.cold["default"], "more": max(others), "cached": max(costs.cached.values())}
    return [name for name, seconds in worst.items() if seconds > LIMITS[name]]


def test_generation_keeps_its_limits() -> None:
    costs = generation_costs(["default", *(name for name in SCENES if name != "default")])
    assert set(costs.cold) == set(costs.cached) == set(SCENES)
    assert broken(costs) == []
    assert max(costs.cached.values()) < costs.cold["default"]
    slow = GenerationCosts(costs.start, {**costs.cold, "default": 11.0, "baked": 6.0}, {**costs.cached, "lean": 0.6})
    assert broken(slow) == ["cold", "more", "cached"]


def test_an_unknown_scene_is_reported() -> None:
    with pytest.raises(ToolError, match="generating nope failed"):
        generation_costs(["nope"])
