"""What a sweep is to do: model, cases, how many at a time, and the key that tells it from every other sweep."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from plyflow.case.case import LAW_MANIFEST, setting_names
from plyflow.case.loads import find_load
from plyflow.case.materials import find_material
from plyflow.case.programme import plies_in_block
from plyflow.errors import InputError
from plyflow.provenance import package_version
from plyflow.sweep.axes import NUMBER_NAMES, TEXT_NAMES, Value
from plyflow.sweep.sources import Source
from plyflow.umat.prepare import prepare_umat
from plyflow.wording import known_text

MODELS = ("law1d", "umat", "laminate")
CHUNK_SIZE = {"law1d": 500, "umat": 25, "laminate": 1}
REQUIRED = ("material", "temperature", "layup")
DEFAULTS: dict[str, Value] = {"width": 15.0, "load": "ramp-dwell"}
UMAT_DEFAULTS: dict[str, Value] = {"scene": "default"}
MODEL_DEFAULTS: dict[str, dict[str, Value]] = {
    "law1d": {},
    "umat": UMAT_DEFAULTS,
    "laminate": UMAT_DEFAULTS | {"cells": 8.0, "friction": 0.05},
}
LARGEST_CHUNK = 10_000


@dataclass(frozen=True)
class Plan:
    """A checked sweep.

    model: one of `MODELS`; source: the cases; chunk_size: cases a part; umats: provenance of each scene's UMAT;
    files: SHA-256 of every material, load and scene file the cases name; extrapolate: allow temperatures outside tables.
    """

    model: str
    source: Source
    chunk_size: int
    umats: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)
    extrapolate: bool = False

    @property
    def defaults(self) -> dict[str, Value]:
        """Values of names that a case does not give."""
        return DEFAULTS | MODEL_DEFAULTS[self.model]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the inputs in the result, in order: the cases' own and the defaults."""
        return tuple(dict.fromkeys([*self.source.columns, *self.defaults]))

    @property
    def sizes(self) -> list[int]:
        """Number of cases of each part."""
        total, size = len(self.source), self.chunk_size
        return [min(size, total - start) for start in range(0, total, size)]

    def key(self) -> str:
        """Hash of all that the result depends on."""
        return hashlib.sha256(json.dumps(self.inputs(), sort_keys=True).encode()).hexdigest()[:32]

    def inputs(self) -> dict[str, Any]:
        """Plain data of all that the result depends on."""
        return {
            "model": self.model,
            "extrapolate": self.extrapolate,
            "columns": list(self.columns),
            "cases": len(self.source),
            "cases_sha256": self.source.digest,
            "chunk_size": self.chunk_size,
            "files_sha256": dict(self.files),
            "plyflow_version": package_version(),
            "umat": {scene: dict(made) for scene, made in self.umats.items()},
        }


def make_plan(source: Source, model: str, chunk_size: int | None = None, extrapolate: bool = False) -> Plan:
    """Check that the cases can be run, and prepare their UMATs.

    Raises
    ------
    InputError
        Unknown model, name, material, layup, load or scene; a name that every case needs is missing; no cases.
    ToolError
        The compiler is missing or refuses the source.
    """
    if model not in MODELS:
        raise InputError(f"unknown model '{model}': choose one of {', '.join(MODELS)}")
    size = CHUNK_SIZE[model] if chunk_size is None else chunk_size
    if not 1 <= size <= LARGEST_CHUNK:
        raise InputError(f"{size} cases a part must be from 1 to {LARGEST_CHUNK}")
    if len(source) == 0:
        raise InputError("the list has no cases: add one line for each")
    scenes = source.texts("scene") | {str(UMAT_DEFAULTS["scene"])} if model != "law1d" else set()
    umats = {scene: prepare_umat(scene) for scene in sorted(scenes)}
    _check_names(source, model, [umat.manifest for umat in umats.values()])
    missing = [name for name in REQUIRED if name not in source.columns]
    if missing:
        raise InputError(f"no {missing[0]} given: every case needs {', '.join(REQUIRED)}")
    files = _check_texts(source)
    made = {scene: umat.provenance.as_dict() for scene, umat in umats.items()}
    return Plan(model, source, size, made, files, extrapolate)


def _check_names(source: Source, model: str, manifests: Sequence[Mapping[str, Any]]) -> None:
    """Refuse names no case could have."""
    known = ["material", "layup", "load", "temperature", "width"]
    if model != "law1d":
        known = list(dict.fromkeys([*TEXT_NAMES, *NUMBER_NAMES, *MODEL_DEFAULTS[model]]))
    for manifest in [LAW_MANIFEST] if model == "law1d" else manifests:
        known += [name for name in setting_names(manifest) if name not in known]
    for name in source.columns:
        if name not in known:
            others = [one for one, also in MODEL_DEFAULTS.items() if one != model and name in {**also, "refine": 1.0} and also]
            words = f" (only with --model {' or '.join(others)}): known are {', '.join(known)}" if others else known_text(name, known)
            raise InputError(f"unknown name '{name}'{words}")


def _check_texts(source: Source) -> dict[str, str]:
    """Refuse texts no case could have; the hashes of the files among them."""
    for layup in sorted(source.texts("layup")):
        plies_in_block(layup.upper())
    for material in sorted(source.texts("material")):
        find_material(material)
    for load in sorted(source.texts("load")):
        find_load(load, float(DEFAULTS["width"]))
    paths = sorted(text for name in ("material", "load", "scene") for text in source.texts(name) if Path(text).is_file())
    return {path: hashlib.sha256(Path(path).read_bytes()).hexdigest() for path in paths}
