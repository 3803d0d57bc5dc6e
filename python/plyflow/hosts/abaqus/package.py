"""Everything an Abaqus user needs of a scene: sources, decks, what to type and what to look at."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from plyflow.case.case import Case, assumption_lines, law_parameters, property_values
from plyflow.case.programme import LOADS, load_programme
from plyflow.errors import InputError
from plyflow.hosts.abaqus.check import require_valid
from plyflow.hosts.abaqus.deck import environment
from plyflow.hosts.abaqus.jobs import MATERIAL, PLANE, SOLID, Block, element_deck, material_card
from plyflow.hosts.abaqus.together import material_name, source_of_scenes
from plyflow.hosts.calculix.scenarios import laminate_deck
from plyflow.law import integrate
from plyflow.provenance import package_version, source_hash
from plyflow.umat.compile import generate_cached
from plyflow.umat.scenes import find_scene
from umatgen.scene import Scene

PLANE_SUFFIX = "_p"
TOGETHER, CARDS = "together.for", "together_materials.inp"
LAMINATE_COMPACTION, LAMINATE_FRICTION = 0.04, 0.05
LAMINATE_CELLS, LAMINATE_DURATION = (6, 6, 2), 240.0
BLEND_OFFSET = 0.4  # of blend_width, rounded: driver against the one-dimensional law, IM7-8552 at 70 degC


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

    def temperature(self, case: Case) -> float | None:
        """Temperature of the case in degC where the scene looks it up, None where the constants are of one."""
        return case.temperature if self.manifest["scene"].get("table") else None


def abaqus_files(
    scene_name: str, case: Case, also: Sequence[str] = (), *, aba_param: bool = False
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

    Raises
    ------
    InputError
        Unknown scene, one without a tangent or with a value outside its bounds, or a deck that breaks a rule.
    """
    include = "aba_param" if aba_param else "none"
    scene, *others = (replace(find_scene(name, case.fibre_fraction), include=include) for name in (scene_name, *also))
    for one in (scene, *others):
        _check(one)
    files: dict[str, str] = {}
    jobs: list[dict[str, str]] = []
    parts = _parts(scene)
    values = property_values(case, generate_cached(replace(scene, stress_state="3d", fibre="1"))[1])
    for part in parts:
        files |= {part.file: part.source, f"{part.manifest['name']}.json": json.dumps(part.manifest, indent=2) + "\n"}
        files |= _element_files(part, case, values, jobs)
        if "C3D8" in part.elements:
            files |= _laminate_file(part, case, values, jobs)
    if others:
        files |= _together_files([scene, *others], values)
    for name, text in files.items():
        if name.endswith(".inp"):
            require_valid(text, name)
    files["README.txt"] = _readme(scene_name, case, values, parts, jobs, [s.name for s in (scene, *others)])
    return files


def _together_files(scenes: Sequence[Scene], values: Mapping[str, float]) -> dict[str, str]:
    """One source of all scenes, and a material card of each."""
    cards = [
        material_card(values, generate_cached(scene)[1], material_name(scene)).text("abaqus") for scene in scenes
    ]
    return {TOGETHER: source_of_scenes(scenes), CARDS: "".join(cards)}


def _check(scene: Scene) -> None:
    """Refuse a scene that these decks do not fit."""
    fibre = "3" if scene.ntens == 4 else "1"
    if scene.tangent == "none":
        raise InputError(f"scene '{scene.name}' has no tangent; Abaqus needs one, choose tangent 'consistent'")
    if scene.baked:
        raise InputError(
            f"scene '{scene.name}' has its constants in its source, the decks carry them in *USER MATERIAL: choose a "
            "scene that reads PROPS, for example default"
        )
    if scene.invariants == "printed":
        raise InputError(
            f"scene '{scene.name}' cannot start a job: the printed invariants have no derivative at F = I, so that DDSDDE "
            "is not finite there; choose invariants 'transverse', for example the scene default"
        )
    if scene.fibre != fibre:
        raise InputError(
            f"scene '{scene.name}' has fibre '{scene.fibre}', the decks of stress state '{scene.stress_state}' have it "
            f"along {fibre}: choose fibre '{fibre}' and turn it with *ORIENTATION"
        )


def _parts(scene: Scene) -> list[Part]:
    """The scene itself, and for a three-dimensional one its like for plane and axisymmetric elements."""
    if scene.ntens == 4:
        return [_part(scene, PLANE)]
    name = scene.name[: 12 - len(PLANE_SUFFIX)] + PLANE_SUFFIX
    plane = replace(scene, name=name, stress_state="plane", fibre="3")
    return [_part(scene, SOLID), _part(plane, PLANE)]


def _part(scene: Scene, elements: tuple[str, ...]) -> Part:
    source, manifest, _ = generate_cached(scene)
    return Part(source, manifest, elements)


def _element_files(part: Part, case: Case, values: Mapping[str, float], jobs: list[dict[str, str]]) -> dict[str, str]:
    files = {}
    for element in part.elements:
        for load in LOADS:
            block = Block(case.width, values["h0"], load_programme(load, case.width), values)
            name = f"{element.lower()}_{load.replace('-', '_')}"
            deck = element_deck(element, block, part.manifest, "abaqus")
            comments = [*deck.comments, _command(name, part)]
            deck = replace(deck, comments=comments, temperature=part.temperature(case))
            files[f"{name}.inp"] = deck.text()
            jobs.append({"name": name, "source": part.file, "what": deck.title})
    return files


def _laminate_file(part: Part, case: Case, values: Mapping[str, float], jobs: list[dict[str, str]]) -> dict[str, str]:
    card = material_card(values, part.manifest, MATERIAL)
    deck = laminate_deck(
        "abaqus",
        card.text("abaqus"),
        MATERIAL,
        values["w0"],
        values["h0"],
        LAMINATE_COMPACTION,
        LAMINATE_FRICTION,
        LAMINATE_CELLS,
        LAMINATE_DURATION,
    )
    steps = [replace(step, unsymmetric=card.unsymmetric) for step in deck.steps]
    comments = [*deck.comments, _command("laminate", part)]
    deck = replace(deck, steps=steps, comments=comments, temperature=part.temperature(case))
    jobs.append({"name": "laminate", "source": part.file, "what": deck.title})
    return {"laminate.inp": deck.text()}


def _command(job: str, part: Part) -> str:
    return f"abaqus job={job} user={part.file} interactive"


def _readme(
    scene: str,
    case: Case,
    values: Mapping[str, float],
    parts: list[Part],
    jobs: list[dict[str, str]],
    scenes: Sequence[str],
) -> str:
    """What to type, what to look at, what to expect, what to do when it fails, and what it rests on."""
    manifest = parts[0].manifest
    together = {"file": TOGETHER, "cards": CARDS, "scenes": ", ".join(scenes)} if len(scenes) > 1 else None
    return (
        environment()
        .get_template("README.txt.j2")
        .render(
            scene=scene,
            what=f"{case.material} at {case.temperature:g} degC, {case.layup}, {case.width:g} mm wide",
            version=package_version(),
            generator=manifest["generator_version"],
            jobs=jobs,
            together=together,
            statev=manifest["statev"],
            expected=_expected(case, values),
            unsymmetric=manifest["unsymmetric"],
            by_temperature=bool(manifest["scene"].get("table")),
            blend_offset=_blend_offset(manifest["scene"]),
            laminate=any(job["name"] == "laminate" for job in jobs),
            compaction=LAMINATE_COMPACTION,
            friction=LAMINATE_FRICTION,
            assumptions=assumption_lines(case, values),
            sources=_jobs_by_source(jobs),
            parts=[{"file": part.file, "sha256": source_hash(part.source)} for part in parts],
        )
    )


def _blend_offset(scene: Mapping[str, Any]) -> str | None:
    """By how much of w0 a blended lock ends too wide, None for an instant one."""
    return f"{BLEND_OFFSET * scene['blend_width']:.1g}" if scene["lock"] == "blend" else None


def _jobs_by_source(jobs: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Patterns of the jobs that take each source."""
    found: dict[str, list[str]] = {}
    for job in jobs:
        element, load, _ = job["name"].partition("_")
        pattern = f"{element}_*" if load else element
        if pattern not in found.setdefault(job["source"], []):
            found[job["source"]].append(pattern)
    return {source: ", ".join(patterns) for source, patterns in found.items()}


def _expected(case: Case, values: Mapping[str, float]) -> list[dict[str, str]]:
    """What the one-dimensional law says of the end of each load."""
    law = {load: integrate(law_parameters(values), load_programme(load, case.width)) for load in LOADS}
    return [
        {
            "load": load,
            "thickness": f"{solution.thickness_ratio[-1]:.4f}",
            "width": f"{solution.width_ratio[-1]:.4f}",
            "eps": f"{solution.eps[-1]:.5f}",
            "locked": "no" if solution.lock_time is None else f"yes, at {solution.lock_time:.2g} s",
        }
        for load, solution in law.items()
    ]
