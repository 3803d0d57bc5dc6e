"""How large the shipped scenes are."""

from __future__ import annotations

from typing import Any

import pandas as pd

from plyflow.umat.compile import generate_cached
from umatgen.explain import explain
from umatgen.scene import SCENES

PASSES = ("plane", "fold", "prune")  # before the last one, which shares common subexpressions


def scene_table() -> pd.DataFrame:
    """Size of every shipped scene: source lines, PROPS, STATEV, operations after each pass, what is left out."""
    rows = []
    for name, scene in SCENES.items():
        source, manifest, _ = generate_cached(scene)
        rows.append({
            "scene": name,
            "lines": len(source.splitlines()),
            "PROPS": len(manifest["props"]),
            "STATEV": len(manifest["statev"]),
            "procedures": len(manifest["blocks"]),
            **_operations([block["operations"] for block in manifest["blocks"]]),
            "pieces left out": len(explain(scene)),
        })  # fmt: skip
    return pd.DataFrame(rows)


def _operations(blocks: list[dict[str, Any]]) -> dict[str, int]:
    """Operations as derived, after each pass over them, and at the end; a pass that a block does not need changes nothing."""
    count = [next(iter(passes.values()))[0] for passes in blocks]
    found = {"operations, raw": sum(count)}
    for name in PASSES:
        count = [passes.get(name, (0, before))[1] for passes, before in zip(blocks, count, strict=True)]
        found[f"after {name}"] = sum(count)
    return found | {"operations": sum(list(passes.values())[-1][1] for passes in blocks)}
