"""Scenes by name or from a TOML file, what each leaves out, and how large it is."""

from __future__ import annotations

import tomllib
from dataclasses import fields
from pathlib import Path
from typing import Any

import pandas as pd
from pydantic import TypeAdapter, ValidationError

from plyflow.errors import InputError
from umatgen.pipeline import explain, generate
from umatgen.scene import SCENES, Scene, SceneError, scene_by_name

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
    """The scene described by a TOML file: keys are the fields of `umatgen.scene.Scene`; [baked] holds constants by name.

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
    try:
        return _ADAPTER.validate_python(data)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(p) for p in first["loc"]) or "scene"
        raise InputError(f"scene file {path}, {place}: {first['msg']}, found {first['input']!r}") from error
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


def scene_table() -> pd.DataFrame:
    """Size of every shipped scene: source lines, PROPS, STATEV, operations before and after the passes, what is left out."""
    rows = []
    for name, scene in SCENES.items():
        made = generate(scene)
        blocks: Any = made.manifest["blocks"]
        counts = [list(block["operations"].values()) for block in blocks]
        rows.append(
            {
                "scene": name,
                "lines": len(made.source.splitlines()),
                "PROPS": len(made.manifest["props"]),  # type: ignore[arg-type]
                "STATEV": len(made.manifest["statev"]),  # type: ignore[arg-type]
                "procedures": len(blocks),
                "operations, raw": sum(c[0][0] for c in counts),
                "operations": sum(c[-1][1] for c in counts),
                "pieces left out": len(explain(scene)),
            }
        )
    return pd.DataFrame(rows)
