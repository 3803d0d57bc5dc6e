"""The benchmark program: what it counts, what it refuses, and what is said without valgrind."""

from __future__ import annotations

import json

import pytest

from plyflow.cli import main
from plyflow.errors import ToolError
from plyflow.evidence.bench import instructions, scene_costs
from plyflow.evidence.bench.instructions import Workshop, instructions_per_call, relative_to, seconds_per_call, valgrind
from plyflow.evidence.bench.peers.fortran import peer_source
from plyflow.umat.compile import generate_cached, support_source
from umatgen.scene import SCENES

EMPTY = support_source("benchmark/empty.f").read_text()


def test_counts_order_the_schemes_and_the_empty_loop_is_taken_off() -> None:
    with Workshop() as workshop:
        source, manifest, _ = generate_cached(SCENES["default"])
        slim, slim_manifest, _ = generate_cached(SCENES["stressonly"])
        default, stress = workshop.program(source, manifest), workshop.program(slim, slim_manifest)
        peer = workshop.program(peer_source("four_index"), manifest, ("-ffree-form", "-std=f2018"))
        empty = workshop.empty(default)
        programs = {"default": default, "stressonly": stress, "four_index": peer}
        counts = {name: instructions_per_call(program, empty) for name, program in programs.items()}
        times = seconds_per_call(programs, 3, calls=2000)
        nothing = instructions_per_call(workshop.program(EMPTY, manifest), empty)
    if valgrind() is None:
        assert set(counts.values()) == {None}
    else:
        assert nothing is not None and abs(nothing) < 10  # a separate build of the same loop
        assert counts["stressonly"] < counts["default"] / 2 < counts["four_index"] / 10  # type: ignore[operator]
        assert 1000 < counts["default"] < 10_000  # type: ignore[operator]
    assert all(len(found) == 3 and min(found) > 0.0 for found in times.values())


def test_a_refusal_is_no_measurement() -> None:
    with Workshop() as workshop:
        source, manifest, _ = generate_cached(SCENES["squeeze"])
        scene = {**manifest["scene"], "regimes": "bleed"}
        program = workshop.program(source, {**manifest, "scene": scene})
        with pytest.raises(ToolError, match="refuses the benchmark"):
            seconds_per_call({"squeeze": program}, 1, calls=10)


def test_without_valgrind_the_count_is_none_and_the_note_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "valgrind is not installed" not in scene_costs.note() or valgrind() is None
    monkeypatch.setattr(instructions.shutil, "which", lambda name: None)
    program = instructions.Program(instructions.Path("none"), (), "")
    assert instructions_per_call(program, program) is None
    assert "valgrind is not installed" in scene_costs.note()


def test_relative_times_are_taken_turn_by_turn() -> None:
    found = relative_to({"base": [1.0, 10.0, 2.0], "mine": [2.0, 20.0, 4.0]}, "base")
    assert found == {"base": (1.0, 0.0), "mine": (2.0, 0.0)}


def test_the_measured_table_has_every_scene(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    few = {name: SCENES[name] for name in ("default", "bleed")}
    monkeypatch.setattr("plyflow.umat.scenes.SCENES", few)
    monkeypatch.setattr("plyflow.evidence.bench.scene_costs.SCENES", few)
    assert main(["scenes", "--measure", "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    rows = {row["scene"]: row for row in data["scenes"]}
    assert set(rows) == set(few)
    assert rows["default"]["time / default"] == 1.0
    assert rows["default"]["operations"] < rows["default"]["after prune"] <= rows["default"]["operations, raw"]
    assert (rows["default"]["instructions"] is None) == (valgrind() is None)
    assert "gfortran" in data["compiler"].lower() or "fortran" in data["compiler"].lower()
