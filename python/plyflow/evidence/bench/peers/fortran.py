"""The peers in Fortran: one law written by hand, two textbook ways to its tangent."""

from __future__ import annotations

from importlib import resources

from plyflow.umat.compile import compile_umat
from plyflow.umat.library import UmatLibrary

FLAGS = ("-O2", "-fPIC", "-ffree-form", "-std=f2018", "-Wall", "-Wextra", "-Werror", "-frecursive")
_CALLS = {
    "perturbed": "call perturbed_tangent(dfgrd0, dfgrd1, dtime, props, locked, tau, scalars(1), ddsdde)",
    "four_index": (
        "call four_index_tangent(dfgrd1, c, c_inverse, c_rate, g, idle, slopes, dtime, props, scalars(5), tau, &\n"
        "                           scalars(1), ddsdde)"
    ),
}
_TANGENTS = {"perturbed": "forward differences", "four_index": "a four-index push-forward"}
PEERS = tuple(_CALLS)


def peer_source(name: str) -> str:
    """Free-form source of a peer: the law, its tangent, the UMAT; `name` is one of `PEERS`."""
    folder = resources.files("plyflow.evidence.bench.peers")
    parts = {part: (folder / f"{part}.f90").read_text(encoding="utf-8") for part in ("law", name, "interface")}
    face = parts["interface"].replace("@NAME@", name).replace("@TANGENT@", _TANGENTS[name])
    return "\n".join([parts["law"], parts[name], face.replace("@CALL@", _CALLS[name])])


def peer_library(name: str) -> UmatLibrary:
    """Compiled peer; PROPS and STATEV are those of the default scene.

    Raises
    ------
    ToolError
        The compiler is missing.
    """
    return UmatLibrary(compile_umat(peer_source(name), FLAGS))
