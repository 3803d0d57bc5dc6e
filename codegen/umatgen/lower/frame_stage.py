"""The material frame of scenes with free directions: fibre along axis 1, ply normal along axis 3."""

from __future__ import annotations

import sympy as sp

from umatgen.lower.assign import Assignment, element
from umatgen.lower.kinematic_stages import Vector, cross, dot
from umatgen.lower.stage import Stage, make_stage
from umatgen.scene import Scene


def frame_stage(scene: Scene) -> Stage:
    """G = F Q with Q = (n, t, N): n along the fibre, N the part of the given normal across it, t = N x n.

    Spatial quantities do not change when the material basis is rotated, so nothing is rotated back.
    """
    body: list[Assignment] = []
    n = _unit(scene.fibre, "n", "dir", body)
    m = _unit(scene.normal, "m", "nor", body)
    body.append(Assignment("lean", dot(n, m)))
    across = tuple(b - element("lean") * a for a, b in zip(n, m, strict=True))
    body += [Assignment(f"across_{i}", value) for i, value in enumerate(across, 1)]
    part: Vector = (element("across_1"), element("across_2"), element("across_3"))
    body += [Assignment("sine2", dot(part, part)), Assignment("per_sine", 1 / sp.sqrt(sp.Max(element("sine2"), sp.Float("1e-300"))))]
    body += [Assignment(f"normal_{i}", p * element("per_sine")) for i, p in enumerate(part, 1)]
    normal: Vector = (element("normal_1"), element("normal_2"), element("normal_3"))
    body += [Assignment(f"third_{i}", value) for i, value in enumerate(cross(normal, n), 1)]
    third: Vector = (element("third_1"), element("third_2"), element("third_3"))
    for target, array in (("g0", "f0"), ("g1", "f1")):
        for j, vector in enumerate((n, third, normal), 1):
            for i in (1, 2, 3):
                row = sp.Add(*(element(f"{array}({i},{k})") * vector[k - 1] for k in (1, 2, 3)))
                body.append(Assignment(f"{target}({i},{j})", row))
    given = " ".join(f"{name}_{i}" for key, name in ((scene.fibre, "dir"), (scene.normal, "nor")) if key == "free" for i in (1, 2, 3))
    return make_stage(
        "frame", "Material frame with the fibre along axis 1 and the ply normal along axis 3", "4.1", f"{given} f0 f1",
        "sine2 g0 g1", body, sharing="none", formula=("G = F Q, Q = (n, t, N): N the part of the normal across n, t = N x n",),
    )  # fmt: skip


def _unit(key: str, name: str, given: str, body: list[Assignment]) -> Vector:
    """The unit vector of an axis, or of a direction in PROPS scaled by its largest component first."""
    if key != "free":
        return tuple(sp.Integer(int(i == int(key))) for i in (1, 2, 3))
    directions = [element(f"{given}_{i}") for i in (1, 2, 3)]
    longest, scaled = element(f"longest_{name}"), [element(f"{name}_scaled_{i}") for i in (1, 2, 3)]
    body.append(Assignment(longest.name, sp.Max(*(sp.Abs(d) for d in directions))))
    body += [Assignment(s.name, d / longest) for s, d in zip(scaled, directions, strict=True)]
    body.append(Assignment(f"{name}_per_length", 1 / sp.sqrt(sp.Add(*(s**2 for s in scaled)))))
    body += [Assignment(f"{name}_{i}", s * element(f"{name}_per_length")) for i, s in enumerate(scaled, 1)]
    return element(f"{name}_1"), element(f"{name}_2"), element(f"{name}_3")
