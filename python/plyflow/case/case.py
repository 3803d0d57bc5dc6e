"""One specimen under one load: what the UMAT, the driver and the one-dimensional law need.

A block of n equal plies acts as one ply of n times the thickness. The fibre (axis 1) is inextensible, the
edge (axis 2) free, the plate presses along axis 3, shears are held at zero.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any

from plyflow.case.assumptions import LAW_ASSUMPTIONS, Assumption, assume, assumed_lock, default_assumptions
from plyflow.case.heat import Heated
from plyflow.case.loads import load_line
from plyflow.case.materials import find_material, known_materials
from plyflow.case.programme import LOADS, layup_text, paper_programme, plies_in_block
from plyflow.case.scene_fit import check_scene
from plyflow.driver.drive import Kind, Step
from plyflow.errors import InputError
from plyflow.law import LawBatch, LawParameters, LoadProgramme, batch
from plyflow.wording import count_text, known_text

Manifest = Mapping[str, Any]
PLY_KINDS: dict[str, Kind] = {"11": "F", "22": "S", "33": "P", "12": "F", "13": "F", "23": "F"}
NARROWEST, WIDEST = 1e-3, 1e6  # mm
EXTRA_SETTINGS = ("eps_lock_bulk",)
LAW_NAMES = tuple(entry.name for entry in fields(LawParameters))
# What `property_values` asks of a scene, reduced to the constants of the law.
LAW_MANIFEST: Manifest = {
    "name": "the one-dimensional law",
    "scene": {},
    "props": [{"name": name} for name in LAW_NAMES],
    "defaults": dict.fromkeys(LAW_NAMES, 0.0),
}
NUMERICS = {"kappa": " MPa", "rate_floor": " 1/s", "strain_floor": ""}


@dataclass(frozen=True)
class Case(Heated):
    """Material (name or file), temperature [degC], layup, width [mm], load; values set by the user.

    The layup is CP, SB, BP or the number of equal plies in a block; the load is ramp-dwell, monotonic or a file of force
    or pressure over time (`plyflow.case.loads`). `settings` replaces assumptions and constants by name;
    see `setting_names`. `extrapolate` allows a temperature outside the material's table. `plies` is the number of plies
    of the whole specimen, by default the paper's. A load file with a temperature beside the time is a cycle: its
    temperatures replace the case's, which is not a number then, or the one at the start.

    Raises
    ------
    InputError
        Unknown material, layup or load, temperature outside the material's table unless extrapolated, width not above 0,
        plies that are no whole number of blocks.
    """

    material: str
    temperature: float
    layup: str
    width: float
    load: str = "ramp-dwell"
    settings: Mapping[str, float] = field(default_factory=dict)
    extrapolate: bool = False
    plies: int | None = None

    def __post_init__(self) -> None:
        material = find_material(self.material)
        if material is known_materials().get(material.name):
            object.__setattr__(self, "material", material.name)
        object.__setattr__(self, "layup", self.layup.upper())
        block = plies_in_block(self.layup)
        if not (math.isfinite(self.width) and self.width > 0.0):
            raise InputError(f"width {self.width:g} mm must be a finite number above 0")
        if not NARROWEST <= self.width <= WIDEST:
            raise InputError(f"width {self.width:g} mm must be from {NARROWEST:g} to {WIDEST:g} mm, that of a specimen")
        if self.plies is not None and self.plies < 1:
            raise InputError(f"plies = {self.plies} must be at least 1: it is the number of plies of the specimen")
        if self.plies is not None and self.plies % block:
            raise InputError(
                f"{count_text(self.plies, 'ply', 'plies')} are no whole number of blocks of {block}; give a multiple of {block}"
            )
        if self.load.lower() in LOADS:
            object.__setattr__(self, "load", self.load.lower())
        else:
            _ = self.load_programme
        self.check_temperature()

    @property
    def specimen(self) -> str:
        """Short name of the specimen, for tables and messages."""
        return f"{self.material} {self.temperature_text} {layup_text(self.layup)} {self.width:g} mm"

    @property
    def label(self) -> str:
        """Short name of the specimen and its load."""
        return f"{self.specimen} {self.load}"

    @property
    def block_thickness(self) -> float:
        """Thickness h0 [mm] of the block of equal plies that acts as one ply: the material's, or set for this run."""
        given = plies_in_block(self.layup) * find_material(self.material).ply_thickness
        return self.settings.get("h0", given)

    @property
    def ply_thickness(self) -> float:
        """Thickness of one ply [mm]."""
        return self.block_thickness / plies_in_block(self.layup)

    @property
    def blocks(self) -> float:
        """Number of blocks of equal plies in the specimen."""
        return (paper_programme().plies if self.plies is None else self.plies) / plies_in_block(self.layup)

    def assumed(self) -> dict[str, Assumption]:
        """The assumptions of this case by name; gamma_lock from its own k unless set."""
        own = None if self.is_cycle else find_material(self.material).at(self.temperature, self.extrapolate).k
        return assume(self.settings, self.settings.get("k", own))

    @property
    def fibre_fraction(self) -> float:
        """Fibre volume fraction V0 [-] of the debulked stack."""
        return assume(self.settings)["fibre_fraction_initial"].value

    def law(self) -> LawParameters:
        """Constants of the one-dimensional law.

        Raises
        ------
        InputError
            A setting the law does not have, a value outside its bounds; a cycle, which has as many laws as temperatures.
        """
        return law_parameters(property_values(self, LAW_MANIFEST))

    @property
    def of_law(self) -> Case:
        """The case with those settings only that the one-dimensional law has: a UMAT has more constants."""
        known = setting_names(LAW_MANIFEST)
        return replace(self, settings={name: value for name, value in self.settings.items() if name in known})

    def laws_at(self, temperatures: Iterable[float]) -> LawBatch:
        """Constants (t,) of the law at temperatures (t,) [degC], eps_lock by the k of each; see `law`."""
        return batch([law_parameters(_values_at(self, LAW_MANIFEST, float(one))) for one in temperatures])

    def law_assumptions(self) -> list[str]:
        """List what a result of the one-dimensional law rests on, one sentence each."""
        declared = self.assumed()
        return [
            *(str(declared[name]) for name in LAW_ASSUMPTIONS),
            self.parameters_line(),
            f"{self._block_line(self.block_thickness)}; {self._blocks_text()}",
            "plate pressure = force / (width x width), plate area constant; eps_lock by Eq. 6 unless set",
            *self._set_by_user(),
        ]

    def _block_line(self, h0: float) -> str:
        return f"{layup_text(self.layup)}: a block of equal plies acts as one ply of {h0:g} mm"

    def _blocks_text(self) -> str:
        if self.blocks == int(self.blocks):
            return count_text(int(self.blocks), "block", "blocks")
        plies = paper_programme().plies
        return f"{plies} plies are {self.blocks:g} blocks (no whole number: give the plies of the specimen)"

    def _set_by_user(self) -> list[str]:
        changed = ", ".join(f"{name} = {value:g}" for name, value in self.settings.items())
        return [f"set by the user: {changed}"] if changed else []


def all_cases(load: str = "ramp-dwell") -> list[Case]:
    """List the whole programme: 2 materials x 7 temperatures x 3 layups x 2 widths = 84 cases."""
    programme = paper_programme()
    return [
        Case(name, temperature, layup, specimen.width, load)
        for name, material in known_materials().items()
        for specimen in programme.specimen
        for layup in programme.plies_per_block
        for temperature in material.table.temperature
    ]


def setting_names(manifest: Manifest) -> list[str]:
    """Names that `Case.settings` may hold: assumptions and the PROPS of the scene."""
    props = [entry["name"] for entry in manifest["props"]]
    return list(dict.fromkeys([*default_assumptions(), *EXTRA_SETTINGS, *props]))


def property_values(case: Case, manifest: Manifest, follows: bool = False) -> dict[str, float]:
    """Every PROPS of the scene by name, for one case.

    Later sources win: the manifest's default, the assumptions, the case, the user's settings. A caller that passes the
    temperature of a cycle on says so by `follows`; eps_lock is then 0, for the UMAT to take it from the k of the temperature.

    Raises
    ------
    InputError
        Unknown setting, a value outside its bounds, a scene made for another case; a cycle where nobody follows it.
    """
    if case.is_cycle and not follows:
        raise InputError(
            f"{case.load} has a column of temperature, and this calculation takes one temperature: leave the column out and "
            "give --temperature; law1d, run and sweep follow a cycle"
        )
    values = _values_at(case, manifest, case.temperature)
    law_parameters(values)
    check_scene(values, case.temperature, manifest)
    if case.is_cycle:
        _check_cycle(case, manifest)
        if "eps_lock_bulk" in case.settings:
            raise InputError(f"eps_lock_bulk is set and {case.load} is a cycle: a UMAT takes that of V0 there; use law1d")
        values |= {} if {"eps_lock", "gamma_lock"} & set(case.settings) else {"eps_lock": 0.0}
    return values


def _check_cycle(case: Case, manifest: Manifest) -> None:
    """Refuse a cycle whose scene has no table, or another one."""
    if not manifest["scene"].get("table"):
        raise InputError(
            f"scene '{manifest['name']}' has one k, a and b, and {case.load} goes from {case.temperature_text}: choose the scene "
            f"table:{case.material}"
        )
    low, high = case.temperature_range
    columns = find_material(case.material).table.temperature
    for one in (low, *(temperature for temperature in columns if low < temperature < high), high):
        values = _values_at(case, manifest, one)
        law_parameters(values)
        check_scene(values, one, manifest)


def _values_at(case: Case, manifest: Manifest, temperature: float) -> dict[str, float]:
    """PROPS by name at a temperature [degC]."""
    known = setting_names(manifest)
    for name in case.settings:
        if name not in known:
            raise InputError(f"unknown parameter '{name}'{known_text(name, known)}")
    assumed = {name: entry.value for name, entry in assume(case.settings).items()}
    w0, h0 = case.settings.get("w0", case.width), case.block_thickness
    from_case = vars(find_material(case.material).at(temperature, case.extrapolate)) | {"w0": w0, "h0": h0}
    from_case["eps_lock"] = assumed_lock(case.settings, case.settings.get("k", from_case["k"]), h0, w0)
    values = {name: float(value) for name, value in manifest["defaults"].items()}
    values |= {name: value for name, value in assumed.items() if name in values} | from_case
    return values | {name: value for name, value in case.settings.items() if name in values}


def props_vector(values: Mapping[str, float], manifest: Manifest) -> list[float]:
    """Put the PROPS in the scene's order."""
    ordered = sorted(manifest["props"], key=lambda entry: int(entry["index"]))
    return [values[entry["name"]] for entry in ordered]


def state_place(manifest: Manifest, name: str) -> int:
    """Place of a state variable in STATEV, counted from 0."""
    return [entry["name"] for entry in manifest["statev"]].index(name)


def law_parameters(values: Mapping[str, float]) -> LawParameters:
    """Constants of the one-dimensional law, taken from the same values as the PROPS."""
    return LawParameters(**{name: values[name] for name in LAW_NAMES})


def driver_steps(load: LoadProgramme) -> list[Step]:
    """One driver step for each linear piece of the load: F11 = 1, S22 = 0, pressure along 3, no shear; TEMP of a cycle."""
    steps = []
    for place, (begin, end, _, pressure) in enumerate(load.pieces(), start=1):
        targets = {"11": 1.0, "22": 0.0, "33": pressure, "12": 0.0, "13": 0.0, "23": 0.0}
        temperature = load.temperatures[place] if load.temperatures else None
        steps.append(Step(duration=end - begin, targets=targets, kinds=PLY_KINDS, temperature=temperature))
    return steps


def assumption_lines(case: Case, values: Mapping[str, float]) -> list[str]:
    """List what a result of the UMAT in this case rests on, one sentence each."""
    lock = "Eq. 6"
    if "eps_lock" in case.settings:
        lock = "set for this run"
    elif "eps_lock_bulk" in case.settings:
        lock = f"Eq. 6 with eps_lock_bulk = {case.settings['eps_lock_bulk']:g} set for this run"
    return [
        *(str(entry) for entry in case.assumed().values()),
        "eps_lock: compaction at locking, by Eqs. A.1 and 6 from the k of each temperature"
        if values["eps_lock"] == 0.0
        else f"eps_lock = {values['eps_lock']:.6g}: compaction at locking, {lock}",
        *(
            f"{name} = {values[name]:g}{unit}: numerical parameter of the scene, "
            f"{'set for this run' if name in case.settings else 'its default'}"
            for name, unit in NUMERICS.items()
            if name in values
        ),
        case.parameters_line(),
        case._block_line(values["h0"]),
        "plate pressure = force / (width x width), plate area constant; fibre inextensible, edge free",
        load_line(case.load, case.width),
        *case.load_programme.notes,
        *case._set_by_user(),
    ]
