"""Errors planted in a source on purpose: a check is only worth something once it has been seen to fail.

The one device of the whole test tree. An alteration takes the text of a source and gives it back with one error in
it; `planted` makes an alteration, or a named one of `ERRORS`, and builds what comes out. An alteration that finds
nothing to alter is an error of the test itself. Folders that plant errors of their own (faces of other solvers, printed
formulas, constants of a procedure) add alterations made of `replace`, `insert` and `constant` and hand in their `build`.
"""

import re
from collections.abc import Callable
from functools import reduce
from typing import Any

from plyflow.umat.compile import compile_umat
from plyflow.umat.library import UmatLibrary

Alteration = Callable[[str], str]
LITERAL = re.compile(r"(?<![\w.])(\d+\.\d+)d0\b")
INDENT = " " * 8


def compiled(source: str) -> UmatLibrary:
    """Library of a UMAT source."""
    return UmatLibrary(compile_umat(source))


def planted(source: str, error: str | Alteration, build: Callable[[str], Any] = compiled) -> Any:
    """Build a source with an error in it.

    Parameters
    ----------
    source : text as it is emitted.
    error : name of an alteration in `ERRORS`, or an alteration.
    build : what is made of the altered text; without it a UMAT is compiled and loaded.
    """
    return build((ERRORS[error] if isinstance(error, str) else error)(source))


def of_scene(scene: str, alteration: Alteration) -> Alteration:
    """Leave the sources of all other scenes as they are; the procedures of a source carry its scene's name."""
    return lambda source: alteration(source) if f"SUBROUTINE pf_{scene}_point(" in source else source


def both(*alterations: Alteration) -> Alteration:
    """One alteration after the other."""
    return lambda source: reduce(lambda text, alteration: alteration(text), alterations, source)


def replace(old: str, new: str, *, once: bool = False) -> Alteration:
    """Replace a text of the source wherever it stands; `once`: it must stand in one place only."""

    def alteration(source: str) -> str:
        count = source.count(old)
        assert count == 1 or (count and not once), f"the source has the text {old!r} {count} times"
        return source.replace(old, new)

    return alteration


def insert(anchor: str, statement: str, *, before: bool = False) -> Alteration:
    """Add a statement after (or before) every statement whose first line matches the anchor, continued or not."""
    whole = re.compile(rf"^(?=[ \t]*(?:{anchor}))(?:.*&[ \t]*\n)*.*\n(?: {{5}}[^ 0\n].*\n)*", re.MULTILINE)
    line = f"{INDENT}{statement}\n"

    def alteration(source: str) -> str:
        altered, found = whole.subn(lambda match: line + match[0] if before else match[0] + line, source)
        assert found, f"the source has no statement {anchor}"
        return altered

    return alteration


def procedure(source: str, block: str) -> tuple[int, int]:
    """Where the statements of an emitted procedure lie in the source, from its declarations on."""
    found = re.search(rf"SUBROUTINE \w+_{block}\(.*?END SUBROUTINE \w+_{block}\b", source, re.DOTALL)
    assert found is not None, f"the source has no procedure {block}"
    return found.span()


def constant(block: str, which: int = 0) -> Alteration:
    """Raise the last digit of one of a procedure's real constants that are not zero by one; columns stay."""

    def alteration(source: str) -> str:
        places = [m.span(1) for m in LITERAL.finditer(source, *procedure(source, block)) if float(m[1])]
        assert places, f"procedure {block} has no constant to change"
        last = places[which][1] - 1
        return f"{source[:last]}{(int(source[last]) + 1) % 10}{source[last + 1 :]}"

    return alteration


BEFORE_STRESS = r"CALL pf_\w+_stress\("
BEFORE_STATE = r"sse = energy"
CHECK = r"CALL pf_\w+_check\("
ERRORS: dict[str, Alteration] = {
    "a stress that is not turned": insert(BEFORE_STRESS, "sigma(1) = sigma(1) + 1.0d-6"),
    "a rate exponent of zero or less": insert(BEFORE_STRESS, "g_visc = g_visc/sqrt(j2_eff)", before=True),
    "a gap that loses its last digits": replace(
        "gap = stretch - stretch_limit", "gap = ((stretch + 1.0d9) - 1.0d9) - stretch_limit"
    ),
    "no look at the limit": both(
        replace("IF (.NOT. gap > 0.0d0) THEN", "IF (.FALSE.) THEN"),
        replace("IF (.NOT. x_start > stretch_limit**2) THEN", "IF (.FALSE.) THEN"),
    ),
    "no resistance at the limit": insert(BEFORE_STRESS, "g_visc = g_visc*gap**2", before=True),
    "no widening at the lock": insert(r"CALL pf_\w+_kinematics\(", "widening = 1.0d0", before=True),
    "widening from the end": replace("x_start)/sqrt(x_lock)", "x_end)/sqrt(x_lock)"),
    "stage by the start": replace("IF (x_end <= x_lock) THEN", "IF (x_start <= x_lock) THEN"),
    "a lock that never shuts": insert(r"statev\(6\) = pressure", "statev(5) = 0.0d0"),
    "a lock that opens again": replace("locked = statev(5) >= 0.5d0", "locked = .FALSE."),
    "a penalty a thousand times too soft": replace("kappa_eff = kappa\n", "kappa_eff = 1.0d-3*kappa\n"),
    "no pressure carried over": of_scene("augmented", insert(r"CALL pf_\w+_elastic\(", "p_start = 0.0d0", before=True)),
    "volume not kept": replace("kappa_eff = kappa\n", "kappa_eff = 0.0d0\n"),
    "no check of the constants": insert(CHECK, "ifault = 0"),
    "a tangent three times too stiff": insert(BEFORE_STATE, "ddsdde = 3.0d0*ddsdde", before=True),
    "a tangent half a percent off": insert(BEFORE_STATE, "ddsdde = 1.005d0*ddsdde", before=True),
    "transverse springs": replace("e_t = props(11)", "e_t = 1.0d0"),
    "a viscous stress that drives": insert(BEFORE_STRESS, "y_rate = -y_rate", before=True),
    "no floor of the rate": insert(r"j2_floor = ", "j2_floor = 1.0d-60"),
    "transverse form refused": of_scene("default", insert(CHECK, "ifault = 24")),
    "a stiff first tangent": of_scene(
        "default", insert(r"CALL pf_\w+_gradient\(", "IF (j2 <= j2_floor) g_visc = 1.0d6*g_visc", before=True)
    ),
    "dissipation a thousandth too high": insert(r"scd = scd \+ dt\*power", "scd = scd + 1.0d-3*dt*power"),
    "dissipation two percent too high": insert(r"scd = scd \+ dt\*power", "scd = scd + 2.0d-2*dt*power"),
    "dissipation that falls": insert(r"scd = scd \+ dt\*power", "scd = scd - 2.0d0*dt*power"),
    "a rate lost without time": replace("IF (per_time > 0.0d0) statev(7) =", "statev(7) ="),
    "no message": of_scene(
        "default", replace("IF (ifault /= 0) CALL pf_default_report(", "IF (ifault <  0) CALL pf_default_report(")
    ),
    "state variables in the stress": insert(BEFORE_STATE, "stress(1) = stress(1) + 0.0d0*sum(statev)", before=True),
    "not a number": insert(BEFORE_STATE, "IF (stretch < 0.98d0) stress(1) = sqrt(-stretch)", before=True),
}
