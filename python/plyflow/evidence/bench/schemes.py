"""Who takes part: the shipped scenes, the paper's scheme as printed, and the peers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from plyflow.case.case import props_vector, state_place
from plyflow.driver.drive import Library
from plyflow.errors import InputError
from plyflow.evidence.bench.peers.differentiated import DifferentiatedUmat
from plyflow.evidence.bench.peers.fortran import PEERS, peer_library
from plyflow.evidence.bench.problems import Problem, problems, values_for
from plyflow.umat.compile import compile_umat, generate_cached
from plyflow.umat.library import UmatLibrary
from umatgen.scene import SCENES, Scene

PAPER = "Eq. 16 tangent, invariants as printed"
PAPER_REAL = "paper"
DEFAULT = "default"
AS_PRINTED = Scene(name="asprinted", invariants="printed", tangent="paper")


@dataclass(frozen=True)
class Scheme:
    """One way to integrate the material: a library with its manifest, Newton's kind, controls of its own.

    `slow` schemes run few levels and few repeats.
    """

    name: str
    kind: str
    library: Library
    manifest: Mapping[str, Any]
    newton: str = "power"
    more: Mapping[str, Any] = field(default_factory=dict)
    slow: bool = False

    @property
    def traits(self) -> dict[str, str]:
        """Tangent and integrator, for the tables."""
        scene = self.manifest["scene"]
        tangent = {"perturbed": "differences", "four_index": "four-index", "tensortrax": "automatic"}.get(self.name)
        return {
            "tangent": tangent or str(scene.get("tangent")),
            "integrator": str(scene.get("integrator", "bdf1")) if self.kind != "peer" else "bdf1",
            "newton": self.newton,
        }

    @property
    def locked_index(self) -> int:
        """Column of the state variable that says whether the ply has locked."""
        return state_place(self.manifest, "locked")

    @property
    def spreads_the_lock(self) -> bool:
        """Whether the stress is meant to differ from the law's around the lock."""
        return bool(self.manifest["scene"].get("lock") == "blend")

    def props(self, problem: Problem) -> list[float]:
        """PROPS of a problem in the scheme's order.

        Raises
        ------
        InputError
            The scheme cannot carry the problem.
        """
        return props_vector(values_for(problem, self.manifest), self.manifest)

    @property
    def general(self) -> bool:
        """Whether it takes any material (open PROPS): what can be recommended."""
        scene = self.manifest["scene"]
        return self.kind == "scene" and not scene.get("baked") and bool(scene.get("elastic", True))


def all_schemes(advance: Callable[[str], None] = lambda name: None) -> tuple[list[Scheme], dict[str, str]]:
    """Every scheme, compiled; and which scenes take no part, and why."""
    found: list[Scheme] = []
    left_out: dict[str, str] = {}
    probe = problems(quick=True)[0]
    for name, scene in SCENES.items():
        advance(name)
        scheme = _scene_scheme(name, scene)
        try:
            scheme.props(probe)
            scheme.locked_index  # noqa: B018 - a scene without it has one stage only
        except (InputError, ValueError) as error:
            left_out[name] = str(error)
            continue
        found.append(scheme)
    manifest = next(s.manifest for s in found if s.name == DEFAULT)
    found += [Scheme(f"{s.name}, plain Newton", "newton", s.library, s.manifest, "plain") for s in found
              if s.name in (DEFAULT, PAPER_REAL)]  # fmt: skip
    advance(PAPER)
    found.append(Scheme(PAPER, "paper", *_compiled(AS_PRINTED)))
    for name in PEERS:
        advance(name)
        found.append(Scheme(name, "peer", peer_library(name), manifest))
    names = [entry["name"] for entry in manifest["props"]]
    found.append(Scheme("tensortrax", "peer", DifferentiatedUmat(names), manifest, slow=True))
    return found, left_out


def _scene_scheme(name: str, scene: Scene) -> Scheme:
    library, manifest = _compiled(scene)
    more: dict[str, Any] = {}
    if scene.incompressibility == "none" and scene.regimes == "both":
        places = [entry["name"] for entry in manifest["statev"]]
        more = {"incompressible": True, "constraint_release_statev": places.index("locked") + 1}
    return Scheme(name, "scene", library, manifest, more=more)


def _compiled(scene: Scene) -> tuple[UmatLibrary, dict[str, Any]]:
    source, manifest, _ = generate_cached(scene)
    return UmatLibrary(compile_umat(source)), manifest

