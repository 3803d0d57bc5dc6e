"""A diagnosis in words."""

from __future__ import annotations

from plyflow.drive.check import RIGHT, Diagnosis
from plyflow.errors import InputError


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


def report_lines(diagnosis: Diagnosis) -> list[str]:
    """What happened on the path, how far DDSDDE is right, and what is wrong with it."""
    history, worst = diagnosis.history, diagnosis.worst
    lines = [
        f"{history.increments} increments, {history.total_iterations} iterations, {history.cutbacks} cutbacks"
        + ("" if history.completed else f"; stopped: {history.message}")
    ]
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
