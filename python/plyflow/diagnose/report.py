"""A diagnosis and the verdicts as data, in words and as a page, and what they were made with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from plyflow.diagnose.check import Diagnosis
from plyflow.diagnose.examine import Verdict
from plyflow.diagnose.library import LIBRARIES, flags_of
from plyflow.diagnose.mistakes import RIGHT
from plyflow.errors import InputError
from plyflow.provenance import package_version
from plyflow.show.page import Card, Items, Page, Section
from plyflow.show.table import Cell, Column, Table
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


def report_data(diagnosis: Diagnosis) -> dict[str, Any]:
    """Plain data, ready for JSON."""
    history, worst = diagnosis.history, diagnosis.worst
    return {
        "completed": history.completed,
        "message": history.message,
        "increments": history.increments,
        "iterations": history.total_iterations,
        "cutbacks": history.cutbacks,
        "increments_checked": len(diagnosis.points),
        "increments_undecided": diagnosis.undecided,
        "tangent_right": diagnosis.right,
        "largest_difference": worst.difference,
        "at_time_s": worst.time,
        "component": list(worst.entry),
        "ddsdde_MPa": worst.given,
        "by_differences_MPa": worst.right,
        "mistakes": list(diagnosis.mistakes),
        "difference_left": diagnosis.fit,
    }


def report_lines(diagnosis: Diagnosis) -> list[str]:
    """What happened on the path, how far DDSDDE is right, and what is wrong with it."""
    history, worst, checked = diagnosis.history, diagnosis.worst, len(diagnosis.points)
    lines = [
        f"{history.increments} increments, {history.total_iterations} iterations, {history.cutbacks} cutbacks"
        + ("" if history.completed else f"; stopped: {history.message}")
    ]
    if diagnosis.undecided:
        lines.append(
            f"{diagnosis.undecided} increments were left out: the stress has two slopes at their ends (a kink), so that "
            "differences are no tangent"
        )
    if diagnosis.right:
        return [*lines, f"DDSDDE is right: within {worst.difference:.1e} of differences in {checked} increments"]
    wrong = sum(point.difference > RIGHT for point in diagnosis.points)
    lines += [
        f"DDSDDE is wrong in {wrong} of {checked} increments checked, by up to {worst.difference:.2g} "
        f"of its largest component in increment {worst.row} (to {worst.time:g} s):",
        f"  DDSDDE({','.join(worst.entry)}) = {worst.given:.6g} MPa, by differences {worst.right:.6g} MPa",
    ]
    if not diagnosis.mistakes:
        return [*lines, "None of the common mistakes fits."]
    lines += [f"What fits, to {diagnosis.fit:.1e}:", *(f"  - {sentence}" for sentence in diagnosis.mistakes)]
    if len(diagnosis.mistakes) > 1:
        lines.append("  (the increments of this case cannot tell them apart)")
    return lines


TONES = {"good": "good", "look": "warn", "bad": "bad", "open": "soft"}


def verdict_data(verdicts: Sequence[Verdict]) -> list[dict[str, str]]:
    """The verdicts as plain data, ready for JSON."""
    return [asdict(verdict) for verdict in verdicts]


def verdict_table(verdicts: Sequence[Verdict]) -> Table:
    """The verdicts, each with what to do."""
    columns = (Column("check"), Column("verdict"), Column("found", wrap=True), Column("what to do", wrap=True))
    return Table(columns, [(v.check, Cell(v.outcome, TONES[v.outcome]), v.found, v.remedy) for v in verdicts])


def page(name: str, diagnosis: Diagnosis, verdicts: Sequence[Verdict], inputs: Mapping[str, Any]) -> Page:
    """The page of an examination; the inputs say what was examined along which path, and what it was made with."""
    path = [line.strip(" -") for line in report_lines(diagnosis)]
    counts = {outcome: sum(v.outcome == outcome for v in verdicts) for outcome in TONES}
    return Page(
        f"Examination of {name}",
        "One material point, called as Abaqus/Standard calls it, along one path: is DDSDDE right, and does the routine keep what "
        "hosts take for granted?",
        [Section("Verdicts", [verdict_table(verdicts)]), Section("The path", [Items(path)])],
        cards=[Card(count, outcome, TONES[outcome] if count else "soft") for outcome, count in counts.items()],
        limits=[
            "A verdict holds for this path and these constants: another path may reach branches that this one did not.",
            "Two threads can only be caught at a race that happens; that no variable is shared is said by SAVE and COMMON.",
        ],
        provenance=inputs,
    )
