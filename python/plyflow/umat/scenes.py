"""Scenes by name or from a TOML file, what each leaves out, and how large it is."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import pandas as pd
from pydantic import TypeAdapter, ValidationError

from plyflow.case.materials import find_material
from plyflow.errors import InputError
from umatgen.explain import explain
from umatgen.pipeline import generate
from umatgen.scene import SCENES, TABLE_COLUMNS, Scene, SceneError, scene_by_name

_ADAPTER: TypeAdapter[Scene] = TypeAdapter(Scene)
_KEYS = tuple(f.name for f in fields(Scene))


def find_scene(name: str) -> Scene:
    """A shipped scene by name, or the scene of a file NAME.toml.

    Raises
    ------
    InputError
        No such scene or file, a key that no scene has, a value that does not fit: the message names it.
    """
    if not name.endswith(".toml"):
        try:
            return scene_by_name(name)
        except SceneError as error:
            raise InputError(f"{error}, or a file NAME.toml") from error
    return read_scene(Path(name))


def read_scene(path: Path) -> Scene:
    """The scene described by a TOML file: keys are the fields of `umatgen.scene.Scene`.

    [baked] holds constants by name; `table` names a material whose temperature table goes into the source, or holds its
    columns.

    Raises
    ------
    InputError
        See `find_scene`.
    """
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"scene file {path}: {error.strerror}; give the path of a TOML file") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"scene file {path} is not TOML: {error}") from error
    unknown = sorted(set(data) - set(_KEYS))
    if unknown:
        raise InputError(f"scene file {path}: '{unknown[0]}' is no key of a scene; the keys are {', '.join(_KEYS)}")
    data.setdefault("name", path.stem)
    data["baked"] = _baked(path, data.get("baked", {}))
    data["table"] = _table(path, data.get("table", {}))
    try:
        return _ADAPTER.validate_python(data)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(p) for p in first["loc"]) or "scene"
        said = first["msg"].removeprefix("Value error, ")
        where = f"scene file {path}" if place == "scene" else f"scene file {path}, {place}"
        shown = "" if place == "scene" else f", found {first['input']!r}"
        raise InputError(f"{where}: {said}{shown}") from error
    except SceneError as error:
        raise InputError(f"scene file {path}: {error}") from error


def _baked(path: Path, values: Any) -> tuple[tuple[str, float], ...]:
    if not isinstance(values, dict):
        raise InputError(f"scene file {path}: baked must be a table of constants, [baked] with NAME = VALUE lines")
    known = [name for name, _ in SCENES["baked"].baked]
    missing = [name for name in known if values and name not in values]
    strange = sorted(set(values) - set(known))
    if missing or strange:
        what = f"lacks {missing[0]}" if missing else f"has {strange[0]}, which is no constant"
        raise InputError(f"scene file {path}: [baked] {what}; it takes all of {', '.join(known)} or nothing")
    for name, value in values.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"scene file {path}: [baked] {name} = {value!r} is no number")
    return tuple((name, float(values[name])) for name in known if values)


def _table(path: Path, value: Any) -> tuple[tuple[str, tuple[float, ...]], ...]:
    """Temperature table of a scene file: the name (or file) of a material, or a table of columns."""
    if isinstance(value, str):
        columns = vars(find_material(value).table)
        return tuple((name, tuple(float(v) for v in columns[name])) for name in TABLE_COLUMNS)
    if not isinstance(value, dict) or not all(isinstance(column, list) for column in value.values()):
        raise InputError(
            f'scene file {path}: table must name a material, table = "IM7-8552", or hold the columns {", ".join(TABLE_COLUMNS)}'
        )
    strange = [x for column in value.values() for x in column if isinstance(x, bool) or not isinstance(x, int | float)]
    if strange:
        raise InputError(f"scene file {path}: table has {strange[0]!r}, which is no number")
    ordered = sorted(value, key=lambda name: TABLE_COLUMNS.index(name) if name in TABLE_COLUMNS else len(TABLE_COLUMNS))
    return tuple((name, tuple(float(x) for x in value[name])) for name in ordered)


PASSES = ("plane", "fold", "prune")  # before the last one, which shares common subexpressions


def scene_table() -> pd.DataFrame:
    """Size of every shipped scene: source lines, PROPS, STATEV, operations after each pass, what is left out."""
    rows = []
    for name, scene in SCENES.items():
        made = generate(scene)
        rows.append(
            {
                "scene": name,
                "lines": len(made.source.splitlines()),
                "PROPS": len(made.manifest["props"]),  # type: ignore[arg-type]
                "STATEV": len(made.manifest["statev"]),  # type: ignore[arg-type]
                "procedures": len(made.manifest["blocks"]),  # type: ignore[arg-type]
                **_operations(made.manifest["blocks"]),
                "pieces left out": len(explain(scene)),
            }
        )
    return pd.DataFrame(rows)


def _operations(blocks: Any) -> dict[str, int]:
    """Operations as derived, after each pass over them, and at the end; a pass that a block does not need changes nothing."""
    count = [next(iter(block["operations"].values()))[0] for block in blocks]
    found = {"operations, raw": sum(count)}
    for name in PASSES:
        count = [block["operations"].get(name, (0, before))[1] for block, before in zip(blocks, count, strict=True)]
        found[f"after {name}"] = sum(count)
    found["operations"] = sum(block["operations"][list(block["operations"])[-1]][1] for block in blocks)
    return found


def measured_table(advance: Callable[[], None] = lambda: None) -> pd.DataFrame:
    """`scene_table` with the instructions of a call and its time over the default scene's.

    Raises
    ------
    ToolError
        The compiler is missing, or a scene refuses the benchmark's states.
    """
    from plyflow.evidence.bench.scene_costs import scene_costs  # noqa: PLC0415 - only this table needs the bench

    frame, costs = scene_table(), scene_costs(advance)
    frame["instructions"] = [costs[name].instructions for name in frame["scene"]]
    frame["time / default"] = [round(costs[name].time, 3) for name in frame["scene"]]
    frame["spread"] = [round(costs[name].spread, 3) for name in frame["scene"]]
    return frame
