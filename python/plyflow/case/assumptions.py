"""What the paper leaves open and the value taken: declared, overridable, printed with every result."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources

from plyflow.errors import InputError

# What the one-dimensional law takes of the assumptions; the elastic constants are the UMAT's.
LAW_ASSUMPTIONS = ("gamma_lock", "l0_over_d", "fibre_fraction_initial", "chi_ratio")


@dataclass(frozen=True)
class Assumption:
    """One assumed value: name, value, unit, what it is, why this value."""

    name: str
    value: float
    unit: str
    meaning: str
    reason: str

    def __str__(self) -> str:
        unit = "" if self.unit == "-" else f" {self.unit}"
        return f"{self.name} = {self.value:g}{unit}: {self.meaning}; {self.reason}"


@cache
def default_assumptions() -> dict[str, Assumption]:
    """Read the declared assumptions, by name, in the order of the data file."""
    file = resources.files("plyflow") / "data" / "assumptions.toml"
    entries = tomllib.loads(file.read_text(encoding="utf-8"))
    return {name: Assumption(name=name, **entry) for name, entry in entries.items()}


def assume(settings: Mapping[str, float]) -> dict[str, Assumption]:
    """Declare the assumptions, with the values in `settings` in place of the declared ones.

    Raises
    ------
    InputError
        A value is not a finite number.
    """
    assumed = dict(default_assumptions())
    for name, value in settings.items():
        if not math.isfinite(value):
            raise InputError(f"{name} = {value} must be a finite number")
        if name in assumed:
            assumed[name] = replace(assumed[name], value=value, reason="set for this run")
    return assumed
