"""The Abaqus host face: SUBROUTINE UMAT with its 37 arguments, the point routine and the procedures of all stages."""

from __future__ import annotations

from collections.abc import Sequence

from jinja2 import Environment, PackageLoader, StrictUndefined

from umatgen import __version__
from umatgen.fortran.interface import PROPERTIES, property_rows, state_rows
from umatgen.fortran.layout import lay_out
from umatgen.fortran.printer import block_lines, decimal, expression
from umatgen.fortran.procedures import block_of, call_text
from umatgen.lower.stage import Stage
from umatgen.model import lock
from umatgen.notation import sym
from umatgen.scene import Scene

FAULTS = (
    (1, "the deformation gradient at the end of the increment is not finite;"),
    (2, "the volume ratio J at the end of the increment must be positive;"),
    (3, "compacted to or beyond the compaction limit: stretch must stay above its bound;"),
    (4, "the printed invariants are not real here: (I1-1)**2 - 4 I3 is negative;"),
    (11, "the volume ratio J at the start of the increment must be positive;"),
    (12, "the deformation gradient at the start of the increment is not finite;"),
    (13, "the time increment must be at least its bound and finite (use a *VISCO or *STATIC step with time);"),
    (
        14,
        "compacted to or beyond the compaction limit at the start of the increment: stretch must stay above its bound;",
    ),
    (21, "only solid elements with NTENS = 6 are supported, not plane stress or plane strain: NDI"),
    (22, "*USER MATERIAL, CONSTANTS= does not fit this scene: NPROPS"),
    (23, "*DEPVAR is too small for this scene: NSTATV"),
    (24, "a constant of *USER MATERIAL is not finite;"),
    (25, "PROPS 1-4 (w0, h0, l0_over_d, k) must be positive;"),
    (26, "PROPS 5 (a) must lie in (-1, 0];"),
    (27, "PROPS 8 (eps_lock) must be negative, compaction strain being negative;"),
    (28, "PROPS 9 (chi_ratio) must be positive;"),
    (29, "PROPS 10, 11, 14 (E_L, E_T, G_LT) must be positive;"),
    (30, "PROPS 10-13: not positive definite, 2 nu_LT**2 E_T/E_L must stay below 1 - nu_TT;"),
    (32, "not positive definite, PROPS 13 (nu_TT) must lie between -1 and 1;"),
    (31, "PROPS 15-17 (kappa, rate_floor, strain_floor): kappa >= 0 and positive floors wanted;"),
)
_LOCALS = [
    "eps",
    "det_f_start",
    "x_start",
    "kappa_eff",
    "j2",
    "j2_floor",
    "j2_eff",
    "det_f",
    "area2",
    "a22",
    "a33",
    "a23",
    "a_diff",
    "i1",
    "i4",
    "i5",
    "x_min",
    "stretch",
    "a_norm2",
    "cos2",
    "sin2",
    "width",
    "eps_rate",
    "gap",
    "g_visc",
    "power",
    "energy",
    "pressure",
]


def source(scene: Scene, stages: Sequence[Stage]) -> str:
    """Text of the source file of a scene."""
    prefix = f"pf_{scene.name}_"
    environment = Environment(
        loader=PackageLoader("umatgen.fortran", "templates"), undefined=StrictUndefined, trim_blocks=False
    )
    template = environment.get_template("abaqus_umat.f.j2")
    arrays, scalars = _locals(stages, scene)
    by_name = {stage.name: stage for stage in stages}
    text = template.render(
        scene=scene,
        version=__version__,
        prefix=prefix,
        unsymmetric=unsymmetric(scene),
        tolerance=decimal(scene.landing_tolerance),
        props=property_rows(),
        statev=state_rows(),
        property_names=[(i, p.fortran) for i, p in enumerate(PROPERTIES, 1)],
        calls={stage.name: call_text(stage, prefix) for stage in stages},
        flow=_flow_calls(scene, by_name, prefix),
        printed=_printed_calls(scene, by_name, prefix),
        text=_texts(),
        internal=scene.procedures == "internal",
        blend=scene.lock == "blend",
        augmented=scene.incompressibility == "augmented",
        last_rate=scene.first_tangent == "last_rate",
        width=decimal(scene.blend_width),
        faults=FAULTS,
        arrays=", ".join(arrays),
        scalars=", ".join(scalars),
    )
    lines = text.splitlines()
    procedures = [line for stage in stages for line in ("", *block_lines(block_of(stage), prefix))]
    place = lines.index("!@stages") if "!@stages" in lines else len(lines)
    return lay_out([*lines[:place], *procedures, *lines[place + 1 :]])


def _flow_calls(scene: Scene, stages: dict[str, Stage], prefix: str) -> dict[str, str]:
    """Calls of the two flow stages with the names that the scene gives their arguments."""
    calls = {}
    for name, letter in (("squeeze", "s"), ("bleed", "b")):
        rename = {"b_log": f"b_{name}"} if scene.lock == "blend" else {}
        if scene.lock == "blend":
            rename |= {"g_visc": f"g_{name}"}
            rename |= {f"dlng_{v}": f"dlng{letter}_{v}" for v in ("det_f", "stretch", "a_norm2", "j2")}
        if scene.invariants == "printed":
            rename |= {"stretch": "p_stretch", "a_norm2": "p_norm2"}
        calls[name] = call_text(stages[name], prefix, **rename)
    return calls


def _printed_calls(scene: Scene, stages: dict[str, Stage], prefix: str) -> dict[str, str]:
    if scene.invariants != "printed":
        return {"squeeze": "", "bleed": ""}
    return {name: call_text(stages[f"printed_{name}"], prefix) for name in ("squeeze", "bleed")}


def _texts() -> dict[str, str]:
    """Scalar expressions of the point routine, from the model."""
    j2_eff, a_rate = sym("j2_eff", "a_rate")
    return {
        "window": expression(lock.window_position()),
        "smoothstep": expression(lock.smoothstep(lock.XI)),
        "slope": expression(lock.slope_of_step()),
        "rate_ratio": f"(4.0d0*statev(7)**2/{j2_eff})**({expression(a_rate / 2)})",
    }


def unsymmetric(scene: Scene) -> bool:
    """Whether DDSDDE is unsymmetric, so that *USER MATERIAL wants UNSYMM."""
    return scene.tangent == "consistent"


def _locals(stages: Sequence[Stage], scene: Scene) -> tuple[list[str], list[str]]:
    """Local arrays and scalars of the point routine: outputs of the stages, properties, and the routine's own."""
    dummies = {"f0", "f1", "dt", "stress", "ddsdde"}
    arrays, scalars = [], [p.fortran for p in PROPERTIES]
    for stage in stages:
        for variable in stage.outputs:
            if variable.name in dummies:
                continue
            if variable.shape:
                arrays.append(f"{variable.name}({','.join(map(str, variable.shape))})")
            else:
                scalars.append(variable.name)
    own = [name for name in (*_LOCALS, *_option_locals(scene)) if name not in scalars]
    scalars = [name for name in scalars if name != "blend_width"]
    return list(dict.fromkeys(arrays)), list(dict.fromkeys(scalars + own))


def _option_locals(scene: Scene) -> list[str]:
    """Locals that only some scenes have."""
    if scene.lock == "blend":
        names = ["xi", "s_start", "s_lock", "ds_dstretch", "g_squeeze", "g_bleed"]
        return names + [f"dlng{x}_{v}" for x in "sb" for v in ("det_f", "stretch", "a_norm2", "j2")]
    return ["eps_start", "b_log"] + (["p_start"] if scene.incompressibility == "augmented" else [])
