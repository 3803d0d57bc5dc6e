"""The CalculiX host face: the native external door, which wants S and dS/dE, around material-frame stages."""

from __future__ import annotations

from umatgen import __version__
from umatgen.expressions import decimal
from umatgen.fortran.abaqus import TEMPLATES, procedures, report
from umatgen.fortran.layout import lay_out
from umatgen.lower.interface import property_rows, state_rows, state_variables
from umatgen.lower.point import properties
from umatgen.lower.routines import Material
from umatgen.scene import Scene, SceneError

SYMBOL = "PFMATERIAL"
LARGEST_CONSTANTS = 21
HALVINGS = 12
GUESSED_WIDENING = 1.001
_LOCAL = {"f0": "f_start", "f1": "f_end", "dt": "dtime"}  # dummies of the point routine


def library_name(scene: Scene) -> str:
    """Name of the library without lib and .so: CalculiX reads it in capitals and ends it at an underscore."""
    return "PF" + scene.name.replace("_", "").upper()


def source(scene: Scene, material: Material) -> str:
    """Text of the source file for CalculiX's native external door, valid as fixed and as free form.

    The procedures are those of the Abaqus face with the stages of the material frame in them.

    Raises
    ------
    SceneError
        The scene has no such face, or more constants than CalculiX takes.
    """
    check(scene)
    used = properties(scene, material.stages)
    if len(used) > LARGEST_CONSTANTS:
        raise SceneError(
            f"scene '{scene.name}' has {len(used)} constants, CalculiX takes at most {LARGEST_CONSTANTS}; "
            "leave the elastic part or a flow stage out"
        )
    prefix = f"pf_{scene.name}_"
    names = _LOCAL | {"props": f"elconloc(1:{len(used)})"}
    text = TEMPLATES.get_template("calculix_native.f.j2").render(
        scene=scene,
        version=__version__,
        prefix=prefix,
        symbol=SYMBOL,
        library=library_name(scene),
        props=property_rows(used),
        statev=state_rows(state_variables(scene)),
        tries=HALVINGS + 1,
        guess=decimal(GUESSED_WIDENING),
        point_call=f"CALL {prefix}point({', '.join(names.get(d.name, d.name) for d in material.point.arguments)})",
    )
    return lay_out([*text.splitlines(), *procedures(material, prefix), *report(scene, material, prefix)])


def check(scene: Scene) -> None:
    """Refuse a scene that has no face for CalculiX.

    Raises
    ------
    SceneError
        Names the field, its value and the one to choose.
    """
    wanted = {"stress_state": "3d", "fibre": "1", "normal": "3", "compaction": "normal"}
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
    if scene.creep:
        raise SceneError(f"scene '{scene.name}': integrator '{scene.integrator}' has no CalculiX face; choose 'bdf1'")
    if scene.table:
        raise SceneError(
            f"scene '{scene.name}' has a temperature table, which has no CalculiX face; give k, a and b of one temperature"
        )
    if scene.tangent == "none":
        raise SceneError(f"scene '{scene.name}': CalculiX needs a tangent; choose one, 'symmetric' for instance")
