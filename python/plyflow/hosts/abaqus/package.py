"""Everything an Abaqus user needs of a scene: sources, decks, what to type and what to look at."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from plyflow.case.case import Case, assumption_lines, law_parameters, property_values, props_vector
from plyflow.case.programme import LOADS, load_programme
from plyflow.errors import InputError
from plyflow.hosts.abaqus.jobs import MATERIAL, PLANE, SOLID, element_deck
from plyflow.hosts.abaqus.together import source_of_scenes
from plyflow.hosts.deck import laminate_deck, material_card, orientation_lines, render
from plyflow.law import integrate
from plyflow.provenance import package_version, source_hash
from plyflow.umat.compile import generate_cached
from plyflow.umat.scenes import find_scene
from umatgen.scene import Scene

PLANE_SUFFIX = "_p"
CARD, DIRECTIONS = "material.inc", "orientation.inc"
TOGETHER, CARDS = "together.for", "together_materials.inp"
LAMINATE_COMPACTION, LAMINATE_FRICTION = 0.04, 0.05


@dataclass(frozen=True)
class Part:
    """A source with its manifest, for elements of one kind."""

    source: str
    manifest: dict[str, Any]
    elements: tuple[str, ...]

    @property
    def file(self) -> str:
        """Name of the source."""
        return f"{self.manifest['name']}.for"


@dataclass(frozen=True)
class Job:
    """A deck: its name, the file of its source, its text."""

    name: str
    source: str
    text: str

    @property
    def title(self) -> str:
        """What *HEADING says."""
        return self.text.splitlines()[1]

    @property
    def pattern(self) -> str:
        """The name, or its element's and a star for the load."""
        element, load, _ = self.name.partition("_")
        return element + ("_*" if load else "")


def abaqus_files(
    scene_name: str,
    case: Case,
    also: Sequence[str] = (),
    *,
    aba_param: bool = False,
    angles: Sequence[float] = (0.0,),
) -> dict[str, str]:
    """Name and text of every file.

    Parameters
    ----------
    scene_name, case
        The scene of the jobs and the case whose constants they have; both loads are written.
    also
        Scenes that come with the first one in another source, for models with more than one.
    aba_param
        Whether UMAT begins with INCLUDE 'ABA_PARAM.INC'.
    angles
        Fibre directions [degrees from axis 1] of the blocks of a stack, bottom to top, for orientation.inc.

    Raises
    ------
    InputError
        Unknown scene, one without a tangent, or a value outside its bounds.
    """
    include = "aba_param" if aba_param else "none"
    scenes = [replace(find_scene(name, case.fibre_fraction), include=include, form="fixed") for name in (scene_name, *also)]
    for scene in scenes:
        _check(scene)
    parts = _parts(scenes[0])
    values = property_values(case, generate_cached(replace(scenes[0], stress_state="3d", fibre="1", normal="3"))[1])
    files: dict[str, str] = {}
    jobs: list[Job] = []
    for part in parts:
        files |= {part.file: part.source, f"{part.manifest['name']}.json": json.dumps(part.manifest, indent=2) + "\n"}
        own = list(_jobs(part, case, values))
        files |= {f"{job.name}.inp": job.text for job in own}
        jobs += own
    if also:
        manifests = [generate_cached(scene)[1] for scene in scenes]
        cards = [material_card("abaqus", m["name"].upper(), props_vector(values, m), m) for m in manifests]
        files |= {TOGETHER: source_of_scenes(scenes), CARDS: "".join(cards)}
    first = parts[0].manifest
    files |= {CARD: material_card("abaqus", MATERIAL, props_vector(values, first), first)}
    files |= {DIRECTIONS: orientation_lines(angles, MATERIAL)}
    files["README.txt"] = _readme(scene_name, case, values, parts, jobs, [s.name for s in scenes])
    return files


def _check(scene: Scene) -> None:
    """Refuse a scene that these decks do not fit."""
    if scene.tangent == "none":
        raise InputError(f"scene '{scene.name}' has no tangent; Abaqus needs one, choose tangent 'consistent'")
    if scene.baked:
        raise InputError(
            f"scene '{scene.name}' has its constants in its source, the decks carry them in *USER MATERIAL: choose a "
            "scene that reads PROPS, for example default"
        )
    if scene.compaction == "printed":
        raise InputError(
            f"scene '{scene.name}' cannot start a job: the printed invariants have no derivative at F = I, so that DDSDDE "
            "is not finite there; choose compaction 'normal', for example the scene default"
        )
    for field, axis in _frame(scene).items():
        if getattr(scene, field) != axis:
            raise InputError(
                f"scene '{scene.name}' has {field} '{getattr(scene, field)}', the decks of stress state '{scene.stress_state}' "
                f"have it along {axis}: choose {field} '{axis}' and turn it with *ORIENTATION"
            )


def _frame(scene: Scene) -> dict[str, str]:
    """Axes of fibre and thickness in the decks."""
    return {"fibre": "3", "normal": "2"} if scene.ntens == 4 else {"fibre": "1", "normal": "3"}


def _parts(scene: Scene) -> list[Part]:
    """The scene itself, and for a three-dimensional one its like for plane and axisymmetric elements."""
    if scene.ntens == 4:
        return [Part(*generate_cached(scene)[:2], PLANE)]
    name = scene.name[: 12 - len(PLANE_SUFFIX)] + PLANE_SUFFIX
    plane = replace(scene, name=name, stress_state="plane", fibre="3", normal="2")
    return [Part(*generate_cached(scene)[:2], SOLID), Part(*generate_cached(plane)[:2], PLANE)]


def _jobs(part: Part, case: Case, values: Mapping[str, float]) -> Iterator[Job]:
    """Single elements under both loads, and for solid ones the laminate."""
    manifest, constants = part.manifest, props_vector(values, part.manifest)
    # A scene that looks k, a and b up wants the temperature; else the constants are of one.
    by_temperature = bool(manifest["scene"].get("table"))
    common: dict[str, Any] = {"source": part.file, "temperature": case.temperature if by_temperature else None}
    for element in part.elements:
        for load in LOADS:
            name, programme = f"{element.lower()}_{load.replace('-', '_')}", load_programme(load, case.width)
            size = (case.width, values["h0"])
            yield Job(name, part.file, element_deck(element, size, programme, constants, manifest, job=name, **common))
    if "C3D8" in part.elements:
        text = laminate_deck(
            "abaqus",
            material_card("abaqus", MATERIAL, constants, manifest),
            MATERIAL,
            values["w0"],
            values["h0"],
            compaction=LAMINATE_COMPACTION,
            friction=LAMINATE_FRICTION,
            unsymmetric=manifest["unsymmetric"],
            job="laminate",
            **common,
        )
        yield Job("laminate", part.file, text)


def _readme(
    scene: str, case: Case, values: Mapping[str, float], parts: list[Part], jobs: list[Job], scenes: Sequence[str]
) -> str:
    """What to type, what to look at, what to expect, what to do when it fails, and what it rests on."""
    manifest = parts[0].manifest
    patterns = {part.file: dict.fromkeys(job.pattern for job in jobs if job.source == part.file) for part in parts}
    return render(
        "README.txt.j2",
        scene=scene,
        case=case,
        version=package_version(),
        manifest=manifest,
        jobs=jobs,
        scenes=scenes,
        together=TOGETHER,
        cards=CARDS,
        card=CARD,
        directions=DIRECTIONS,
        expected={load: integrate(law_parameters(values), load_programme(load, case.width)) for load in LOADS},
        compaction=LAMINATE_COMPACTION,
        friction=LAMINATE_FRICTION,
        assumptions=assumption_lines(case, values),
        patterns=patterns,
        hashes={part.file: source_hash(part.source) for part in parts},
    )
