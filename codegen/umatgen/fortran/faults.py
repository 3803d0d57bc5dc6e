"""What a UMAT can find fault with, as numbers and messages, and what the head of its source says it left out."""

from __future__ import annotations

from umatgen.fortran.checks import applicable
from umatgen.scene import Scene

FAULTS = (
    (1, "the deformation gradient at the end of the increment is not finite;"),
    (2, "the volume ratio J at the end of the increment must be positive;"),
    (3, "compacted to or beyond the compaction limit: stretch must stay above its bound;"),
    (
        4,
        "the printed invariants are not real here, or have no derivative: (I1-1)**2 - 4 I3 (squeezing) must be positive, and "
        "I1 - 1 - chi_l (bleeding);",
    ),
    (5, "the stress is not finite: deformation, state or constants are out of all range;"),
    (11, "the volume ratio J at the start of the increment must be positive;"),
    (12, "the deformation gradient at the start of the increment is not finite;"),
    (13, "the time increment must be at least its bound and finite (use a *VISCO or *STATIC step with time);"),
    (
        14,
        "compacted to or beyond the compaction limit at the start of the increment: stretch must stay above its bound;",
    ),
    (15, "this scene left out the bleeding stage and the strain has reached the lock;"),
    (16, "this scene left out the squeezing stage and the strain has not reached the lock;"),
    (18, "TEMP + DTEMP lies outside the temperature table of this scene;"),
    (22, "*USER MATERIAL, CONSTANTS= does not fit this scene: NPROPS"),
    (23, "*DEPVAR is too small for this scene: NSTATV"),
    (24, "a constant of *USER MATERIAL is not finite;"),
)


def fault_texts(scene: Scene, places: dict[str, str]) -> list[tuple[int, str]]:
    """Numbers and messages of the faults that a scene can report."""
    kind = "NTENS = 4 (plane strain, axisymmetric)" if scene.ntens == 4 else "NTENS = 6 (solid elements)"
    checks = applicable(places) if scene.checks and not scene.baked else []
    faults = [*FAULTS, (21, f"this scene is for {kind}, plane stress is not supported: NTENS")]
    faults += [(c.number, c.message) for c in checks]
    absent = set() if scene.invariants == "printed" else {4}
    absent |= set() if scene.checks else {5, 13, 24}
    absent |= set() if scene.regimes == "squeeze" else {15}
    absent |= set() if scene.regimes == "bleed" else {16}
    absent |= set() if scene.table else {18}
    absent |= {22, 24} if scene.baked else set()
    return sorted(f for f in faults if f[0] not in absent)


def left_out(scene: Scene) -> list[str]:
    """What a scene leaves out, in words."""
    lines = []
    if not scene.both_regimes:
        lines.append("the bleeding stage." if scene.regimes == "squeeze" else "the squeezing stage and its constraint.")
    if not scene.elastic:
        lines.append("the elastic potential: no stiffness along the fibre but the viscous one.")
    if scene.incompressibility == "none" and scene.regimes != "bleed":
        lines.append("the incompressibility before locking: the host enforces it.")
    if scene.ntens == 4:
        lines.append("shear out of the plane.")
    if scene.baked:
        lines.append("PROPS.")
    if scene.table:
        low, high = dict(scene.table)["temperature"][0], dict(scene.table)["temperature"][-1]
        lines.append(f"k, a and b as PROPS: they follow TEMP + DTEMP by the table in this file, {low:g} to {high:g} degC.")
    if scene.tangent == "none":
        lines.append("DDSDDE.")
    if not scene.energies:
        lines.append("SSE, SCD and the dissipation.")
    if scene.outputs == "minimal":
        lines.append("state variables that the law itself does not need.")
    if not scene.checks:
        lines.append("checks of constants, time increment, start state and finite stress.")
    return lines
