"""One case of the one-dimensional law: material, temperature, geometry and the constants that follow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from plyflow.case.assumptions import LAW_ASSUMPTIONS, assume
from plyflow.case.case import Case, law_parameters, property_values
from plyflow.case.materials import find_material
from plyflow.case.programme import layup_text, paper_programme, plies_in_block
from plyflow.errors import InputError
from plyflow.law import LawParameters
from plyflow.wording import count_text

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

    `extrapolate` allows a temperature outside the material's table; plies: of the whole specimen, default the paper's.

    Raises
    ------
    InputError
        As `plyflow.case.case.Case`, and for a setting the law does not have.
    """

    material: str
    temperature: float
    layup: str
    width: float
    settings: Mapping[str, float] = field(default_factory=dict)
    extrapolate: bool = False
    plies: int | None = None

    def __post_init__(self) -> None:
        checked = self._case()
        object.__setattr__(self, "material", checked.material)
        object.__setattr__(self, "layup", checked.layup)
        if self.plies is not None and self.plies < 1:
            raise InputError(f"plies = {self.plies} must be at least 1: it is the number of plies of the specimen")
        block = plies_in_block(self.layup)
        if self.plies is not None and self.plies % block:
            raise InputError(
                f"{count_text(self.plies, 'ply', 'plies')} are no whole number of blocks of {block}; "
                f"give a multiple of {block}"
            )

    @property
    def label(self) -> str:
        """Short name, for tables and messages."""
        return f"{self.material} {self.temperature:g} degC {layup_text(self.layup)} {self.width:g} mm"

    @property
    def ply_thickness(self) -> float:
        """Thickness of one ply [mm]: the material's, or of a block set for this run."""
        return self.settings.get("h0", block_thickness(self.material, self.layup)) / plies_in_block(self.layup)

    def law(self) -> LawParameters:
        """Constants of the law.

        Raises
        ------
        InputError
            Temperature outside the table, unknown setting, a value outside its bounds.
        """
        return law_parameters(property_values(self._case(), LAW_MANIFEST))

    def assumption_lines(self) -> list[str]:
        """List what a result of this case rests on, one sentence each."""
        declared = assume(self.settings)
        h0 = self.settings.get("h0", block_thickness(self.material, self.layup))
        changed = ", ".join(f"{name} = {value:g}" for name, value in self.settings.items())
        return [
            *(str(declared[name]) for name in LAW_ASSUMPTIONS),
            f"material parameters: {find_material(self.material).source_of(self.temperature)}",
            f"{layup_text(self.layup)}: a block of equal plies acts as one ply of {h0:g} mm; {self._blocks_text()}",
            "plate pressure = force / (width x width), plate area constant; eps_lock by Eq. 6 unless set",
            *([f"set by the user: {changed}"] if changed else []),
        ]

    def stack_thickness(self, h0: float) -> float:
        """Thickness [mm] of the whole specimen whose blocks are h0 [mm] thick."""
        return block_count(self.layup, self.plies) * h0

    def _blocks_text(self) -> str:
        blocks = block_count(self.layup, self.plies)
        if blocks == int(blocks):
            return count_text(int(blocks), "block", "blocks")
        return f"{paper_programme().plies} plies are {blocks:g} blocks (no whole number: give the plies of the specimen)"

    def _case(self) -> Case:
        return Case(
            self.material,
            self.temperature,
            self.layup,
            self.width,
            settings=self.settings,
            extrapolate=self.extrapolate,
        )


def block_count(layup: str, plies: int | None = None) -> float:
    """Number of blocks of equal plies in a specimen, by default of the paper's 16 plies."""
    return (paper_programme().plies if plies is None else plies) / plies_in_block(layup)


def block_thickness(material: str, layup: str) -> float:
    """Thickness [mm] of a block of equal plies of a material."""
    return find_material(material).ply_thickness * plies_in_block(layup)
