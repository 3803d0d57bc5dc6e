"""Checks of the material constants: only those of constants that a scene has."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass


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
    Check(30, "{eps_lock} < 0.0d0", "{eps_lock}", "0.0d0", "[eps_lock] must be negative, compaction strain being negative;"),
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
)  # fmt: skip


def applicable(places: Mapping[str, str]) -> list[Check]:
    """The checks whose constants the scene has, with PROPS in place of the names."""
    result = []
    for check in CHECKS:
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
