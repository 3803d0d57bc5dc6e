"""The CalculiX host face: the native external door, which wants S and dS/dE, around material-frame stages."""

from __future__ import annotations

import re
from collections.abc import Sequence

from jinja2 import Environment, PackageLoader, StrictUndefined

from umatgen import __version__
from umatgen.fortran import abaqus
from umatgen.fortran.interface import properties, property_rows, state_rows, state_variables
from umatgen.fortran.layout import lay_out
from umatgen.fortran.printer import decimal
from umatgen.lower.stage import Stage
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


def native_source(scene: Scene, stages: Sequence[Stage]) -> str:
    """Text of the source file for CalculiX's native external door, valid as fixed and as free form.

    The point routine is the one of the Abaqus face; `stages` are those of the material frame.

    Raises
    ------
    SceneError
        The scene has no such face, or more constants than CalculiX takes.
    """
    check(scene)
    used, kept = properties(scene, stages), state_variables(scene)
    if len(used) > LARGEST_CONSTANTS:
        raise SceneError(
            f"scene '{scene.name}' has {len(used)} constants, CalculiX takes at most {LARGEST_CONSTANTS}; "
            "leave the elastic part or a flow stage out"
        )
    procedures = _procedures(scene, stages)
    environment = Environment(loader=PackageLoader("umatgen.fortran", "templates"), undefined=StrictUndefined)
    prefix = f"pf_{scene.name}_"
    text = environment.get_template("calculix_native.f.j2").render(
        scene=scene,
        version=__version__,
        prefix=prefix,
        symbol=SYMBOL,
        library=library_name(scene),
        props=property_rows(used),
        statev=state_rows(kept),
        tries=HALVINGS + 1,
        guess=decimal(GUESSED_WIDENING),
        point_call=_call(procedures, f"{prefix}point", len(used)),
    )
    return lay_out(text.splitlines()) + "\n" + procedures


def check(scene: Scene) -> None:
    """Refuse a scene that has no face for CalculiX.

    Raises
    ------
    SceneError
        Names the field, its value and the one to choose.
    """
    wanted = {"stress_state": "3d", "fibre": "1", "invariants": "transverse"}
    for field, value in wanted.items():
        if getattr(scene, field) != value:
            raise SceneError(
                f"scene '{scene.name}': {field} {getattr(scene, field)!r} has no CalculiX face; choose {value!r} "
                "(CalculiX turns the fibre by *ORIENTATION and has three-dimensional elements only)"
            )
    if scene.baked:
        raise SceneError(
            f"scene '{scene.name}' has baked constants; CalculiX wants at least one in the deck: bake none"
        )
    if scene.two_step:
        raise SceneError(f"scene '{scene.name}': integrator '{scene.integrator}' has no CalculiX face; choose 'bdf1'")
    if scene.table:
        raise SceneError(
            f"scene '{scene.name}' has a temperature table, which has no CalculiX face; give k, a and b of one temperature"
        )
    if scene.tangent == "none":
        raise SceneError(f"scene '{scene.name}': CalculiX needs a tangent; choose one, 'symmetric' for instance")


def _procedures(scene: Scene, stages: Sequence[Stage]) -> str:
    """Everything but the subroutine UMAT of the Abaqus face, with material-frame stages in it."""
    text = abaqus.source(scene, stages).partition(_END_OF_UMAT)[2]
    for spatial, material in _COMMENTS.items():
        if spatial not in text:
            raise LookupError(f"the point routine does not say '{spatial}'; correct _COMMENTS in calculix.py")
        text = text.replace(spatial, material)
    return text.lstrip("\n")


def _call(text: str, name: str, constants: int) -> str:
    """CALL of a procedure with its own order of arguments and the names of the native routine."""
    found = re.search(rf"SUBROUTINE {name}\((.*?)\)", re.sub(r"\s*&\s*", " ", text), re.DOTALL)
    if found is None:
        raise LookupError(f"there is no SUBROUTINE {name} in the Abaqus face")
    dummies = [dummy.strip() for dummy in found.group(1).split(",")]
    actual = _ARGUMENTS | {"props": f"elconloc(1:{constants})"}
    return f"CALL {name}({', '.join(actual[dummy] for dummy in dummies)})"
