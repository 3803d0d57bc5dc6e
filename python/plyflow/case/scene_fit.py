"""Whether a scene can carry a case of the compaction programme, and whether what it holds is of that case."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from plyflow.case.materials import COLUMNS, monotone_cubic
from plyflow.errors import InputError

TABLE_TOLERANCE = 1e-9
BAKED_TOLERANCE = 1e-4  # the shipped baked scene has eps_lock to five digits
UNFIT = {  # by key of the scene: the value that does not fit, and why
    "tangent": ("none", "has no tangent, load control needs one"),
    "incompressibility": ("none", "leaves J = 1 to its host, and this command solves without a multiplier"),
}
WANTED = {"regimes": "both", "fibre": "1", "stress_state": "3d"}


def check_scene(values: Mapping[str, float], temperature: float, manifest: Mapping[str, Any]) -> None:
    """Check PROPS by name and a temperature [degC] against the scene of a manifest.

    Raises
    ------
    InputError
        The scene cannot carry the programme, its baked constants or its temperature table are those of another case, or
        the table ends short of the case.
    """
    scene, title = manifest["scene"], f"scene '{manifest['name']}'"
    for key, value in WANTED.items():
        if scene.get(key, value) != value:
            raise InputError(
                f"{title} has {key} = '{scene[key]}'; the compaction programme needs '{value}': choose another scene"
            )
    for key, (value, why) in UNFIT.items():
        if scene.get(key) == value:
            raise InputError(f"{title} {why}: choose another scene")
    for name, baked in scene.get("baked", []):
        if abs(values[name] - baked) > BAKED_TOLERANCE * abs(baked):
            raise InputError(
                f"{title} has {name} = {baked:g} baked in, the case wants {values[name]:g}: "
                "run its own case, or write a scene file with the constants of this one"
            )
    table = dict(scene.get("table", []))
    if table:
        _check_table(values, temperature, table, title)


def _check_table(
    values: Mapping[str, float], temperature: float, table: Mapping[str, tuple[float, ...]], title: str
) -> None:
    low, high = table["temperature"][0], table["temperature"][-1]
    if not low <= temperature <= high:
        raise InputError(
            f"{title} has a temperature table from {low:g} to {high:g} degC, the case wants {temperature:g}: "
            "choose a temperature inside, or another scene"
        )
    for name in COLUMNS:
        tabled = monotone_cubic(table["temperature"], table[name]).at(temperature)
        if abs(values[name] - tabled) > TABLE_TOLERANCE * abs(tabled):
            raise InputError(
                f"{title} has {name} = {tabled:g} at {temperature:g} degC in its temperature table, the case wants "
                f'{values[name]:g}: write a scene file with table = "MATERIAL" of this one'
            )
