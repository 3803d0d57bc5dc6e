"""The peers in Fortran: one law written by hand, two textbook ways to its tangent."""

from __future__ import annotations

from importlib import resources

from plyflow.umat.compile import compile_umat, generate_cached
from plyflow.umat.library import UmatLibrary
from umatgen.scene import SCENES

FLAGS = (
    "-O2", "-fPIC", "-ffree-form", "-std=f2018", "-Wall", "-Wextra", "-Wno-unused-dummy-argument", "-Werror", "-frecursive",
)  # fmt: skip
PEERS = ("perturbed", "four_index")
TWIN = "bdf1"  # the scene whose law, PROPS and STATEV the peers have


def peer_source(name: str) -> str:
    """Free-form source of a peer: places of PROPS and STATEV, the law, its tangent; `name` is one of `PEERS`."""
    manifest = generate_cached(SCENES[TWIN])[1]
    folder = resources.files("plyflow.evidence.bench.peers")
    law, tangents = ((folder / part).read_text(encoding="utf-8") for part in ("law.f90", "tangents.f90"))
    places = [f"{kind[0]}_{row['name']} = {row['index']}" for kind in ("props", "statev") for row in manifest[kind]]
    sizes = [f"n_{kind} = {len(manifest[kind])}" for kind in ("props", "statev")]
    lines = [f"   integer, parameter :: {given}" for given in (*sizes, *places)]
    module = ["module peer_places", "   implicit none", *lines, "end module peer_places", ""]
    return "\n".join(module) + law + "\n" + tangents.replace("@WAY@", name)


def peer_library(name: str) -> UmatLibrary:
    """Compiled peer; PROPS and STATEV are those of the scene `TWIN`.

    Raises
    ------
    ToolError
        The compiler is missing.
    """
    return UmatLibrary(compile_umat(peer_source(name), FLAGS))
