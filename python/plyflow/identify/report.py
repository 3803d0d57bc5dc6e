"""What a fit gives: plain data for JSON, tables, a material file that the other commands accept."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from plyflow.errors import InputError
from plyflow.identify.judged import judge
from plyflow.identify.lines import LineFit
from plyflow.identify.model import NAMES, predicted
from plyflow.identify.refine import CONFIDENCE, Fit
from plyflow.identify.specimen import Specimen
from plyflow.identify.start import TIE_ROUNDING
from plyflow.identify.valley import TIED
from plyflow.provenance import package_version

DIGITS = 9


def fit_data(fit: Fit) -> dict[str, Any]:
    """Plain data of a fit: each parameter with its interval, scatter, correlation, start, specimens, notes."""
    verdict = judge(fit)
    parameters: dict[str, Any] = {
        name: {"value": one.value, "standard_error": one.error, "interval": [one.low, one.high]}
        for name, one in fit.estimates.items()
    }
    for name, reason in verdict.open.items():  # no number stands for what the readings leave open
        parameters[name] = {"value": None, "standard_error": None, "interval": None, "not_determined": reason}
    k = fit.estimates["k"].value
    parameters["b_squeeze"]["from"] = "b_bleed, tied" if fit.tied else "readings"
    return {
        "temperature": fit.specimens[0].geometry.temperature,
        **parameters,
        "valley": verdict.valley or None,
        "misfit": list(verdict.misfit),
        "offsets_mm": [{"value": one.value, "interval": [one.low, one.high]} for one in fit.offsets],
        "confidence": CONFIDENCE,
        "scatter_mm": fit.scatter,
        "readings": sum(specimen.time.size for specimen in fit.specimens),
        "correlation": {"of": list(TIED), "matrix": np.nan_to_num(fit.correlation).tolist()},
        "straight_lines": None if fit.lines is None else _lines_data(fit.lines),
        "specimens": [_specimen_data(specimen, k) for specimen in fit.specimens],
        "notes": [
            *fit.notes,
            *(
                f"{specimen.name}: thickness read {1e3 * one.value:+.3g} um off ({1e3 * one.low:+.3g} to {1e3 * one.high:+.3g}, 95 % "
                "by itself), fitted; curves are without it"
                for specimen, one in zip(fit.specimens, fit.offsets, strict=False)
            ),
            *(note for specimen in fit.specimens for note in specimen.notes),
            *(_width_note(specimen, k) for specimen in fit.specimens if specimen.width is not None and specimen.like is None),
            *(  # a force in the wrong unit shows here
                f"{specimen.name}: {specimen.time.size} readings in {specimen.load.end:g} s, plate pressure up to "
                f"{specimen.load.peak:.4g} MPa"
                for specimen in fit.specimens
            ),
        ],
        "assumptions": assumption_lines(fit),
        "plyflow_version": package_version(),
    }


def _lines_data(lines: LineFit) -> dict[str, Any]:
    """Result of section 3.2, before the refinement."""
    stages = {
        stage.name.lower(): {name: value if math.isfinite(value) else None for name, value in vars(line).items()}
        for stage, line in lines.lines.items()
    }
    return {"k": lines.k, "misfit": lines.misfit, **stages}


def _specimen_data(specimen: Specimen, k: float) -> dict[str, Any]:
    return {
        "name": specimen.name,
        **vars(specimen.geometry),
        "h0": specimen.geometry.h0,
        "eps_lock": specimen.eps_lock(k),
        "readings": int(specimen.time.size),
        "peak_pressure_MPa": specimen.load.peak,
        "duration_s": specimen.load.end,
    }


def _width_note(specimen: Specimen, k: float) -> str:
    """Compare the measured final width with the lock strain of a k [-]."""
    assert specimen.width is not None
    last = specimen.width[-max(specimen.time.size // 20, 1) :]
    ratio, expected = float(np.mean(last)) / specimen.geometry.width, float(np.exp(-specimen.eps_lock(k)))
    note = f"{specimen.name}: width grew to {ratio:.4f}, Eq. 6 lets it grow to {expected:.4f}"
    if abs(ratio - expected) < 0.005 or ratio < 1.001:
        return note
    return f"{note}; --set eps_lock={-np.log(ratio):.5f} would let it lock there"


def assumption_lines(fit: Fit) -> list[str]:
    """What the parameters rest on besides the readings."""
    k = fit.estimates["k"].value
    lines = list(dict.fromkeys(line for specimen in fit.specimens for line in specimen.assumptions(k)))
    lines += [
        "eps_lock of each specimen from Eq. 6 unless set, a block of equal plies taken as one ply",
        "plate pressure = force / (width x width), plate area constant",
        "load: straight pieces through the readings of force, as few as their noise allows",
        "intervals: 95 % for all parameters at once (Bonferroni), independent normal errors of the thickness readings; "
        "for one parameter by itself, value +- 1.96 standard errors",
    ]
    if fit.tied:
        lines.append(
            f"b_squeeze = b_bleed + 2 ln(l0/d), as in the paper's tables to {TIE_ROUNDING:g}: the readings do not tell it"
        )
    else:
        lines.append(
            "b_squeeze from the readings: the lock puts a kink into the curve, and the intervals come out too narrow (of 84 "
            "synthetic pairs of ramp-dwell and monotonic tests with 5 um of noise they held all parameters in 68)"
        )
    return lines


def curves_table(fit: Fit) -> pd.DataFrame:
    """Readings and fitted thickness [mm] of all specimens, a row a reading."""
    tables = [
        pd.DataFrame(
            {
                "specimen": specimen.name,
                "time_s": specimen.time,
                "pressure_MPa": specimen.pressure,
                "thickness_mm": specimen.thickness,
                "fitted_mm": predicted(specimen, fit.values[None])[0],
            }
        )
        for specimen in fit.specimens
    ]
    return pd.concat(tables, ignore_index=True)


def material_text(name: str, fits: Sequence[Fit]) -> str:
    """Material file with a column for each fit, in order of temperature.

    Raises
    ------
    InputError
        Fits of different ply thickness, or two of one temperature.
    """
    ordered = sorted(fits, key=lambda fit: fit.specimens[0].geometry.temperature)
    temperatures = [fit.specimens[0].geometry.temperature for fit in ordered]
    if len(set(temperatures)) < len(temperatures):
        raise InputError("two fits of one temperature cannot share a material file: fit these specimens together")
    plies = {specimen.geometry.ply_thickness for fit in fits for specimen in fit.specimens}
    if len(plies) > 1:
        listed = ", ".join(f"{value:g}" for value in sorted(plies))
        raise InputError(f"specimens with plies of {listed} mm are not one material: fit them apart")
    files = ", ".join(dict.fromkeys(specimen.name for fit in ordered for specimen in fit.specimens))
    lines = [
        f"# Compaction parameters by temperature, fitted by plyflow identify {package_version()}.",
        "# k and a are numbers, b_squeeze and b_bleed ln(MPa s^(a+1)), temperature degC, thickness mm.",
        f"name = {_quoted(name)}",
        f"source = {_quoted(f'plyflow identify, from {files}')}",
        f"ply_thickness = {plies.pop()!r}",
        "",
        "[table]",
        f"temperature = {temperatures!r}",
    ]
    for parameter in NAMES:
        values = [float(f"{fit.estimates[parameter].value:.{DIGITS}g}") for fit in ordered]
        lines.append(f"{parameter} = {values!r}")
    lines += ["", f"# Intervals that hold all parameters of a temperature at once with {CONFIDENCE:.0%} confidence"]
    lines += [
        f"# {temperature:g} degC, {name}: {fit.estimates[name].low:.6g} to {fit.estimates[name].high:.6g}"
        for temperature, fit in zip(temperatures, ordered, strict=True)
        for name in NAMES
    ]
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    """A basic string of TOML, which has JSON's escapes."""
    return json.dumps(text, ensure_ascii=False)
