"""One case of the one-dimensional law: material, temperature, geometry and the constants that follow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from plyflow.cases import Case, law_parameters, property_values
from plyflow.errors import InputError
from plyflow.law_1d import LawParameters
from plyflow.materials import find_material
from plyflow.programme import paper_programme

LAW_NAMES = tuple(entry.name for entry in fields(LawParameters))
# What `cases.property_values` asks of a scene, reduced to the constants of the law.
LAW_MANIFEST: Mapping[str, Any] = {
    "name": "the one-dimensional law",
    "scene": {},
    "props": [{"name": name} for name in LAW_NAMES],
    "defaults": dict.fromkeys(LAW_NAMES, 0.0),
}


@dataclass(frozen=True)
class LawCase:
    """Material (name or file), temperature [degC], layup, width [mm]; values set by the user by name.

    Raises
    ------
    InputError
        As `plyflow.cases.Case`, and for a setting the law does not have.
    """

    material: str
    temperature: float
    layup: str
    width: float
    settings: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        checked = Case(self.material, self.temperature, self.layup, self.width)
        object.__setattr__(self, "material", checked.material)
        object.__setattr__(self, "layup", checked.layup)

    @property
    def label(self) -> str:
        """Short name, for tables and messages."""
        return f"{self.material} {self.temperature:g} degC {self.layup} {self.width:g} mm"

    def law(self) -> LawParameters:
        """Constants of the law.

        Raises
        ------
        InputError
            Temperature outside the table, unknown setting, a value outside its bounds.
        """
        case = Case(self.material, self.temperature, self.layup, self.width, settings=self.settings)
        return law_parameters(property_values(case, LAW_MANIFEST))

    def stack_thickness(self, h0: float) -> float:
        """Thickness [mm] of the whole specimen whose blocks are h0 [mm] thick."""
        return block_count(self.layup) * h0


def block_count(layup: str) -> float:
    """Number of blocks of equal plies in a specimen of the paper's programme."""
    programme = paper_programme()
    if layup not in programme.plies_per_block:
        raise InputError(f"unknown layup '{layup}': choose one of {', '.join(programme.plies_per_block)}")
    return programme.plies / programme.plies_per_block[layup]


def block_thickness(material: str, layup: str) -> float:
    """Thickness [mm] of a block of equal plies of a material."""
    return find_material(material).ply_thickness * paper_programme().plies_per_block[layup]
