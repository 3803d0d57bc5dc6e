"""A diagnosis in words."""

from __future__ import annotations

from pathlib import Path

from plyflow.diagnose.check import RIGHT, Diagnosis
from plyflow.diagnose.library import LIBRARIES, flags_of
from plyflow.errors import InputError
from plyflow.provenance import package_version
from plyflow.umat.compile import compiler_version


def numbers(text: str) -> list[float]:
    """Numbers separated by commas or blanks.

    Raises
    ------
    InputError
        One of them is no number.
    """
    result = []
    for word in text.replace(",", " ").split():
        try:
            result.append(float(word))
        except ValueError:
            raise InputError(f"--props: '{word}' is no number; write for instance --props 1.3,4.1") from None
    return result


def made_with(umat: Path) -> dict[str, str | None]:
    """Version of plyflow, and compiler and flags if the UMAT was compiled here."""
    compiled = umat.suffix.lower() not in LIBRARIES
    return {
        "plyflow_version": package_version(),
        "compiler": compiler_version() if compiled else None,
        "compiler_flags": " ".join(flags_of(umat)) if compiled else None,
    }


def report_lines(diagnosis: Diagnosis) -> list[str]:
    """What happened on the path, how far DDSDDE is right, and what is wrong with it."""
    history, worst = diagnosis.history, diagnosis.worst
    lines = [
        f"{history.increments} increments, {history.total_iterations} iterations, {history.cutbacks} cutbacks"
        + ("" if history.completed else f"; stopped: {history.message}")
    ]
    if diagnosis.undecided:
        lines.append(
            f"{diagnosis.undecided} increments were left out: the stress has two slopes at their ends (a kink), so that "
            "differences are no tangent"
        )
    place = f"in increment {worst.row} (to {worst.time:g} s)"
    if diagnosis.right:
        lines.append(
            f"DDSDDE is right: within {worst.difference:.1e} of differences in {len(diagnosis.points)} increments"
        )
        return lines
    row, column = worst.entry
    wrong = sum(point.difference > RIGHT for point in diagnosis.points)
    lines += [
        f"DDSDDE is wrong in {wrong} of {len(diagnosis.points)} increments checked, by up to {worst.difference:.2g} "
        f"of its largest component {place}:",
        f"  DDSDDE({row},{column}) = {worst.given:.6g} MPa, by differences {worst.right:.6g} MPa",
    ]
    if diagnosis.mistakes:
        lines.append(f"What fits, to {diagnosis.fit:.1e}:")
        lines += [f"  - {sentence}" for sentence in diagnosis.mistakes]
        if len(diagnosis.mistakes) > 1:
            lines.append("  (the increments of this case cannot tell them apart)")
    else:
        lines.append("None of the common mistakes fits.")
    return lines
