"""What a scene fixes of its blocks: tangent, compaction, the material axes in the host's, the number of components."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import mpmath as mp

from umataudit.numbers import Matrix, Number

Scene = Mapping[str, Any]


@dataclass(frozen=True)
class Setting:
    """`tangent`, `compaction`, `fibre` and `normal` as in the scene, `ntens` components."""

    tangent: str = "consistent"
    compaction: str = "normal"
    fibre: str = "1"
    normal: str = "3"
    ntens: int = 6

    @classmethod
    def of(cls, scene: Scene) -> Setting:
        """Setting of a scene."""
        ntens = 4 if scene.get("stress_state", "3d") == "plane" else 6
        return cls(ntens=ntens, **{name: str(scene[name]) for name in ("tangent", "compaction", "fibre", "normal") if name in scene})

    @property
    def free(self) -> bool:
        """Whether F is turned, before the blocks, so that the material axes are 1, 2, 3."""
        return "free" in (self.fibre, self.normal)

    @property
    def turn(self) -> Matrix:
        """Columns: material axes n, t, N in the axes of the blocks' F; det -1 where they are an odd permutation."""
        fibre, normal = (1, 3) if self.free else (int(self.fibre), int(self.normal))
        return _columns([_axis(fibre), _axis(6 - fibre - normal), _axis(normal)])

    def basis(self, properties: Mapping[str, Number]) -> Matrix:
        """The same in the host's axes: n along the fibre, N the part of the normal across it, t = N x n."""
        if not self.free:
            return self.turn
        n, m = self.directions(properties)
        lean = _dot(n, m)
        normal = _unit([b - lean * a for a, b in zip(n, m, strict=True)])
        across = [normal[1] * n[2] - normal[2] * n[1], normal[2] * n[0] - normal[0] * n[2], normal[0] * n[1] - normal[1] * n[0]]
        return _columns([n, across, normal])

    def directions(self, properties: Mapping[str, Number]) -> list[list[Number]]:
        """Unit vectors of fibre and normal as given."""
        return [
            _unit([properties[f"{name}_{i}"] for i in (1, 2, 3)]) if axis == "free" else _axis(int(axis))
            for axis, name in ((self.fibre, "dir"), (self.normal, "nor"))
        ]

    def kept(self, value: Any) -> Any:
        """The components that the scene has, of six or of six by six."""
        if not isinstance(value, list) or len(value) != 6:
            return value
        return [self.kept(part) for part in value[: self.ntens]]


def frame(given: Mapping[str, Any], setting: Setting) -> dict[str, Any]:
    """Reference of the block that turns F so that the fibre is along axis 1 and the ply normal along axis 3."""
    turn, directions = setting.basis(given), setting.directions(given)
    turned = {name: (mp.matrix(given[f]) * turn).tolist() for name, f in (("g0", "f0"), ("g1", "f1"))}
    return {"sine2": 1 - _dot(*directions) ** 2, **turned}


def _columns(vectors: list[list[Number]]) -> Matrix:
    return mp.matrix(vectors).T


def _axis(number: int) -> list[Number]:
    return [mp.mpf(int(i == number)) for i in (1, 2, 3)]


def _dot(u: list[Number], v: list[Number]) -> Number:
    return sum(a * b for a, b in zip(u, v, strict=True))


def _unit(vector: list[Number]) -> list[Number]:
    length = mp.sqrt(_dot(vector, vector))
    return [entry / length for entry in vector]
