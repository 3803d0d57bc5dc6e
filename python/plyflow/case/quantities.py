"""Kinds of columns, their units, and the headings that people give them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Quantity:
    """One kind of column: name, unit it is turned into, other names, factor to that unit by unit (lower case).

    Of units that differ in case only, those in `exact` are taken as written; `shifts` is added after the factor.
    """

    name: str
    unit: str
    aliases: tuple[str, ...]
    factors: Mapping[str, float]
    exact: Mapping[str, float] = field(default_factory=dict)
    shifts: Mapping[str, float] = field(default_factory=dict)

    def factor(self, unit: str) -> float | None:
        """Factor from a unit to this quantity's, None for an unknown unit."""
        return self.exact.get(unit, self.factors.get(unit.lower()))

    def shift(self, unit: str) -> float:
        """What is added after the factor."""
        return self.shifts.get(unit.lower(), 0.0)


_TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0}
_FORCES = {"n": 1.0, "kn": 1e3, "kgf": 9.80665, "lbf": 4.4482216}
_PRESSURES = {"mpa": 1.0, "kpa": 1e-3, "pa": 1e-6, "bar": 0.1, "mbar": 1e-4, "psi": 6.894757e-3, "n/mm2": 1.0, "n/mm²": 1.0}
_LENGTHS = {"mm": 1.0, "um": 1e-3, "µm": 1e-3, "μm": 1e-3, "micron": 1e-3, "cm": 10.0, "m": 1e3, "in": 25.4}
_CELSIUS, _KELVIN, _FAHRENHEIT = ("degc", "°c", "c", "celsius"), ("k", "kelvin"), ("degf", "°f")
_TEMPERATURES = dict.fromkeys((*_CELSIUS, *_KELVIN), 1.0) | dict.fromkeys(_FAHRENHEIT, 5.0 / 9.0)
_SHIFTS = dict.fromkeys(_KELVIN, -273.15) | dict.fromkeys(_FAHRENHEIT, -160.0 / 9.0)
QUANTITIES: dict[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        Quantity("time", "s", ("t", "zeit", "temps", "tiempo", "tempo"), _TIMES),
        Quantity("temperature", "degC", ("t", "temp", "temperatur", "température"), _TEMPERATURES, shifts=_SHIFTS),
        Quantity("force", "N", ("f", "load", "kraft", "effort"), _FORCES, {"mN": 1e-3, "MN": 1e6}),
        Quantity("pressure", "MPa", ("p", "stress", "druck"), _PRESSURES, {"mPa": 1e-9}),
        Quantity("thickness", "mm", ("h", "height", "gap", "dicke", "epaisseur", "épaisseur"), _LENGTHS),
        Quantity("width", "mm", ("w", "breite", "largeur"), _LENGTHS),
    )
}


def split_heading(heading: str) -> tuple[str, str | None]:
    """Name and unit of a heading: "Force [N]", "thickness (µm)", "time / s", "force_kN" or a bare name."""
    text = heading.strip().strip('"')
    bracketed = re.fullmatch(r"(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]", text)
    if bracketed:
        return bracketed[1].strip(), bracketed[2].strip() or None
    divided = re.fullmatch(r"(.+?)\s*/\s*(\S+)", text)
    if divided:
        return divided[1], divided[2]
    name, separator, last = text.rpartition("_")
    if separator and any(last.lower() in quantity.factors for quantity in QUANTITIES.values()):
        return name, last
    return text, None


def find_quantity(name: str, unit: str | None = None) -> Quantity | None:
    """The quantity a column name stands for, with a unit that tells t from T; None for a column of another kind."""
    plain = re.sub(r"[\s_-]+", " ", name).strip().lower()
    named = [quantity for quantity in QUANTITIES.values() if plain in (quantity.name, *quantity.aliases)]
    held = [quantity for quantity in QUANTITIES.values() if quantity.name in plain.split()]
    fitting = [quantity for quantity in named + held if unit is not None and quantity.factor(unit) is not None]
    return next(iter(fitting + named + held), None)
