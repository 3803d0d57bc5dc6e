"""One tested specimen: readings and what is known of its geometry."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from plyflow.case.assumptions import LAW_ASSUMPTIONS, assume, assumed_lock
from plyflow.case.loads import programme_of, pushing
from plyflow.case.materials import Material
from plyflow.case.measured_file import MeasuredFile, read_measured
from plyflow.case.programme import paper_programme, plies_in_block
from plyflow.case.quantities import QUANTITIES, Quantity
from plyflow.errors import InputError
from plyflow.identify.course import temperature_course
from plyflow.identify.force import smoothed_force
from plyflow.identify.plausible import LENGTHS, check_pressure, check_usual, likely_unit
from plyflow.law import LawParameters, LoadProgramme
from plyflow.law.equations import cell_sine

FloatArray = NDArray[np.float64]
FEWEST_READINGS = 20
DENSEST_PACKING = math.pi / (2.0 * math.sqrt(3.0))
ABOVE_START = 1.05
LARGEST_STEP = 0.05
LEAST_COMPACTION = 1e-3
TRIAL_A = -0.9
SMALLEST_K = 0.2
LOCK_SETTINGS = ("eps_lock_bulk", "eps_lock")
NUMBER_AND_UNIT = r"([+-]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eE][+-]?\d+)?)\s*(.*)"
GEOMETRY_UNITS: dict[str, Quantity | tuple[str, ...]] = {
    "width": QUANTITIES["thickness"],
    "ply_thickness": QUANTITIES["thickness"],
    "temperature": QUANTITIES["temperature"],
    "plies": ("plies",),
    "plies_per_block": ("plies",),
}


@dataclass(frozen=True)
class Geometry:
    """What the readings do not say: width [mm], plies, plies per block, ply thickness [mm], temperature [degC]."""

    width: float
    plies: float
    plies_per_block: float
    ply_thickness: float
    temperature: float

    @property
    def h0(self) -> float:
        """Thickness [mm] of a block of equal plies."""
        return self.plies_per_block * self.ply_thickness

    @property
    def stack(self) -> float:
        """Thickness [mm] of the specimen before the test."""
        return self.plies * self.ply_thickness


@dataclass(frozen=True)
class Specimen:
    """Readings of a test.

    time (n,) [s]; thickness (n,) [mm] of the whole specimen; width (n,) [mm] of a block, if measured; load: the
    measured force as plate pressure, with the temperature where it changes; l0_over_d and chi_ratio [-]: assumptions (Eq. 5);
    notes on the file; settings: assumptions by name as the user set them; like: the material by whose table the parameters
    follow a temperature that changes, away from that of the geometry.
    """

    name: str
    material: str
    geometry: Geometry
    time: FloatArray
    thickness: FloatArray
    width: FloatArray | None
    load: LoadProgramme
    l0_over_d: float
    chi_ratio: float
    notes: tuple[str, ...] = ()
    settings: Mapping[str, float] = field(default_factory=dict)
    like: Material | None = None

    def eps_lock(self, k: float) -> float:
        """Compaction at locking [-], by Eq. 6 unless set; it follows k [-] through gamma_lock, up to `largest_k`."""
        return assumed_lock(self.settings, min(k, self.largest_k), self.geometry.h0, self.geometry.width)

    def assumptions(self, k: float) -> list[str]:
        """What the law of this specimen assumes with a k [-], in words."""
        return [str(entry) for name, entry in assume(self.settings, k).items() if name in LAW_ASSUMPTIONS]

    @cached_property
    def largest_k(self) -> float:
        """Bound of k [-]: from there the compaction limit comes before the lock, or Eq. A.1 has no solution."""
        largest = (1.0 - 1e-9) / math.sqrt(self.chi_ratio)
        fraction = assume(self.settings)["fibre_fraction_initial"].value
        if {"gamma_lock", "eps_lock"} & set(self.settings) or cell_sine(largest, fraction) <= 1.0:
            return largest
        return (1.0 - 1e-9) * float(brentq(lambda k: cell_sine(k, fraction) - 1.0, 0.0, largest))

    def k_of_limit(self, eps: float) -> float:
        """The k [-] whose compaction limit is at eps [-], from `SMALLEST_K` to `largest_k`."""

        def beyond(k: float) -> float:
            return math.log(k) + 0.5 * math.log(self.chi_ratio) + self.eps_lock(k) - eps

        if beyond(self.largest_k) <= 0.0:
            return self.largest_k
        return float(brentq(beyond, SMALLEST_K, self.largest_k, xtol=1e-15)) if beyond(SMALLEST_K) < 0.0 else SMALLEST_K

    @property
    def eps(self) -> FloatArray:
        """Compaction (n,) [-]."""
        return np.asarray(np.log(self.thickness / self.geometry.stack), dtype=float)

    @property
    def pressure(self) -> FloatArray:
        """Plate pressure (n,) [MPa] at the readings."""
        return self.load.pressure(self.time)

    @property
    def resolved(self) -> NDArray[np.bool_]:
        """Which readings (n,) are compared with the law: not the one at the end of a jump of the load.

        How the load rose between the two readings around a jump is not known, and the ply yields within a part of it.
        """
        steps = np.diff(self.pressure, prepend=self.pressure[0])
        return np.asarray(np.abs(steps) <= LARGEST_STEP * self.load.peak)


def trial_law(geometry: Geometry, eps_lock: float, l0_over_d: float, chi_ratio: float, k: float) -> LawParameters:
    """The law of a specimen with a given k, `TRIAL_A` and b = 0.

    Raises
    ------
    InputError
        A constant out of its bounds.
    """
    fixed = {"w0": geometry.width, "h0": geometry.h0, "a": TRIAL_A, "b_squeeze": 0.0, "b_bleed": 0.0}
    return LawParameters(**fixed, k=k, eps_lock=eps_lock, l0_over_d=l0_over_d, chi_ratio=chi_ratio)


def names_of(specimens: Sequence[Specimen]) -> str:
    """Names of the tests, for messages."""
    return ", ".join(specimen.name for specimen in specimens)


@dataclass(frozen=True)
class Reading:
    """How files are read: numbers out of the usual are meant; faulty rows are left out; the material of `Specimen.like`."""

    unusual: bool = False
    skip_bad_rows: bool = False
    like: str | None = None


def read_specimen(
    path: Path, given: Mapping[str, float | str], settings: Mapping[str, float], reading: Reading = Reading()
) -> Specimen:
    """Read a test.

    Parameters
    ----------
    path : Path
        Columns time, force, thickness and, if measured, width and temperature. Comments of the form "name: value" may give layup (or
        plies per block), plies, width, ply thickness, temperature and material.
    given : mapping
        The same by name (layup, plies_per_block, plies, width, ply_thickness, temperature, material); these win.
    settings : mapping
        Assumptions by name; see `plyflow.case.assumptions`.
    reading : Reading
        Choices.

    Raises
    ------
    InputError
        As `read_measured`; geometry missing or impossible; too few readings, force pulling, thickness outside what is
        possible, with the line.
    """
    for name in settings:
        if name not in (*LAW_ASSUMPTIONS, *LOCK_SETTINGS):
            known = ", ".join((*LAW_ASSUMPTIONS, *LOCK_SETTINGS))
            raise InputError(f"--set {name}: identify knows the assumptions {known}; k, a and b are what it fits")
    measured = read_measured(path, ["time", "force", "thickness"], ["width", "temperature"], reading.skip_bad_rows)
    entries = {name: value for name, (value, _) in measured.entries.items()} | {
        name: str(value) for name, value in given.items()
    }
    course = temperature_course(measured, entries, reading.like)
    entries |= {} if course is None else {"temperature": f"{course.reference!r}"}
    geometry = _geometry(measured, entries)
    assumed = {name: entry.value for name, entry in assume(settings).items()}
    deepest = assumed_lock(settings, SMALLEST_K, geometry.h0, geometry.width)  # of any k
    lock = deepest, assumed["l0_over_d"], assumed["chi_ratio"]
    trial_law(geometry, *lock, k=0.5 / math.sqrt(max(lock[2], 0.0) or 1.0))  # has the bounds of the constants checked
    if not reading.unusual:
        for name in ("width", "ply_thickness", "plies", "temperature"):
            check_usual(name, getattr(geometry, name), str(path))
    _check_readings(measured, geometry, assumed["fibre_fraction_initial"] * math.exp(deepest) / DENSEST_PACKING)
    if not reading.unusual:
        check_pressure(float(measured.columns["force"].max()), geometry.width, str(path))
        check_usual("duration", float(measured.columns["time"][-1]), str(path))
    smooth = smoothed_force(measured.columns["time"], measured.columns["force"])
    pressures = np.maximum(smooth, 0.0) / geometry.width**2
    return Specimen(
        name=path.stem,
        material=entries.get("material", ""),
        geometry=geometry,
        time=measured.columns["time"],
        thickness=measured.columns["thickness"],
        width=measured.columns.get("width"),
        load=programme_of(measured, pressures, None if course is None or course.like is None else course.smooth),
        l0_over_d=assumed["l0_over_d"],
        chi_ratio=assumed["chi_ratio"],
        notes=(*measured.notes, *([] if course is None else [course.note])),
        settings=dict(settings),
        like=None if course is None else course.like,
    )


def _geometry(measured: MeasuredFile, entries: Mapping[str, str]) -> Geometry:
    per_block = _plies_per_block(measured, entries)
    plies = _value(measured, entries, "plies") if "plies" in entries else float(paper_programme().plies)
    width, ply_thickness = (_value(measured, entries, name) for name in ("width", "ply_thickness"))
    geometry = Geometry(width, plies, per_block, ply_thickness, _value(measured, entries, "temperature"))
    for name, value in vars(geometry).items():
        if name != "temperature" and not (math.isfinite(value) and value > 0.0):
            raise InputError(f"{measured.path}: {name} = {value:g} must be a finite number above 0")
    return geometry


def _plies_per_block(measured: MeasuredFile, entries: Mapping[str, str]) -> float:
    if "plies_per_block" in entries:
        return _value(measured, entries, "plies_per_block")
    layup = entries.get("layup", "")
    try:
        return float(plies_in_block(layup))
    except InputError as error:
        known = ", ".join(paper_programme().plies_per_block)
        found = f"layup '{layup}' is not known" if layup else "no layup given"
        raise InputError(
            f"{measured.path}: {found}: write '# layup: CP' into the file or give --layup, one of {known} or the number "
            "of equal plies in a block"
        ) from error


def _value(measured: MeasuredFile, entries: Mapping[str, str], name: str) -> float:
    """A number of the entries in mm, degC or plies."""
    words = name.replace("_", " ")
    if name not in entries:
        option = "--" + name.replace("_", "-")
        raise InputError(f"{measured.path}: no {words} given: write '# {words}: VALUE' into the file or give {option}")
    place = f"{measured.path}, line {measured.entries[name][1]}" if name in measured.entries else str(measured.path)
    found = re.fullmatch(NUMBER_AND_UNIT, entries[name].strip())
    if found is None:
        raise InputError(f"{place}: {words} '{entries[name]}' is not a number")
    units = GEOMETRY_UNITS[name]
    factor = units.factor(found[2]) if isinstance(units, Quantity) else 1.0 if found[2].lower() in units else None
    if found[2] and factor is None:
        known = ", ".join(units.factors if isinstance(units, Quantity) else units)
        raise InputError(f"{place}: unknown unit '{found[2]}' of {words}: use {known or 'none'}")
    shift = units.shift(found[2]) if isinstance(units, Quantity) else 0.0
    return float(found[1].replace(",", ".")) * (1.0 if factor is None else factor) + shift


def _check_readings(measured: MeasuredFile, geometry: Geometry, least: float) -> None:
    times, force, thickness = (measured.columns[name] for name in ("time", "force", "thickness"))
    if times.size < FEWEST_READINGS:
        raise measured.error(
            times.size - 1, f"the file ends after {times.size} readings: at least {FEWEST_READINGS} are needed"
        )
    if not np.any(force > 0.0):
        raise measured.error(0, "no reading of force is above 0: is the sign reversed?")
    pushing(measured, "force")
    low, high = least * geometry.stack, ABOVE_START * geometry.stack
    outside = np.flatnonzero((thickness < low) | (thickness > high))
    if outside.size:
        row = int(outside[0])
        raise measured.error(
            row,
            f"thickness {thickness[row]:g} mm is outside {low:.4g} to {high:.4g} mm, from the densest packing of the "
            f"fibres to 5 % above {geometry.plies:g} plies of {geometry.ply_thickness:g} mm: "
            f"{likely_unit(float(np.median(thickness)), low, high, 'mm', LENGTHS)}check unit and geometry"
            + (f" ({outside.size} readings are outside)" if outside.size > 1 else ""),
        )
    last = float(np.mean(thickness[-max(thickness.size // 20, 1) :]))
    if last > (1.0 - LEAST_COMPACTION) * geometry.stack:
        raise measured.error(
            thickness.size - 1,
            f"the thickness ends at {last:g} mm, and {geometry.plies:g} plies of {geometry.ply_thickness:g} mm are "
            f"{geometry.stack:g} mm before the test: nothing to fit below {LEAST_COMPACTION:.1%} of compaction; check the "
            "zero of the thickness and the geometry",
        )
