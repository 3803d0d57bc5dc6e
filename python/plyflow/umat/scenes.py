"""Scenes by name or from a TOML file."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from plyflow.case.materials import find_material
from plyflow.errors import InputError
from umatgen.scene import SCENES, TABLE_COLUMNS, Scene, SceneError, scene_by_name

_ADAPTER: TypeAdapter[Scene] = TypeAdapter(Scene)
_KEYS = tuple(f.name for f in fields(Scene))


def find_scene(name: str, fibre_fraction: float | None = None) -> Scene:
    """A shipped scene by name, or the scene of a file NAME.toml, with the initial fibre fraction V0 [-] of a case if given.

    "table:MATERIAL" is the scene `table` with the columns of that material, by name or file.

    Raises
    ------
    InputError
        No such scene or file, a key that no scene has, a value that does not fit, a file with a fibre fraction of its own
        that is another: the message names it.
    """
    base, separator, material = name.partition(":")
    if separator and base == "table":
        scene = replace(SCENES[base], table=_table(name, material))
        return scene if fibre_fraction is None else replace(scene, fibre_fraction=fibre_fraction)
    if name.endswith(".toml"):
        return read_scene(Path(name), fibre_fraction)
    try:
        scene = scene_by_name(name)
        return scene if fibre_fraction is None else replace(scene, fibre_fraction=fibre_fraction)
    except SceneError as error:
        raise InputError(f"{error}, or a file NAME.toml") from error


def read_scene(path: Path, fibre_fraction: float | None = None) -> Scene:
    """The scene described by a TOML file: keys are the fields of `umatgen.scene.Scene`.

    [baked] holds constants by name; `table` names a material whose temperature table goes into the source, or holds its
    columns.

    Raises
    ------
    InputError
        See `find_scene`.
    """
    where = f"scene file {path}"
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{where}: {error.strerror}; give the path of a TOML file") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{where} is not TOML: {error}") from error
    unknown = sorted(set(data) - set(_KEYS))
    if unknown:
        raise InputError(f"{where}: '{unknown[0]}' is no key of a scene; the keys are {', '.join(_KEYS)}")
    wanted = {} if fibre_fraction is None else {"fibre_fraction": fibre_fraction}
    own = data.get("fibre_fraction", fibre_fraction)
    if fibre_fraction is not None and own != fibre_fraction:
        raise InputError(
            f"{where} has fibre_fraction = {own}, the case has fibre_fraction_initial = {fibre_fraction:g}: give both the "
            "same, or leave it out of the file"
        )
    # The change of the stress with temperature is that of the backward difference.
    given = {"name": path.stem} | ({"integrator": "bdf1"} if "table" in data else {}) | wanted | data
    given |= {"baked": _baked(where, data.get("baked", {})), "table": _table(where, data.get("table", {}))}
    try:
        return _ADAPTER.validate_python(given)
    except ValidationError as error:
        first = error.errors()[0]
        key, said = ".".join(map(str, first["loc"])), first["msg"].removeprefix("Value error, ")
        raise InputError(f"{where}, {key}: {said}, found {first['input']!r}" if key else f"{where}: {said}") from error
    except SceneError as error:
        raise InputError(f"{where}: {error}") from error


def _baked(where: str, values: Any) -> tuple[tuple[str, float], ...]:
    """All constants in the generator's order, or none."""
    if not isinstance(values, dict):
        raise InputError(f"{where}: baked must be a table of constants, [baked] with NAME = VALUE lines")
    known = [name for name, _ in SCENES["baked"].baked]
    missing = [name for name in known if values and name not in values]
    strange = sorted(set(values) - set(known))
    if missing or strange:
        what = f"lacks {missing[0]}" if missing else f"has {strange[0]}, which is no constant"
        raise InputError(f"{where}: [baked] {what}; it takes all of {', '.join(known)} or nothing")
    for name, value in values.items():
        if _no_numbers([value]):
            raise InputError(f"{where}: [baked] {name} = {value!r} is no number")
    return tuple((name, float(values[name])) for name in known if values)


def _table(where: str, value: Any) -> tuple[tuple[str, tuple[float, ...]], ...]:
    """Temperature table of a scene file: the name (or file) of a material, or a table of columns."""
    if isinstance(value, str):
        columns = vars(find_material(value).table)
        return tuple((name, tuple(map(float, columns[name]))) for name in TABLE_COLUMNS)
    if not isinstance(value, dict) or not all(isinstance(column, list) for column in value.values()):
        raise InputError(
            f'{where}: table must name a material, table = "IM7-8552", or hold the columns {", ".join(TABLE_COLUMNS)}'
        )
    strange = _no_numbers(x for column in value.values() for x in column)
    if strange:
        raise InputError(f"{where}: table has {strange[0]!r}, which is no number")
    ordered = sorted(value, key=lambda name: TABLE_COLUMNS.index(name) if name in TABLE_COLUMNS else len(TABLE_COLUMNS))
    return tuple((name, tuple(map(float, value[name]))) for name in ordered)


def _no_numbers(values: Iterable[Any]) -> list[Any]:
    return [value for value in values if isinstance(value, bool) or not isinstance(value, int | float)]
