"""The Abaqus host face: SUBROUTINE UMAT with its 37 arguments, the point routine and the procedures of all stages."""

from __future__ import annotations

from collections.abc import Sequence

from jinja2 import Environment, PackageLoader, StrictUndefined

from umatgen import __version__
from umatgen.fortran.interface import PROPERTIES, property_rows, state_rows
from umatgen.fortran.layout import lay_out
from umatgen.fortran.printer import block_lines, decimal
from umatgen.fortran.procedures import block_of, call_text
from umatgen.lower.stage import Stage
from umatgen.scene import Scene

FAULTS = (
    (1, "the deformation gradient at the end of the increment is not finite;"),
    (2, "the volume ratio J at the end of the increment must be positive;"),
    (3, "compacted to or beyond the compaction limit: stretch must stay above its bound;"),
    (11, "the volume ratio J at the start of the increment must be positive;"),
    (12, "the deformation gradient at the start of the increment is not finite;"),
    (13, "the time increment must be positive and finite (use a *VISCO or *STATIC step with time);"),
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
    (31, "PROPS 15-17 (kappa, rate_floor, strain_floor): kappa >= 0 and positive floors wanted;"),
)
_LOCALS = (
    "eps eps_start det_f_start x_start b_log kappa_eff j2 j2_floor j2_eff det_f area2 a22 a33 a23 a_diff i1 i4 i5 "
    "x_min stretch a_norm2 cos2 sin2 width eps_rate gap g_visc power energy pressure"
).split()


def source(scene: Scene, stages: Sequence[Stage]) -> str:
    """Text of the source file of a scene."""
    prefix = f"pf_{scene.name}_"
    environment = Environment(
        loader=PackageLoader("umatgen.fortran", "templates"), undefined=StrictUndefined, trim_blocks=False
    )
    template = environment.get_template("abaqus_umat.f.j2")
    arrays, scalars = _locals(stages)
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
        faults=FAULTS,
        arrays=", ".join(arrays),
        scalars=", ".join(scalars),
    )
    lines = text.splitlines()
    for stage in stages:
        lines += ["", *block_lines(block_of(stage), prefix)]
    return lay_out(lines)


def unsymmetric(scene: Scene) -> bool:
    """Whether DDSDDE is unsymmetric, so that *USER MATERIAL wants UNSYMM."""
    return scene.tangent == "consistent"


def _locals(stages: Sequence[Stage]) -> tuple[list[str], list[str]]:
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
    own = [name for name in _LOCALS if name not in scalars]
    return list(dict.fromkeys(arrays)), list(dict.fromkeys(scalars + own))
