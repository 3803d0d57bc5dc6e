"""The CalculiX host face: the native external door, which wants S and dS/dE, around material-frame stages."""

from __future__ import annotations

import re

from jinja2 import Environment, PackageLoader, StrictUndefined

from umatgen import __version__
from umatgen.fortran import abaqus
from umatgen.fortran.interface import property_rows, state_rows
from umatgen.fortran.layout import lay_out
from umatgen.fortran.printer import decimal
from umatgen.lower.blocks import Choices
from umatgen.lower.material_frame_stages import MaterialFrameError, material_frame_stages
from umatgen.scene import Scene, SceneError

SYMBOL = "PFMATERIAL"
LARGEST_CONSTANTS = 21
HALVINGS = 12
GUESSED_WIDENING = 1.001
_END_OF_UMAT = "      END SUBROUTINE UMAT\n"
_ARGUMENTS = {
    "f0": "f_start",
    "f1": "f_end",
    "dt": "dtime",
    "props": f"elconloc(1:{len(property_rows())})",
    "statev": "statev",
    "stress": "stress",
    "ddsdde": "ddsdde",
    "sse": "sse",
    "scd": "scd",
    "pnewdt": "wanted",
    "ifault": "ifault",
    "fault_value": "fault_value",
    "fault_bound": "fault_bound",
}
_COMMENTS = {
    "stress (Cauchy) [MPa], ddsdde [MPa]": "stress (S) [MPa], ddsdde (dS/dE) [MPa]",
    "! Cauchy stress (Eq. 9) and tangent (Eqs. 16-17).": "! Stress S (Eq. 8) and tangent dS/dE (Eq. 16).",
}


def library_name(scene: Scene) -> str:
    """Name of the library without lib and .so: CalculiX reads it in capitals and ends it at an underscore."""
    return "PF" + scene.name.replace("_", "").upper()


def native_source(scene: Scene) -> str:
    """Text of the source file for CalculiX's native external door, valid as fixed and as free form.

    The point routine is the one of the Abaqus face; the stages in it are those of the material frame.

    Raises
    ------
    SceneError
        The scene has choices without such a face, or more constants than CalculiX takes.
    """
    rows = property_rows()
    if len(rows) > LARGEST_CONSTANTS:
        raise SceneError(
            f"scene '{scene.name}' has {len(rows)} constants, CalculiX takes at most {LARGEST_CONSTANTS}; bake some in"
        )
    procedures = _procedures(scene)
    environment = Environment(loader=PackageLoader("umatgen.fortran", "templates"), undefined=StrictUndefined)
    prefix = f"pf_{scene.name}_"
    text = environment.get_template("calculix_native.f.j2").render(
        scene=scene,
        version=__version__,
        prefix=prefix,
        symbol=SYMBOL,
        library=library_name(scene),
        props=rows,
        statev=state_rows(),
        tries=HALVINGS + 1,
        guess=decimal(GUESSED_WIDENING),
        point_call=_call(procedures, f"{prefix}point"),
    )
    return lay_out(text.splitlines()) + "\n" + procedures


def _procedures(scene: Scene) -> str:
    """Everything but the subroutine UMAT of the Abaqus face, with material-frame stages in it."""
    choices = Choices(scene.tangent, scene.invariants, scene.incompressibility, scene.lock == "blend")
    try:
        stages = material_frame_stages(choices)
    except MaterialFrameError as error:
        raise SceneError(f"scene '{scene.name}': {error}") from error
    text = abaqus.source(scene, stages).partition(_END_OF_UMAT)[2]
    for spatial, material in _COMMENTS.items():
        if spatial not in text:
            raise LookupError(f"the point routine does not say '{spatial}'; correct _COMMENTS in calculix.py")
        text = text.replace(spatial, material)
    return text.lstrip("\n")


def _call(text: str, name: str) -> str:
    """CALL of a procedure with its own order of arguments and the names of the native routine."""
    found = re.search(rf"SUBROUTINE {name}\((.*?)\)", re.sub(r"\s*&\s*", " ", text), re.DOTALL)
    if found is None:
        raise LookupError(f"there is no SUBROUTINE {name} in the Abaqus face")
    dummies = [dummy.strip() for dummy in found.group(1).split(",")]
    return f"CALL {name}({', '.join(_ARGUMENTS[dummy] for dummy in dummies)})"
