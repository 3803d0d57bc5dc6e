"""Prepreg materials: the paper's tables, and any file in the same form.

A material file is TOML with a name, a source, a ply thickness and a table of k, a, b_squeeze, b_bleed
over temperature (Belnoue et al. 2016, Tables 2 and 3). Between columns the parameters are interpolated
by the monotone cubic of Fritsch and Carlson (PCHIP), which neither overshoots nor leaves the columns. Outside the
columns a temperature is refused, unless extrapolation is asked for, by the caller or by `extrapolation = "linear"` in the
file: straight on with the cubic's slope at the nearest end.
"""

from __future__ import annotations

import math
import tomllib
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from importlib import resources
from importlib.resources.abc import Traversable
from itertools import pairwise
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from plyflow.errors import InputError
from plyflow.wording import count_text, known_text

INTERPOLATION = "monotone cubic (PCHIP)"
COLUMNS = ("k", "a", "b_squeeze", "b_bleed")
ZERO_CELSIUS = 273.15  # K
ROUNDING = 1e-12  # of the cubic, where a column has a = 0


@dataclass(frozen=True)
class Parameters:
    """Compaction parameters at one temperature.

    k [-], a [-]; b_squeeze, b_bleed [ln(MPa s^(a+1))], the resin viscosity included.
    """

    k: float
    a: float
    b_squeeze: float
    b_bleed: float


@dataclass(frozen=True)
class CubicPieces:
    """A parameter over temperature, one cubic between each two breakpoints, as plain numbers.

    Plain numbers, because generated Fortran holds the same table: both evaluate ((c3 s + c2) s + c1) s + c0 with
    s = temperature - breakpoint, in this order, and agree to rounding.

    breakpoints (n,) [degC], increasing, twice the same for a parameter known at one temperature only; coefficients
    (n - 1, 4): c3, c2, c1, c0 of each piece; end_slopes (2,) [1/degC], with which a linear extrapolation goes on.
    """

    breakpoints: tuple[float, ...]
    coefficients: tuple[tuple[float, float, float, float], ...]
    end_slopes: tuple[float, float]

    def at(self, temperature: float) -> float:
        """Value at a temperature [degC]; outside the breakpoints straight on with the slope at the end."""
        low, high = self.breakpoints[0], self.breakpoints[-1]
        inside = min(max(temperature, low), high)
        piece = min(bisect_right(self.breakpoints, inside), len(self.coefficients)) - 1
        c3, c2, c1, c0 = self.coefficients[piece]
        s = inside - self.breakpoints[piece]
        value = ((c3 * s + c2) * s + c1) * s + c0
        if temperature == inside:
            return value
        return value + self.end_slopes[0 if temperature < low else 1] * (temperature - inside)


def monotone_cubic(temperatures: Sequence[float], values: Sequence[float]) -> CubicPieces:
    """The monotone cubic (PCHIP) through values (n,) at temperatures (n,) [degC]; one value is a constant."""
    if len(values) == 1:
        return CubicPieces((temperatures[0], temperatures[0]), ((0.0, 0.0, 0.0, values[0]),), (0.0, 0.0))
    from scipy.interpolate import PchipInterpolator  # noqa: PLC0415 - slow to load; a scene without a table needs none

    cubic = PchipInterpolator(temperatures, values)
    slope = cubic.derivative()
    return CubicPieces(
        tuple(cubic.x.tolist()),
        tuple(zip(*cubic.c.tolist(), strict=True)),
        (float(slope(temperatures[0])), float(slope(temperatures[-1]))),
    )


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
        wanted = count_text(len(self.temperature), "temperature", "temperatures")
        for name in COLUMNS:
            column = getattr(self, name)
            if len(column) != len(self.temperature):
                raise ValueError(f"{name} has {count_text(len(column), 'value', 'values')} for {wanted}: give one for each")
        for earlier, later in pairwise(self.temperature):
            if later <= earlier:
                raise ValueError(f"temperature {later:g} degC follows {earlier:g} degC: put the columns in increasing order")
        if min(self.k) <= 0.0:
            raise ValueError(f"k = {min(self.k):g} must be above 0: it is the fibre gap at the compaction limit")
        if min(self.a) <= -1.0:
            raise ValueError(f"a = {min(self.a):g} must be above -1: at -1 the creep rate is unbounded")
        if max(self.a) > 0.0:
            raise ValueError(f"a = {max(self.a):g} must be at most 0: above 0 the resin would thicken with its rate")
        return self


class Material(BaseModel):
    """A prepreg: name, source of the numbers, ply thickness [mm], table over temperature, extrapolation if asked for."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    name: str = Field(min_length=1)
    source: str = "not stated"
    ply_thickness: float = Field(gt=0.0)
    extrapolation: Literal["refused", "linear"] = "refused"
    table: Table

    def at(self, temperature: float, extrapolate: bool = False) -> Parameters:
        """Parameters at a temperature [degC]; outside the table, if asked for, straight on with the slope at the nearest end.

        Raises
        ------
        InputError
            The temperature is not a number, or outside the table where neither the caller nor the material file asks for
            extrapolation; extrapolated parameters are outside their bounds.
        """
        may_leave = extrapolate or self.extrapolation == "linear"
        if not math.isfinite(temperature) or (self.is_outside(temperature) and not may_leave):
            raise InputError(
                f"temperature {temperature:g} degC is outside {self.range_text()}, the range of "
                f"{self.name}{self._kelvin(temperature)}: "
                "choose one inside, or ask for extrapolation with --extrapolate (in a material file: "
                'extrapolation = "linear")'
            )
        parameters = _parameters(self, temperature)
        if not (parameters.k > 0.0 and -1.0 < parameters.a <= ROUNDING):
            raise InputError(
                f"temperature {temperature:g} degC: {self.name} extrapolates to k = {parameters.k:g}, "
                f"a = {parameters.a:g}; k must be above 0, a above -1 and at most 0: stay closer to {self.range_text()}"
            )
        return parameters

    def _kelvin(self, temperature: float) -> str:
        """A hint where the temperature would be inside if it were given in K."""
        celsius = round(temperature - ZERO_CELSIUS, 2)
        return "" if self.is_outside(celsius) else f" ({temperature:g} K are {celsius:g} degC)"

    def is_outside(self, temperature: float) -> bool:
        """Whether a temperature [degC] is outside the table."""
        return not self.table.temperature[0] <= temperature <= self.table.temperature[-1]

    def range_text(self) -> str:
        """Temperatures of the table, for messages."""
        low, high = self.table.temperature[0], self.table.temperature[-1]
        return f"{low:g} to {high:g} degC" if low < high else f"{low:g} degC alone"

    def source_of(self, temperature: float) -> str:
        """How the parameters at a temperature [degC] come from the table, for the list of assumptions."""
        columns = f"the temperature columns, {self.range_text()}"
        if self.is_outside(temperature):
            return f"extrapolated as asked, straight on with the slope at the nearest end of {columns}"
        if temperature in self.table.temperature:
            return f"column {temperature:g} degC of the table (between columns: {INTERPOLATION})"
        return f"{INTERPOLATION} between {columns}"


@lru_cache(maxsize=256)
def temperature_table(material: Material) -> dict[str, CubicPieces]:
    """The material as piecewise cubics over temperature: k, a, b_squeeze, b_bleed by name, all plain floats."""
    columns = material.table
    return {name: monotone_cubic(columns.temperature, getattr(columns, name)) for name in COLUMNS}


@lru_cache(maxsize=4096)
def _parameters(material: Material, temperature: float) -> Parameters:
    """Kept, because a programme asks for the same temperatures over and over."""
    return Parameters(**{name: pieces.at(temperature) for name, pieces in temperature_table(material).items()})


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
        raise InputError(f"material file {file}: {_complaint(error)}") from error


def _complaint(error: ValidationError) -> str:
    """The first complaint about a material file: the key, what was found, what is wanted."""
    first = error.errors()[0]
    place = ".".join(str(part) for part in first["loc"])
    in_table = place.startswith("table.")
    match first["type"]:
        case "missing":
            add = "[table], one column a temperature" if place == "table" else f"{place.removeprefix('table.')} = ..."
            return f"{place} is missing: add {add}"
        case "extra_forbidden":
            known = ", ".join(Table.model_fields if in_table else Material.model_fields)
            return f"'{place}' is not known: the keys {'of [table] ' if in_table else ''}are {known}"
        case "value_error":
            return str(first["ctx"]["error"])
    return f"{place} = {first['input']!r}: {first['msg'][:1].lower()}{first['msg'][1:]}"


def material_text(name: str) -> str:
    """Text of the file of a material, shipped or named by its path.

    Raises
    ------
    InputError
        See `find_material`.
    """
    found = find_material(name)
    if name.lower().endswith(".toml"):
        return Path(name).read_text(encoding="utf-8")
    return (_shipped() / f"{found.name.lower()}.toml").read_text(encoding="utf-8")


def _shipped() -> Traversable:
    return resources.files("plyflow") / "data" / "materials"


@cache
def known_materials() -> dict[str, Material]:
    """Read the materials that come with plyflow, by name, in alphabetical order."""
    found = [read_material(entry) for entry in _shipped().iterdir() if entry.name.endswith(".toml")]
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
        raise InputError(f"unknown material '{name}'{known_text(name, known_materials())}, or give a material file NAME.toml")
    return by_lower_name[name.lower()]
