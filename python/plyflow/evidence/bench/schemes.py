"""Who takes part: the shipped scenes, the paper's scheme as printed, and the peers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from plyflow.case.case import props_vector, state_place
from plyflow.driver.drive import Controls, History, Library, drive
from plyflow.errors import InputError
from plyflow.evidence.bench.peers.differentiated import DifferentiatedUmat
from plyflow.evidence.bench.peers.fortran import PEERS, TWIN, peer_library, peer_source
from plyflow.evidence.bench.problems import Problem, problems, values_for
from plyflow.show.progress import Advance
from plyflow.umat.batch import BatchRoutine
from plyflow.umat.compile import compile_umat, generate_cached
from plyflow.umat.library import UmatLibrary
from umatgen.scene import SCENES, Scene

PAPER = "Eq. 16 tangent, invariants as printed"
PAPER_REAL = "paper"
DEFAULT = "default"
BACKWARD = "bdf1"
PLAIN = f"{DEFAULT}, plain Newton"
AS_PRINTED = Scene(name="asprinted", compaction="printed", tangent="paper", integrator="bdf1")
PEER_INCREMENTS = 1000  # their levels that count take 250; the perturbed tangent loses its way and would go on for long
PEER_TANGENTS = {"perturbed": "differences", "four_index": "four-index", "tensortrax": "automatic"}


@dataclass(frozen=True)
class Scheme:
    """One way to integrate the material: a library with its manifest and source, Newton's kind, controls of its own.

    `slow` schemes run few levels and few repeats.
    """

    name: str
    kind: str
    library: Library
    manifest: Mapping[str, Any]
    source: str = ""
    newton: str = "power"
    more: Mapping[str, Any] = field(default_factory=dict)
    slow: bool = False

    @property
    def scene(self) -> Mapping[str, Any]:
        """The scene; a peer's is the one whose law it has."""
        found: Mapping[str, Any] = self.manifest["scene"]
        return found

    @property
    def traits(self) -> dict[str, str]:
        """Tangent and integrator, for the tables."""
        tangent = PEER_TANGENTS.get(self.name, self.scene["tangent"])
        return {"tangent": tangent, "integrator": self.scene["integrator"], "newton": self.newton}

    @property
    def locked_index(self) -> int:
        """Column of the state variable that says whether the ply has locked."""
        return state_place(self.manifest, "locked")

    @property
    def general(self) -> bool:
        """Whether it takes any material (open PROPS): what can be recommended."""
        return self.kind == "scene" and not self.scene["baked"] and bool(self.scene["elastic"])

    @property
    def stands_out(self) -> bool:
        """Whether it has a colour of its own in figures; the others lie close to the default one."""
        return self.kind == "peer" or self.name in (DEFAULT, BACKWARD, PAPER_REAL, PAPER)

    def props(self, problem: Problem) -> list[float]:
        """PROPS of a problem in the scheme's order.

        Raises
        ------
        InputError
            The scheme cannot carry the problem.
        """
        return props_vector(values_for(problem, self.manifest), self.manifest)

    def run(self, problem: Problem, controls: Controls) -> History:
        """One programme."""
        return drive(self.library, self.props(problem), len(self.manifest["statev"]), problem.steps(), controls,
                     temperature=problem.case.temperature)  # fmt: skip


def all_schemes(advance: Advance = lambda note="", count=1: None) -> tuple[list[Scheme], dict[str, str]]:
    """Every scheme, compiled; and which scenes take no part, and why."""
    found: dict[str, Scheme] = {}
    left_out: dict[str, str] = {}
    probe = problems(quick=True)[0]
    for name, scene in SCENES.items():
        advance(name)
        scheme = _scheme(name, "scene", scene)
        try:
            scheme.props(probe)
            scheme.locked_index  # noqa: B018 - a scene without it has one stage only
        except (InputError, ValueError) as error:
            left_out[name] = str(error)
        else:
            found[name] = scheme
    manifest = found[TWIN].manifest
    plain = [replace(found[name], name=f"{name}, plain Newton", kind="newton", newton="plain")
             for name in (DEFAULT, BACKWARD, PAPER_REAL)]  # fmt: skip
    advance(PAPER)
    printed = _scheme(PAPER, "paper", AS_PRINTED)
    peers = []
    for name in PEERS:
        advance(name)
        peers.append(Scheme(name, "peer", peer_library(name), manifest, peer_source(name), more={"max_increments": PEER_INCREMENTS}))
    peers.append(Scheme("tensortrax", "peer", DifferentiatedUmat(manifest), manifest, slow=True))
    return [*found.values(), *plain, printed, *peers], left_out


def _scheme(name: str, kind: str, scene: Scene) -> Scheme:
    source, manifest, _ = generate_cached(scene)
    more: dict[str, Any] = {}
    if scene.incompressibility == "none" and scene.regimes == "both":
        places = [entry["name"] for entry in manifest["statev"]]
        more = {"incompressible": True, "constraint_release_statev": places.index("locked") + 1}
    return Scheme(name, kind, UmatLibrary(compile_umat(source), BatchRoutine(scene)), manifest, source, more=more)
