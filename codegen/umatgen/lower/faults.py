"""What a UMAT can find fault with, as conditions, numbers and messages, and what the head of its source says it left out."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from umatgen.nodes import Assign
from umatgen.scene import Scene

NO_FAULT = (Assign("ifault", "0"), Assign("fault_value", "0.0d0"), Assign("fault_bound", "0.0d0"))
FAULT = ("ifault", "fault_value", "fault_bound")


@dataclass(frozen=True)
class Check:
    """A condition on constants; names in braces stand for PROPS.

    Parameters
    ----------
    number : of the fault when it does not hold.
    condition : what must hold; false for NaN too.
    value, bound : what the message shows.
    message : text of the fault.
    """

    number: int
    condition: str
    value: str
    bound: str
    message: str

    @property
    def names(self) -> set[str]:
        """Constants it speaks of."""
        return set(re.findall(r"\{(\w+)\}", self.condition))


def _positive(number: int, name: str) -> Check:
    message = f"[{name}] must be positive;"
    return Check(number, f"{{{name}}} > 0.0d0", f"{{{name}}}", "0.0d0", message)


def _floor(number: int, name: str) -> Check:
    return Check(number, f"{{{name}}} >= 1.0d-150", f"{{{name}}}", "1.0d-150", f"[{name}] must be at least its bound;")


CHECKS = (
    _positive(25, "w0"),
    _positive(26, "h0"),
    _positive(27, "l0_over_d"),
    _positive(28, "k"),
    Check(29, "{a} > -1.0d0 .AND. {a} <= 0.0d0", "{a}", "0.0d0", "[a] must lie in (-1, 0];"),
    Check(
        30, "{eps_lock} <= -1.0d-4", "{eps_lock}", "-1.0d-4",
        "[eps_lock] must be at most its bound, compaction strain being negative;",
    ),
    _positive(31, "chi_ratio"),
    _positive(32, "E_L"),
    _positive(33, "E_T"),
    _positive(34, "G_LT"),
    Check(
        35, "abs({nu_TT}) < 1.0d0", "{nu_TT}", "1.0d0",
        "the compliance is not positive definite, [nu_TT] must lie between -1 and 1;",
    ),
    Check(
        36, "(1.0d0 - {nu_TT})*{E_L} > 2.0d0*{nu_LT}**2*{E_T}", "2.0d0*{nu_LT}**2*{E_T}/{E_L}", "1.0d0 - {nu_TT}",
        "the compliance is not positive definite, 2 nu_LT**2 E_T/E_L must stay below 1 - nu_TT: [E_L] and the next three;",
    ),
    Check(37, "{kappa} >= 0.0d0", "{kappa}", "0.0d0", "[kappa] must not be negative;"),
    _floor(38, "rate_floor"),
    _floor(39, "strain_floor"),
    Check(
        40, "max(abs({n1}), abs({n2}), abs({n3})) > 1.0d-300", "max(abs({n1}), abs({n2}), abs({n3}))", "0.0d0",
        "the fibre direction n1, n2, n3 must not be the zero vector;",
    ),
    Check(
        41, "{k}**2*{chi_ratio} < 1.0d0", "{k}**2*{chi_ratio}", "1.0d0",
        "the compaction limit lies before the lock, k**2 chi_ratio must be below 1: [k], [chi_ratio];",
    ),
    Check(
        42, "max(abs({m1}), abs({m2}), abs({m3})) > 1.0d-300", "max(abs({m1}), abs({m2}), abs({m3}))", "0.0d0",
        "the ply normal m1, m2, m3 must not be the zero vector;",
    ),
)  # fmt: skip


FOLLOWS = Check(
    30, "({eps_lock} <= -1.0d-4 .OR. abs({eps_lock}) < tiny(1.0d0))", "{eps_lock}", "-1.0d-4",
    "[eps_lock] must be at most its bound, or 0 to follow the k of the temperature;",
)  # fmt: skip


def applicable(places: Mapping[str, str], table: bool = False) -> list[Check]:
    """The checks whose constants the scene has, with PROPS in place of the names; with a `table` eps_lock may follow k."""
    result = []
    for check in (FOLLOWS if table and check.number == FOLLOWS.number else check for check in CHECKS):
        if check.names <= set(places):
            texts = (_fill(t, places) for t in (check.condition, check.value, check.bound))
            condition, value, bound = texts
            result.append(Check(check.number, condition, value, bound, _name(check.message, places)))
    return result


def _fill(text: str, places: Mapping[str, str]) -> str:
    return re.sub(r"\{(\w+)\}", lambda match: places[match.group(1)], text)


def _name(message: str, places: Mapping[str, str]) -> str:
    """Names in square brackets with their number in PROPS."""
    return re.sub(
        r"\[(\w+)\]", lambda m: f"{places[m.group(1)].replace('(', ' ').rstrip(')').upper()} ({m.group(1)})", message
    )


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
    (13, "the time increment must be finite and not negative;"),
    (
        14,
        "compacted to or beyond the compaction limit at the start of the increment: stretch must stay above its bound;",
    ),
    (6, "this scene left out the bleeding stage and the increment passes the lock;"),
    (15, "this scene left out the bleeding stage and the strain has reached the lock;"),
    (16, "this scene left out the squeezing stage and the strain has not reached the lock;"),
    (17, "the ply normal must not lie along the fibre: squared sine of the angle between them"),
    (18, "TEMP + DTEMP lies outside the temperature table of this scene;"),
    (22, "*USER MATERIAL, CONSTANTS= does not fit this scene: NPROPS"),
    (23, "*DEPVAR is too small for this scene: NSTATV"),
    (24, "a constant of *USER MATERIAL is not finite;"),
)


def fault_texts(scene: Scene, places: dict[str, str]) -> list[tuple[int, str]]:
    """Numbers and messages of the faults that a scene can report."""
    kind = "NTENS = 4 (plane strain, axisymmetric)" if scene.ntens == 4 else "NTENS = 6 (solid elements)"
    checks = applicable(places, bool(scene.table)) if scene.checks and not scene.baked else []
    faults = [*FAULTS, (21, f"this scene is for {kind}, plane stress is not supported: NTENS")]
    faults += [(c.number, c.message) for c in checks]
    absent = set() if scene.compaction == "printed" else {4}
    absent |= set() if scene.checks else {5, 13, 24}
    absent |= set() if scene.regimes == "squeeze" else {6, 15}
    absent |= set() if scene.regimes == "bleed" else {16}
    absent |= set() if scene.table else {18}
    absent |= set() if scene.free else {17}
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
        lines.append("the need for eps_lock: 0 has it follow k by Eqs. A.1 and 6.")
    if scene.tangent == "none":
        lines.append("DDSDDE.")
    if not scene.energies:
        lines.append("SSE, SCD and the dissipation.")
    if scene.outputs == "minimal":
        lines.append("state variables that the law itself does not need.")
    if not scene.checks:
        lines.append("checks of constants, time increment, start state and finite stress.")
    return lines
