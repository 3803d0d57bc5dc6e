"""What generating costs: the limits that the project sets itself, in fresh processes."""

from __future__ import annotations

import pytest

from plyflow.errors import ToolError
from plyflow.evidence.bench.generation import LIMITS, GenerationCosts, generation_costs
from umatgen.scene import SCENES


def broken(costs: GenerationCosts) -> list[str]:
    """Limits that do not hold: the default scene cold, any other on top of it, any from the cache."""
    others = [seconds for name, seconds in costs.cold.items() if name != "default"]
    found = []
    if costs.cold["default"] > LIMITS["cold"]:
        found.append("cold")
    if max(others) > LIMITS["more"]:
        found.append("more")
    if max(costs.cached.values()) > LIMITS["cached"]:
        found.append("cached")
    return found


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
