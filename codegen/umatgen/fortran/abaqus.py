"""The Abaqus host face: SUBROUTINE UMAT with its 37 arguments, the procedures of the material and the report of faults."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from umatgen import __version__
from umatgen.fortran.layout import lay_out
from umatgen.fortran.printer import procedure_lines
from umatgen.lower.faults import fault_texts, left_out
from umatgen.lower.interface import property_rows, state_rows, state_variables
from umatgen.lower.point import properties, property_places
from umatgen.lower.routines import Material
from umatgen.nodes import Declare
from umatgen.scene import Scene

ARGUMENTS = [
    "STRESS", "STATEV", "DDSDDE", "SSE", "SPD", "SCD", "RPL", "DDSDDT", "DRPLDE", "DRPLDT", "STRAN", "DSTRAN", "TIME", "DTIME",
    "TEMP", "DTEMP", "PREDEF", "DPRED", "CMNAME", "NDI", "NSHR", "NTENS", "NSTATV", "PROPS", "NPROPS", "COORDS", "DROT",
    "PNEWDT", "CELENT", "DFGRD0", "DFGRD1", "NOEL", "NPT", "LAYER", "KSPT", "KSTEP", "KINC",
]  # fmt: skip
_OWN = {"TIME", "CMNAME", "NDI", "NSHR", "NTENS", "NSTATV", "NOEL", "NPT", "KSTEP", "KINC", "PNEWDT"}  # read by UMAT itself
_ACTUAL = {"f0": "DFGRD0", "f1": "DFGRD1", "dt": "DTIME", "theta": "TEMP + DTEMP"}  # dummies of the point routine
TEMPLATES = Environment(loader=PackageLoader("umatgen.fortran", "templates"), undefined=StrictUndefined, autoescape=False)


def source(scene: Scene, material: Material) -> str:
    """Text of the source file of a scene."""
    prefix = f"pf_{scene.name}_"
    head = TEMPLATES.get_template("abaqus_umat.f.j2").render(**_interface(scene, material), prefix=prefix, scene=scene)
    lines = [*head.splitlines(), *procedures(material, prefix), *report(scene, material, prefix)]
    return lay_out(lines, scene.form)


def procedures(material: Material, prefix: str) -> list[str]:
    """Unbroken lines of the procedures, each after an empty line."""
    return [line for routine in material.routines for line in ("", *procedure_lines(routine, prefix))]


def report(scene: Scene, material: Material, prefix: str) -> list[str]:
    """Unbroken lines of the routine that says what is wrong."""
    faults = fault_texts(scene, property_places(scene, material.stages))
    text = TEMPLATES.get_template("report.f.j2").render(scene=scene, prefix=prefix, faults=faults, where=_WHERE)
    return text.splitlines()


def unsymmetric(scene: Scene) -> bool:
    """Whether DDSDDE is unsymmetric, so that *USER MATERIAL wants UNSYMM."""
    return scene.tangent == "consistent"


def actual_arguments(dummies: Sequence[Declare]) -> list[str]:
    """Arguments of UMAT, or its own variables, that stand for the dummies of the point routine."""
    own = {"ifault", "fault_value", "fault_bound"}
    return [_ACTUAL.get(d.name, d.name if d.name in own else d.name.upper()) for d in dummies]


def _interface(scene: Scene, material: Material) -> dict[str, Any]:
    """What the header and the subroutine UMAT need."""
    actual = actual_arguments(material.point.arguments)
    return {
        "version": __version__,
        "arguments": ", ".join(ARGUMENTS),
        "form_text": _FORM[scene.form],
        "frame_text": f"Fibre along {_direction(scene.fibre, 'n')}, ply normal along {_direction(scene.normal, 'm')}.",
        "tangent_text": f"Tangent: {scene.tangent}; {_SYMMETRY.get(scene.tangent, 'DDSDDE is symmetric.')}",
        "order": "11, 22, 33, 12" if scene.ntens == 4 else "11, 22, 33, 12, 13, 23",
        "left_out": left_out(scene),
        "props": [] if scene.baked else property_rows(properties(scene, material.stages)),
        "statev": state_rows(state_variables(scene)),
        "lock_text": lock_text(scene),
        "unused": _unused(actual, bool(scene.baked)),
        "point_actual": ", ".join(actual),
    }


_FORM = {"fixed": "Fixed form, 72 or 132 columns.", "free": "Free form."}
_SYMMETRY = {"consistent": "DDSDDE is not symmetric: *USER MATERIAL, UNSYMM.", "none": "DDSDDE is not computed."}
_WHERE = "value %R, bound %R; element %I, point %I, step %I, increment %I, step time %R, total time %R, material %S"


def _direction(key: str, name: str) -> str:
    return f"{name}1, {name}2, {name}3 of PROPS" if key == "free" else f"material axis {key}"


def lock_text(scene: Scene) -> str:
    """What the source says of its stages of flow."""
    held = " After it kappa holds the ply at that width: a pressure p widens it by at most p/kappa + 1e-4." * scene.holds_width
    if not scene.both_regimes:
        return f"Only the {scene.regimes} stage is kept: a state on the other side of the lock is refused.{held}"
    return (
        "An increment that ends at the lock or beyond it belongs to the bleed stage, and so do all after it: no increment has to "
        "end on the lock, and PNEWDT is touched by faults only. A free edge has the width exp(-eps_lock) afterwards, "
        f"whatever the increments.{held}"
    )


def _unused(actual: Sequence[str], baked: bool) -> list[str]:
    """ASSOCIATE lists of the dummies of UMAT that nothing reads."""
    read = _OWN | {word for argument in actual for word in argument.split(" + ")} | (set() if baked else {"NPROPS"})
    names = [name for name in ARGUMENTS if name not in read]
    return [
        ", ".join(f"unused_{i} => {name}" for i, name in enumerate(names[first : first + 6], 1))
        for first in range(0, len(names), 6)
    ]
