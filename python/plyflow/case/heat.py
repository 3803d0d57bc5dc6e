"""The temperature of a case: one, or the course of a cycle."""

from __future__ import annotations

import math
from functools import cached_property

from plyflow.case.loads import find_load
from plyflow.case.materials import find_material
from plyflow.case.programme import LOADS
from plyflow.errors import InputError
from plyflow.law import LoadProgramme


class Heated:
    """What a case says of its temperature; see `plyflow.case.case.Case`."""

    material: str
    temperature: float
    load: str
    width: float
    extrapolate: bool

    @cached_property
    def load_programme(self) -> LoadProgramme:
        """Plate pressure over time, of a cycle with its temperature."""
        return find_load(self.load, self.width)

    def check_temperature(self) -> None:
        """Refuse a temperature twice, none, or one outside the material's table; of a cycle keep that of the start."""
        if not self.is_cycle:
            if math.isnan(self.temperature):
                raise InputError(
                    f"no temperature given, and load {self.load} has none: give --temperature, or a load file with a column "
                    "'temperature [degC]' beside the time"
                )
            find_material(self.material).at(self.temperature, self.extrapolate)
            return
        start = self.load_programme.temperatures[0]
        if not (math.isnan(self.temperature) or math.isclose(self.temperature, start, abs_tol=1e-6)):
            raise InputError(
                f"temperature {self.temperature:g} degC is given, and {self.load} has a column of temperature that starts at "
                f"{start:g} degC: leave out --temperature, or the column"
            )
        object.__setattr__(self, "temperature", start)
        for temperature in self.temperature_range:
            find_material(self.material).at(temperature, self.extrapolate)

    @property
    def is_cycle(self) -> bool:
        """Whether the load brings its own temperature over time."""
        return self.load not in LOADS and bool(self.load_programme.temperatures)

    @property
    def temperature_range(self) -> tuple[float, float]:
        """Lowest and highest temperature [degC]."""
        found = self.load_programme.temperatures if self.is_cycle else (self.temperature,)
        return min(found), max(found)

    @property
    def temperature_text(self) -> str:
        """The temperature for labels: 70 degC, or 30 to 90 degC."""
        low, high = self.temperature_range
        return f"{low:g} degC" if low == high else f"{low:g} to {high:g} degC"

    def parameters_line(self) -> str:
        """Where k, a and b come from, for the list of assumptions."""
        material = find_material(self.material)
        if not self.is_cycle:
            return f"material parameters: {material.source_of(self.temperature)}"
        return (
            f"material parameters: k, a and b follow the temperature of {self.load}, {self.temperature_text}, "
            f"{material.source_of(math.nextafter(self.temperature, math.inf))}; gamma_lock and eps_lock follow k unless set, and "
            "the lock is judged at their current values, once for all"
        )
