"""Numbers that no compaction test has: refused, with the unit in which they would be plausible."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from plyflow.errors import InputError

Unit = tuple[str, float, float]  # name, factor, shift: the number in that unit is meant to be factor * number + shift
LENGTHS: tuple[Unit, ...] = (("m", 1e3, 0.0), ("um", 1e-3, 0.0), ("cm", 10.0, 0.0), ("inch", 25.4, 0.0))


@dataclass(frozen=True)
class Usual:
    """Usual range of a quantity, both ends within it, and the units that are mistaken for its own, likeliest first."""

    what: str
    unit: str
    low: float
    high: float
    mistaken: tuple[Unit, ...]


USUAL = {
    "width": Usual("width", "mm", 2.0, 1000.0, LENGTHS),
    "ply_thickness": Usual("ply thickness", "mm", 0.02, 1.0, LENGTHS),
    "plies": Usual("plies", "plies", 1.0, 500.0, ()),
    "temperature": Usual("temperature", "degC", -30.0, 250.0, (("K", 1.0, -273.15),)),
    "pressure": Usual("largest plate pressure", "MPa", 2e-3, 20.0, ()),
    "force": Usual("largest force", "N", 0.0, 0.0, (("kN", 1e3, 0.0), ("mN", 1e-3, 0.0), ("kgf", 9.80665, 0.0))),
    "duration": Usual("length of the test", "s", 30.0, 1e6, (("min", 60.0, 0.0), ("h", 3600.0, 0.0), ("ms", 1e-3, 0.0))),
}


def check_usual(name: str, value: float, where: str, told: str = "") -> None:
    """Refuse a number outside its usual range, with the likely unit.

    Parameters
    ----------
    name : one of `USUAL`.
    value : in the unit of the quantity.
    where : file, for the message.
    told : what follows the number in the message.

    Raises
    ------
    InputError
        It is outside.
    """
    usual = USUAL[name]
    if usual.low <= value <= usual.high:
        return
    asked = likely_unit(value, usual.low, usual.high, usual.unit, usual.mistaken)
    raise InputError(
        f"{where}: {usual.what} {value:g} {usual.unit}{told} is outside {usual.low:g} to {usual.high:g} {usual.unit}, what tests "
        f"have: {asked}correct it, or say with --unusual that it is meant"
    )


def likely_unit(value: float, low: float, high: float, own: str, mistaken: Sequence[Unit]) -> str:
    """The question whether another unit is meant; empty if none would bring the number into the range."""
    for unit, factor, shift in mistaken:
        meant = factor * value + shift
        if low <= meant <= high:
            return f"is it in {unit}? {value:g} {unit} are {meant:g} {own}; "
    return ""


def check_pressure(force: float, width: float, where: str) -> None:
    """Refuse a largest force [N] whose pressure on width x width [mm2] no test has; see `check_usual`."""
    usual, area = USUAL["pressure"], width * width
    if usual.low <= force / area <= usual.high:
        return
    asked = likely_unit(force, usual.low * area, usual.high * area, "N", USUAL["force"].mistaken)
    raise InputError(
        f"{where}: largest force {force:g} N on {width:g} x {width:g} mm is {force / area:.3g} MPa, outside {usual.low:g} to "
        f"{usual.high:g} MPa, what tests have: {asked}correct it, or say with --unusual that it is meant"
    )
