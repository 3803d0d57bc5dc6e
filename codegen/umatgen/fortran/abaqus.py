"""The Abaqus host face: SUBROUTINE UMAT with its 37 arguments, the procedures of the material and the report of faults."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from umatgen import __version__
from umatgen.expressions import decimal
from umatgen.fortran.layout import lay_out
from umatgen.fortran.printer import procedure_lines
from umatgen.lower.faults import fault_texts, left_out
from umatgen.lower.interface import property_rows, state_rows, state_variables
from umatgen.lower.point import properties, property_places
from umatgen.lower.routines import Material
from umatgen.nodes import Declare
from umatgen.scene import Scene

ARGUMENTS = ["STRESS", "STATEV", "DDSDDE", "SSE", "SPD", "SCD", "RPL", "DDSDDT", "DRPLDE", "DRPLDT", "STRAN", "DSTRAN", "TIME", "DTIME", "TEMP", "DTEMP", "PREDEF", "DPRED", "CMNAME", "NDI", "NSHR", "NTENS", "NSTATV", "PROPS", "NPROPS", "COORDS", "DROT", "PNEWDT", "CELENT", "DFGRD0", "DFGRD1", "NOEL", "NPT", "LAYER", "KSPT", "KSTEP", "KINC"]
_OWN = set(["TIME", "CMNAME", "NDI", "NSHR", "NTENS", "NSTATV", "NOEL", "NPT", "KSTEP", "KINC", "PNEWDT"])  # read by UMAT itself
_ACTUAL = {"f0": "DFGRD0", "f1": "DFGRD1", "dt": "DTIME", "theta": "TEMP + DTEMP"}  # dummies of the point routine
_LEGACY = ["STRAN", "DSTRAN", "TEMP", "DTEMP", "PREDEF", "DPRED", "COORDS", "DROT", "CELENT", "LAYER", "KSPT", "SPD", "RPL", "DDSDDT", "DRPLDE", "DRPLDT", "SSE", "SCD", "PROPS", "NPROPS", "DDSDDE", "STATEV"]
TEMPLATES = Environment(loader=PackageLoader("umatgen.fortran", "templates"), undefined=StrictUndefined, autoescape=False)


def source(scene: Scene, material: Material) -> str:
    """Text of the source file of a scene."""
    prefix = f"pf_{scene.name}_"
    head = TEMPLATES.get_template("abaqus_umat.f.j2").render(**_interface(scene, material), prefix=prefix, scene=scene)
    lines = [*head.splitlines(), *procedures(material, prefix), *report(scene, material, prefix)]
    return lay_out(lines, both_forms=scene.layout == "both")


def procedures(material: Material, prefix: str) -> list[str]:
    """Unbroken lines of the procedures, each after an empty line."""
    return [line for routine in material.routines for line in ("", *procedure_lines(routine, prefix))]


def report(scene: Scene, material: Material, prefix: str) -> list[str]:
    """Unbroken lines of the routine that says what is wrong."""
    faults = fault_texts(scene, property_places(scene, material.stages))
    text = TEMPLATES.get_template("report.f.j2").render(scene=scene, prefix=prefix, faults=faults)
    return ["", *text.splitlines()]


def unsymmetric(scene: Scene) -> bool:
    """Whether DDSDDE is unsymmetric, so that *USER MATERIAL wants UNSYMM."""
    return scene.tangent == "consistent"


def actual_arguments(dummies: Sequence[Declare]) -> list[str]:
    """Arguments of UMAT, or its own variables, that stand for the dummies of the point routine."""
    own = {"ifault", "fault_value", "fault_bound"}
    return [_ACTUAL.get(d.name, d.name if d.name in own else d.name.upper()) for d in dummies]


def _interface(scene: Scene, material: Material) -> dict[str, Any]:
    """What the header and the subroutine UMAT need."""
    symmetry = {"consistent": "DDSDDE is not symmetric: *USER MATERIAL, UNSYMM.", "none": "DDSDDE is not computed."}
    axis = "Fibre along n1, n2, n3 of PROPS." if scene.fibre == "free" else f"Fibre along material axis {scene.fibre}."
    actual = actual_arguments(material.point.arguments)
    return {
        "version": __version__,
        "arguments": ", ".join(ARGUMENTS),
        "fibre_text": axis,
        "symmetry_text": symmetry.get(scene.tangent, "DDSDDE is symmetric."),
        "left_out": left_out(scene),
        "plane": scene.ntens == 4,
        "n": scene.ntens,
        "props": property_rows(properties(scene, material.stages)),
        "statev": state_rows(state_variables(scene)),
        "baked": bool(scene.baked),
        "both": scene.both_regimes,
        "tolerance": decimal(scene.landing_tolerance),
        "unused": _unused(actual, bool(scene.baked)),
        "point_actual": ", ".join(actual),
    }


def _unused(actual: Sequence[str], baked: bool) -> list[str]:
    """ASSOCIATE lists of the dummies of UMAT that nothing reads."""
    read = _OWN | {word for argument in actual for word in argument.split(" + ")} | (set() if baked else {"NPROPS"})
    names = [name for name in _LEGACY if name not in read]
    return [
        ", ".join(f"unused_{i} => {name}" for i, name in enumerate(names[first : first + 6], 1))
        for first in range(0, len(names), 6)
    ]
