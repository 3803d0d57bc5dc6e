"""CALL statements of the stages of a scene, as the point routine makes them."""

from __future__ import annotations

from collections.abc import Sequence

from umatgen.lower.stage import Stage
from umatgen.model.tangent import VARIABLES
from umatgen.nodes import Call, Statement
from umatgen.scene import Scene


class Calls:
    """CALL statements of the stages that a scene has, with the names that the point routine gives their arguments."""

    def __init__(self, scene: Scene, stages: Sequence[Stage]) -> None:
        self._stages = {stage.name: stage for stage in stages}
        turned = {"f0": "g0", "f1": "g1"} if scene.free else {}
        self._renamed = {name: {"stress": "sigma"} | turned for name in self._stages if name != "frame"}
        if "counted" in self._stages:
            self._renamed["gradient"][self.rate] = "y_counted"
        for name in scene.kept_regimes:
            if scene.compaction == "printed":
                self._renamed[name] |= {"stretch": "p_stretch", "a_norm2": "p_norm2"}
            if scene.creep:
                self._renamed[name] |= {"g_visc": "g_flow"} | {f"dlng_{v.name}": f"dflow_{v.name}" for v in VARIABLES}

    @property
    def rate(self) -> str:
        """The array of the rate of C that the tangent uses: in space, or in the material frame."""
        return "y_rate" if any(v.name == "y_rate" for v in self._stages["kinematics"].outputs) else "cdot"

    def title(self, name: str) -> str:
        """What a stage computes."""
        return self._stages[name].title

    def __call__(self, *names: str) -> list[Statement]:
        """Calls of those of the stages that there are, in order."""
        return [self._call(self._stages[name]) for name in names if name in self._stages]

    def _call(self, stage: Stage) -> Call:
        rename = self._renamed.get(stage.name, {})
        actual = tuple(rename.get(v.name, v.name) for v in (*stage.inputs, *stage.outputs))
        return Call(stage.name, actual, len(stage.inputs))
