"""One case of the compaction programme: what the UMAT, the driver and the one-dimensional law need.

A block of n equal plies acts as one ply of n times the thickness. The fibre (axis 1) is inextensible, the
edge (axis 2) free, the plate presses along axis 3, shears are held at zero.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from plyflow.case.assumptions import assume, default_assumptions
from plyflow.case.loads import find_load
from plyflow.case.materials import find_material, known_materials
from plyflow.case.materials_table import monotone_cubic
from plyflow.case.programme import LOADS, layup_text, paper_programme, plies_in_block
from plyflow.driver.drive import Kind, Step
from plyflow.errors import InputError
from plyflow.law import LawParameters, LoadProgramme, bulk_lock_strain, lock_strain
from plyflow.wording import known_text

Manifest = Mapping[str, Any]
PLY_KINDS: dict[str, Kind] = {"11": "F", "22": "S", "33": "P", "12": "F", "13": "F", "23": "F"}
EXTRA_SETTINGS = ("eps_lock_bulk",)


@dataclass(frozen=True)
class Case:
    """Material (name or file), temperature [degC], layup, width [mm], load; values set by the user.

    The layup is CP, SB, BP or the number of equal plies in a block; the load is ramp-dwell, monotonic or a file of force
    or pressure over time (`plyflow.case.loads`). `settings` replaces assumptions and PROPS by name;
    see `setting_names`. `extrapolate` allows a temperature outside the material's table.

    Raises
    ------
    InputError
        Unknown material, layup or load, temperature outside the material's table unless extrapolated, width not above 0.
    """

    material: str
    temperature: float
    layup: str
    width: float
    load: str = "ramp-dwell"
    settings: Mapping[str, float] = field(default_factory=dict)
    extrapolate: bool = False

    def __post_init__(self) -> None:
        material = find_material(self.material)
        if material is known_materials().get(material.name):
            object.__setattr__(self, "material", material.name)
        material.at(self.temperature, self.extrapolate)
        object.__setattr__(self, "layup", self.layup.upper())
        plies_in_block(self.layup)
        if not (math.isfinite(self.width) and self.width > 0.0):
            raise InputError(f"width {self.width:g} mm must be a finite number above 0")
        if self.load.lower() in LOADS:
            object.__setattr__(self, "load", self.load.lower())
        else:
            find_load(self.load, self.width)

    @property
    def label(self) -> str:
        """Short name, for tables and messages."""
        return f"{self.material} {self.temperature:g} degC {layup_text(self.layup)} {self.width:g} mm {self.load}"

    @property
    def block_thickness(self) -> float:
        """Thickness h0 [mm] of the block of equal plies that acts as one ply."""
        return plies_in_block(self.layup) * find_material(self.material).ply_thickness

    @property
    def load_programme(self) -> LoadProgramme:
        """Plate pressure over time."""
        return find_load(self.load, self.width)


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


TABLE_TOLERANCE = 1e-9
BAKED_TOLERANCE = 1e-4  # the shipped baked scene has eps_lock to five digits


def setting_names(manifest: Manifest) -> list[str]:
    """Names that `Case.settings` may hold: assumptions and the PROPS of the scene."""
    props = [entry["name"] for entry in manifest["props"]]
    return list(dict.fromkeys([*default_assumptions(), *EXTRA_SETTINGS, *props]))


def property_values(case: Case, manifest: Manifest) -> dict[str, float]:
    """Every PROPS of the scene by name, for one case.

    Later sources win: the manifest's default, the assumptions, the case, the user's settings.

    Raises
    ------
    InputError
        Unknown material or setting, temperature outside the table, a value outside its bounds.
    """
    _check_settings(case, manifest)
    material = find_material(case.material)
    parameters = material.at(case.temperature, case.extrapolate)
    assumed = {name: entry.value for name, entry in assume(case.settings).items()}
    h0 = case.settings.get("h0", case.block_thickness)
    w0 = case.settings.get("w0", case.width)
    values = {name: float(value) for name, value in manifest["defaults"].items()}
    values.update({name: value for name, value in assumed.items() if name in values})
    values.update(vars(parameters))
    values.update(w0=w0, h0=h0)
    bulk = case.settings.get("eps_lock_bulk", bulk_lock_strain(assumed["fibre_fraction_initial"]))
    values["eps_lock"] = lock_strain(h0, w0, assumed["gamma_lock"], bulk)
    values.update({name: value for name, value in case.settings.items() if name in values})
    law_parameters(values)
    _check_scene(values, manifest)
    _check_table(values, case.temperature, manifest)
    return values


def _check_table(values: Mapping[str, float], temperature: float, manifest: Manifest) -> None:
    """Refuse a scene whose temperature table is that of another material, or ends short of the case."""
    table = dict(manifest["scene"].get("table", []))
    if not table:
        return
    low, high = table["temperature"][0], table["temperature"][-1]
    if not low <= temperature <= high:
        raise InputError(
            f"scene '{manifest['name']}' has a temperature table from {low:g} to {high:g} degC, the case wants "
            f"{temperature:g}: choose a temperature inside, or another scene"
        )
    for name in ("k", "a", "b_squeeze", "b_bleed"):
        tabled = monotone_cubic(table["temperature"], table[name]).at(temperature)
        if abs(values[name] - tabled) > TABLE_TOLERANCE * abs(tabled):
            raise InputError(
                f"scene '{manifest['name']}' has {name} = {tabled:g} at {temperature:g} degC in its temperature table, the "
                f'case wants {values[name]:g}: write a scene file with table = "MATERIAL" of this one'
            )


def _check_scene(values: Mapping[str, float], manifest: Manifest) -> None:
    """Refuse a scene that cannot carry the compaction programme, or whose baked constants are those of another case."""
    scene = manifest["scene"]
    wanted = {"regimes": "both", "fibre": "1", "stress_state": "3d"}
    for key, value in wanted.items():
        if scene.get(key, value) != value:
            raise InputError(
                f"scene '{manifest['name']}' has {key} = '{scene[key]}'; the compaction programme needs '{value}': "
                "choose another scene"
            )
    if scene.get("tangent") == "none":
        raise InputError(f"scene '{manifest['name']}' has no tangent, load control needs one: choose another scene")
    if scene.get("incompressibility") == "none":
        raise InputError(
            f"scene '{manifest['name']}' leaves J = 1 to its host, and this command solves without a multiplier: "
            "choose another scene"
        )
    for name, baked in scene.get("baked", []):
        if abs(values[name] - baked) > BAKED_TOLERANCE * abs(baked):
            raise InputError(
                f"scene '{manifest['name']}' has {name} = {baked:g} baked in, the case wants {values[name]:g}: "
                "run its own case, or write a scene file with the constants of this one"
            )


def props_vector(values: Mapping[str, float], manifest: Manifest) -> list[float]:
    """Put the PROPS in the scene's order."""
    ordered = sorted(manifest["props"], key=lambda entry: int(entry["index"]))
    return [values[entry["name"]] for entry in ordered]


def law_parameters(values: Mapping[str, float]) -> LawParameters:
    """Constants of the one-dimensional law, taken from the same values as the PROPS."""
    return LawParameters(**{name: values[name] for name in LawParameters.__dataclass_fields__})


def driver_steps(load: LoadProgramme) -> list[Step]:
    """One driver step for each linear piece of the load: F11 = 1, S22 = 0, pressure along 3, no shear."""
    steps = []
    for begin, end, _, pressure in load.pieces():
        targets = {"11": 1.0, "22": 0.0, "33": pressure, "12": 0.0, "13": 0.0, "23": 0.0}
        steps.append(Step(duration=end - begin, targets=targets, kinds=PLY_KINDS))
    return steps


def assumption_lines(case: Case, values: Mapping[str, float]) -> list[str]:
    """List what a result of this case rests on, one sentence each."""
    lines = [str(entry) for entry in assume(case.settings).values()]
    lines.append(f"eps_lock = {values['eps_lock']:.6g}: compaction at locking, {_lock_source(case)}")
    lines += _numerics(case, values, ("kappa", "rate_floor", "strain_floor"))
    lines.append(f"material parameters: {find_material(case.material).source_of(case.temperature)}")
    lines.append(f"{layup_text(case.layup)}: a block of equal plies acts as one ply of {values['h0']:g} mm")
    lines.append("plate pressure = force / (width x width), plate area constant; fibre inextensible, edge free")
    lines += _load_lines(case)
    changed = [f"{name} = {value:g}" for name, value in case.settings.items()]
    return lines + ([f"set by the user: {', '.join(changed)}"] if changed else [])


def _lock_source(case: Case) -> str:
    if "eps_lock" in case.settings:
        return "set for this run"
    if "eps_lock_bulk" in case.settings:
        return f"Eq. 6 with eps_lock_bulk = {case.settings['eps_lock_bulk']:g} set for this run"
    return "Eq. 6"


def _numerics(case: Case, values: Mapping[str, float], names: Iterable[str]) -> list[str]:
    units = {"kappa": " MPa", "rate_floor": " 1/s", "strain_floor": ""}
    return [
        f"{name} = {values[name]:g}{units[name]}: numerical parameter of the scene, "
        f"{'set for this run' if name in case.settings else 'its default'}"
        for name in names
        if name in values
    ]


def _load_lines(case: Case) -> list[str]:
    if case.load in LOADS:
        return [_programme_line(case)]
    return [f"load: straight pieces through the readings of {case.load}", *case.load_programme.notes]


def _programme_line(case: Case) -> str:
    programme = paper_programme()
    if case.width in {specimen.width for specimen in programme.specimen}:
        forces = "the paper's forces"
    else:
        forces = f"forces scaled to the baseline's pressures, the paper has no {case.width:g} mm specimen"
    if case.load == "monotonic":
        return f"load: {forces}, from 0 in {programme.total_time:g} s"
    return (
        f"load: {forces}, each level {programme.dwell_level_time:g} s including a {programme.ramp_time:g} s "
        "linear ramp from the last, the first from 0"
    )


def _check_settings(case: Case, manifest: Manifest) -> None:
    known = setting_names(manifest)
    for name in case.settings:
        if name not in known:
            raise InputError(f"unknown parameter '{name}'{known_text(name, known)}")
