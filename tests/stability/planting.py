"""Errors planted in the emitted source: one statement added, or one condition changed."""

import re
from collections.abc import Callable

Edit = Callable[[str], str]
INDENT = " " * 8


def belongs_to(source: str, scene: str) -> bool:
    """Whether the source is that of the scene; its procedures carry the scene's name."""
    return f"SUBROUTINE pf_{scene}_point(" in source


def insert(anchor: str, statement: str, *, before: bool = False, scene: str | None = None) -> Edit:
    """Add a statement after (or before) every statement whose first line matches the anchor.

    scene : leave the sources of all other scenes as they are.
    """

    def edit(source: str) -> str:
        if scene is not None and not belongs_to(source, scene):
            return source
        lines, found, changed = source.split("\n"), 0, []
        place = 0
        while place < len(lines):
            end = place + 1
            while lines[end - 1].rstrip().endswith("&"):
                end += 1
            matches = re.match(rf"\s*{anchor}", lines[place]) is not None
            found += matches
            changed += [INDENT + statement] if matches and before else []
            changed += lines[place:end]
            changed += [INDENT + statement] if matches and not before else []
            place = end
        assert found, f"the emitted source has no statement {anchor}"
        return "\n".join(changed)

    return edit


def replace(old: str, new: str, *, scene: str | None = None) -> Edit:
    """Replace a text of the source, wherever it stands."""

    def edit(source: str) -> str:
        if scene is not None and not belongs_to(source, scene):
            return source
        assert old in source, f"the emitted source has no text {old}"
        return source.replace(old, new)

    return edit


def both(*edits: Edit) -> Edit:
    """One edit after the other."""

    def edit(source: str) -> str:
        for one in edits:
            source = one(source)
        return source

    return edit


BEFORE_STRESS = r"CALL pf_\w+_stress\("
BEFORE_STATE = r"sse = energy"
PLANTS: dict[str, Edit] = {
    "a stress that is not turned": insert(BEFORE_STRESS, "stress(1) = stress(1) + 1.0d-6"),
    "a rate exponent of zero or less": insert(BEFORE_STRESS, "g_visc = g_visc/sqrt(j2_eff)", before=True),
    "a gap that loses its last digits": replace(
        "gap = stretch - stretch_limit", "gap = ((stretch + 1.0d9) - 1.0d9) - stretch_limit"
    ),
    "no look at the limit": both(
        replace("IF (.NOT. gap > 0.0d0) THEN", "IF (.FALSE.) THEN"),
        replace("IF (.NOT. x_start > stretch_limit**2) THEN", "IF (.FALSE.) THEN"),
    ),
    "no resistance at the limit": insert(BEFORE_STRESS, "g_visc = g_visc*gap**2", before=True),
    "no landing on the lock": replace(
        "pnewdt = min(pnewdt, max(smallest_fraction**2, fraction))", "pnewdt = min(pnewdt, 1.0d0)"
    ),
    "a lock ten times too wide": replace("landing_tolerance = 1.0d-5", "landing_tolerance = 1.0d-4", scene="default"),
    "a lock that never shuts": insert(r"statev\(6\) = pressure", "statev(5) = 0.0d0", scene="default"),
    "a lock that opens again": both(
        replace("locked = statev(5) >= 0.5d0", "locked = .FALSE.", scene="default"),
        replace("max(statev(5), ", "max(0.0d0, ", scene="blend"),
    ),
    "a penalty a thousand times too soft": replace("kappa_eff = kappa\n", "kappa_eff = 1.0d-3*kappa\n"),
    "no pressure carried over": insert(r"CALL pf_\w+_elastic\(", "p_start = 0.0d0", before=True, scene="augmented"),
    "volume not kept": replace("kappa_eff = kappa\n", "kappa_eff = 0.0d0\n"),
    "no check of the constants": insert(r"CALL pf_\w+_check\(", "ifault = 0"),
    "a tangent three times too stiff": insert(BEFORE_STATE, "ddsdde = 3.0d0*ddsdde", before=True),
    "a tangent half a percent off": insert(BEFORE_STATE, "ddsdde = 1.005d0*ddsdde", before=True),
    "transverse springs": replace("e_t = props(11)", "e_t = 1.0d0"),
    "a viscous stress that drives": insert(BEFORE_STRESS, "y_rate = -y_rate", before=True),
    "no floor of the rate": insert(r"j2_floor = ", "j2_floor = 1.0d-60"),
    "transverse form refused": insert(r"CALL pf_\w+_check\(", "ifault = 24", scene="default"),
    "a stiff first tangent": insert(
        r"CALL pf_\w+_gradient\(", "IF (j2 <= j2_floor) g_visc = 1.0d6*g_visc", before=True, scene="default"
    ),
    "dissipation a thousandth too high": insert(r"scd = scd \+ dt\*power", "scd = scd + 1.0d-3*dt*power"),
    "dissipation that falls": insert(r"scd = scd \+ dt\*power", "scd = scd - 2.0d0*dt*power"),
    "no message": replace("IF (ifault /= 0) CALL pf_default_report(", "IF (ifault <  0) CALL pf_default_report("),
    "state variables in the stress": insert(BEFORE_STATE, "stress(1) = stress(1) + 0.0d0*sum(statev)", before=True),
    "not a number": insert(BEFORE_STATE, "IF (stretch < 0.98d0) stress(1) = sqrt(-stretch)", before=True),
}
