"""Prepreg materials: the paper's tables, and any file in the same form.

A material file is TOML with a name, a source, a ply thickness and a table of k, a, b_squeeze, b_bleed
over temperature (Belnoue et al. 2016, Tables 2 and 3). Between columns the parameters are interpolated
by the monotone cubic of Fritsch and Carlson (PCHIP), which neither overshoots nor leaves the columns. Outside the
columns a temperature is refused, unless the file asks for `extrapolation = "linear"`: straight on with the cubic's slope
at the nearest end.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from scipy.interpolate import PchipInterpolator

from plyflow.errors import InputError

INTERPOLATION = (
    "monotone cubic (PCHIP) between the temperature columns, no extrapolation unless the material file asks for it"
)
COLUMNS = ("k", "a", "b_squeeze", "b_bleed")


@dataclass(frozen=True)
class Parameters:
    """Compaction parameters at one temperature.

    k [-], a [-]; b_squeeze, b_bleed [ln(MPa s^(a+1))], the resin viscosity included.
    """

    k: float
    a: float
    b_squeeze: float
    b_bleed: float


class Table(BaseModel):
    """Columns of equal length: temperature [degC], k, a [-], b_squeeze, b_bleed [ln(MPa s^(a+1))]."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    temperature: tuple[float, ...] = Field(min_length=1)
    k: tuple[float, ...]
    a: tuple[float, ...]
    b_squeeze: tuple[float, ...]
    b_bleed: tuple[float, ...]

    @model_validator(mode="after")
    def _check(self) -> Table:
        count = len(self.temperature)
        for name in ("k", "a", "b_squeeze", "b_bleed"):
            if len(getattr(self, name)) != count:
                raise ValueError(f"{name} has {len(getattr(self, name))} values for {count} temperatures")
        if any(np.diff(self.temperature) <= 0.0):
            raise ValueError("temperature must increase strictly")
        if min(self.k) <= 0.0:
            raise ValueError(f"k = {min(self.k):g} must be above 0")
        if min(self.a) <= -1.0:
            raise ValueError(f"a = {min(self.a):g} must be above -1")
        return self


class Material(BaseModel):
    """A prepreg: name, source of the numbers, ply thickness [mm], table over temperature, extrapolation if asked for."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    name: str = Field(min_length=1)
    source: str
    ply_thickness: float = Field(gt=0.0)
    extrapolation: Literal["refused", "linear"] = "refused"
    table: Table

    def at(self, temperature: float) -> Parameters:
        """Parameters at a temperature.

        Parameters
        ----------
        temperature : float
            Temperature [degC], within the table unless the material allows extrapolation.

        Raises
        ------
        InputError
            The temperature is outside the table or not a number; extrapolated parameters outside their bounds.
        """
        columns = self.table
        low, high = columns.temperature[0], columns.temperature[-1]
        if self.extrapolation == "linear" and math.isfinite(temperature):
            return self._extrapolated(temperature, min(max(temperature, low), high))
        if not low <= temperature <= high:
            raise InputError(
                f"temperature {temperature:g} degC is outside {low:g} to {high:g} degC, the range measured "
                f"for {self.name}: choose one inside (the model is not extrapolated)"
            )
        return _interpolated(self, temperature)

    def _extrapolated(self, temperature: float, nearest: float) -> Parameters:
        """Parameters at any temperature: those at the nearest one of the table and straight on from there."""
        values = {}
        for name in COLUMNS:
            column = getattr(self.table, name)
            slope = 0.0
            if temperature != nearest and len(column) > 1:
                slope = float(PchipInterpolator(self.table.temperature, column).derivative()(nearest))
            values[name] = self._interpolate(column, nearest) + slope * (temperature - nearest)
        if not (values["k"] > 0.0 and values["a"] > -1.0):
            raise InputError(
                f"temperature {temperature:g} degC: {self.name} extrapolates to k = {values['k']:g}, a = {values['a']:g}, "
                "which must be above 0 and -1: stay closer to the table"
            )
        return Parameters(**values)

    def _interpolate(self, values: tuple[float, ...], temperature: float) -> float:
        if len(values) == 1:
            return values[0]
        return float(PchipInterpolator(self.table.temperature, values)(temperature))


@lru_cache(maxsize=4096)
def _interpolated(material: Material, temperature: float) -> Parameters:
    """Parameters within the table; kept, because a programme asks for the same temperatures over and over."""
    columns = material.table
    return Parameters(**{name: material._interpolate(getattr(columns, name), temperature) for name in COLUMNS})


def read_material(file: Path | Traversable) -> Material:
    """Read a material file.

    Raises
    ------
    InputError
        The file cannot be read, is not TOML, or does not describe a material; the message names the field.
    """
    try:
        return Material.model_validate(tomllib.loads(file.read_text(encoding="utf-8")))
    except OSError as error:
        raise InputError(f"material file {file} cannot be read: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"material file {file} is not valid TOML: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise InputError(f"material file {file}: {place + ': ' if place else ''}{first['msg']}") from error


@cache
def known_materials() -> dict[str, Material]:
    """Read the materials that come with plyflow, by name, in alphabetical order."""
    folder = resources.files("plyflow") / "data" / "materials"
    found = [read_material(entry) for entry in folder.iterdir() if entry.name.endswith(".toml")]
    return {material.name: material for material in sorted(found, key=lambda material: material.name)}


def find_material(name: str) -> Material:
    """Find a material by name (case does not matter) or by the path of a material file ending in .toml.

    Raises
    ------
    InputError
        No such material; the message lists the known ones.
    """
    if name.lower().endswith(".toml"):
        return read_material(Path(name))
    by_lower_name = {known.lower(): material for known, material in known_materials().items()}
    if name.lower() not in by_lower_name:
        listed = ", ".join(known_materials())
        raise InputError(f"unknown material '{name}': known are {listed}, or give a material file NAME.toml")
    return by_lower_name[name.lower()]
