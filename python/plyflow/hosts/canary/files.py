"""The canary as it is written: for Abaqus, for CalculiX's Abaqus door, and as an MGIS behaviour."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from plyflow.hosts.calculix.faces import Face, compiled_face
from plyflow.hosts.deck import material_card
from plyflow.hosts.mgis.behaviour import Behaviour, compiled, wrapped
from plyflow.umat.compile import compile_umat, support_source
from plyflow.umat.library import UmatLibrary

SOURCE = "canary/canary.for"
FULL = "LOGICAL, PARAMETER :: full = .TRUE."
PROPS = {"mu": 1.0, "lambda": 3.0, "rate": 1.0, "ask": 0.0}
RATES = {1: "Jaumann of Kirchhoff", 2: "Truesdell", 3: "Jaumann of Cauchy"}
_MEANING = {"mu": ("MPa", "shear modulus"), "lambda": ("MPa", "Lame constant"), "rate": ("-", "rate of DDSDDE: 1, 2 or 3"),
            "ask": ("-", "1: ask once for half an increment")}  # fmt: skip
_STATE = [*(f"F{i}{j}" for j in (1, 2, 3) for i in (1, 2, 3)), "seal", "time_end", "seen"]
# CalculiX names the door, then the library; the routine is UMAT.
CALCULIX_LIBRARY = "PFCANARY"


def source(mgis: bool = False) -> str:
    """Text of the canary; for MGIS hosts without a look at what they do not hand over."""
    text = support_source(SOURCE).read_text(encoding="utf-8")
    return text.replace(FULL, FULL.replace("TRUE", "FALSE")) if mgis else text


def manifest() -> Mapping[str, Any]:
    """Names of constants and state variables, in the form of a scene's manifest."""
    return {
        "name": "canary",
        "scene": {"form": "fixed", "entry": "UMAT", "fibre": "1", "normal": "3", "energies": False},
        "ntens": 6,
        "unsymmetric": False,
        "props": [
            {"index": i, "name": name, "default": value, "unit": _MEANING[name][0], "meaning": _MEANING[name][1]}
            for i, (name, value) in enumerate(PROPS.items(), 1)
        ],
        "statev": [{"index": i, "name": name, "unit": "-", "meaning": "memory"} for i, name in enumerate(_STATE, 1)],
    }


def behaviour() -> Behaviour:
    """The canary for MGIS hosts: it looks at less, and sees the host's own gradient of the start."""
    return wrapped(source(mgis=True), manifest(), host_start=True, stem="canary_mgis")


def umat(copy: Path) -> UmatLibrary:
    """The canary for the driver as a library of its own, which has said nothing yet."""
    copy.parent.mkdir(parents=True, exist_ok=True)
    return UmatLibrary(Path(shutil.copy2(compile_umat(source()), copy)))


def calculix_face() -> Face:
    """The canary behind CalculiX's door for Abaqus UMATs at finite strain."""
    return compiled_face(f"@ABAQUSNL_{CALCULIX_LIBRARY}", CALCULIX_LIBRARY, source())


def canary_files() -> dict[str, str | bytes]:
    """Name and content of all files: source and card for Abaqus, the libraries for CalculiX and for MGIS hosts with theirs."""
    made, face = behaviour(), calculix_face()
    return {
        "canary.for": source(),
        "canary.inp": card("abaqus", "CANARY", 1, False),
        **made.files,
        made.library: compiled(made).read_bytes(),
        f"lib{face.library}.so": face.path.read_bytes(),
    }


def card(host: Any, name: str, rate: int, ask: bool) -> str:
    """Material card of a deck."""
    values = list((PROPS | {"rate": float(rate), "ask": float(ask)}).values())
    return material_card(host, name, values, manifest())
