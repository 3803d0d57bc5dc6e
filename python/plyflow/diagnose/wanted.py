"""What a UMAT says it wants in place of the constants and state variables that a case gives it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

from plyflow.diagnose.case import Case, props_lines

_SAID = re.compile(r"(NPROPS|NSTATV) value\s+(\S+), bound\s+([^\s,;]+)")
_WHAT = {"NPROPS": "constants", "NSTATV": "state variables"}


def advice(message: str, case: Case, message_of: Callable[[Case], str]) -> str | None:
    """One sentence on the counts that a UMAT refused, None if its message names none.

    A UMAT that refuses the number of constants says nothing yet of its state variables; it is asked again with so many
    zeros.

    Parameters
    ----------
    message
        Why the first increment failed.
    case
        The case that failed.
    message_of
        Runs another case with the same UMAT and returns its message.
    """
    said = _counts(message)
    if "NPROPS" in said:
        others = [line for line in case.settings if not line.startswith("props")]
        zeros = props_lines([0.0] * said["NPROPS"][1])
        said |= _counts(message_of(replace(case, settings=[*others, *zeros])))
    if not said:
        return None
    wants = " and ".join(f"{wanted} {_WHAT[name]} ({given} given)" for name, (given, wanted) in said.items())
    return f"the UMAT wants {wants}: give {_remedy(case, {name: wanted for name, (_, wanted) in said.items()})}"


def _counts(message: str) -> dict[str, tuple[int, int]]:
    """Given and wanted number by the UMAT's argument."""
    try:
        return {name: (int(float(given)), int(float(wanted))) for name, given, wanted in _SAID.findall(message)}
    except (ValueError, OverflowError):
        return {}


def _remedy(case: Case, wanted: dict[str, int]) -> str:
    forms = (
        {"NPROPS": "{} numbers in props", "NSTATV": "n_statev = {}"}
        if case.from_file
        else {"NPROPS": "--props with {} numbers", "NSTATV": "--n-statev {}"}
    )
    asked = " and ".join(forms[name].format(count) for name, count in wanted.items())
    return f"{asked} in {case.name}" if case.from_file else asked
