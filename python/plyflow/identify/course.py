"""A column of temperature in a test: that of the test where it is steady, a course to be followed where it is not."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plyflow.case.materials import Material, find_material
from plyflow.case.measured_file import MeasuredFile
from plyflow.errors import InputError
from plyflow.identify.force import smoothed_force

FloatArray = NDArray[np.float64]
STEADY, AGREES = 3.0, 2.0  # K: range of a steady test; difference to a temperature given besides


@dataclass(frozen=True)
class Course:
    """Temperature that the parameters are of [degC], readings without noise (n,), the material to follow it by, a note."""

    reference: float
    smooth: FloatArray
    like: Material | None
    note: str


def temperature_course(measured: MeasuredFile, entries: Mapping[str, str], like: str | None) -> Course | None:
    """What a column of temperature says; None without one.

    entries: what file and options say, as text; like: name or file of a material, of use only where the temperature changes.

    Raises
    ------
    InputError
        It contradicts the temperature given, changes with no material to follow it by, or leaves that material's table.
    """
    if "temperature" not in measured.columns:
        if like is not None:
            raise InputError(f"{measured.path}: --like {like} follows a column of temperature, and there is none: leave it out")
        return None
    readings = measured.columns["temperature"]
    smooth, mean = smoothed_force(measured.columns["time"], readings), _mean(measured.columns["time"], readings)
    given = re.match(r"[+-]?\d+(?:[.,]\d*)?", entries.get("temperature", "").strip())
    stated = None if given is None else float(given[0].replace(",", "."))
    if like is None or np.ptp(smooth) <= STEADY:
        return _steady(measured, smooth, mean, stated)
    material, reference = find_material(like), round(mean) if stated is None else stated
    for temperature in (float(smooth.min()), float(smooth.max()), float(reference)):
        material.at(temperature)
    note = (
        f"temperature of {measured.path} from {smooth.min():.4g} to {smooth.max():.4g} degC: k, a and b are those of "
        f"{reference:g} degC and follow it as in {material.name} (k by its ratio, a and b by their differences)"
    )
    return Course(float(reference), smooth, material, note)


def _steady(measured: MeasuredFile, smooth: FloatArray, mean: float, stated: float | None) -> Course:
    if np.ptp(smooth) > STEADY:
        raise InputError(
            f"{measured.path}: the temperature goes from {smooth.min():.4g} to {smooth.max():.4g} degC, by more than {STEADY:g} K, "
            "and the parameters are those of one: say with --like MATERIAL whose table they follow it by"
        )
    if stated is not None and abs(stated - mean) > AGREES:
        raise InputError(
            f"{measured.path}: the column of temperature has {mean:.4g} degC in the mean, {stated:g} degC is given besides: correct "
            "one of them"
        )
    reference = mean if stated is None else stated
    note = f"temperature of {measured.path}: {smooth.min():.4g} to {smooth.max():.4g} degC, taken as {reference:.4g} degC"
    return Course(float(f"{reference:.4g}"), smooth, None, note)


def _mean(time: FloatArray, readings: FloatArray) -> float:
    return float(np.trapezoid(readings, time) / (time[-1] - time[0])) if time.size > 1 else float(readings[0])
