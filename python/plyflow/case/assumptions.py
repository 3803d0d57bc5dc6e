"""What the paper leaves open and the value taken: declared, overridable, printed with every result."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources

from plyflow.errors import InputError
from plyflow.law import bulk_lock_strain, edge_shear, lock_strain
from plyflow.law.equations import check_limit

# What the one-dimensional law takes of the assumptions; the elastic constants are the UMAT's.
LAW_ASSUMPTIONS = ("gamma_lock", "l0_over_d", "fibre_fraction_initial", "chi_ratio")


@dataclass(frozen=True)
class Assumption:
    """One assumed value: name, unit, what it is, why this value; value is not a number where it follows from k."""

    name: str
    unit: str
    meaning: str
    reason: str
    value: float = math.nan

    @property
    def equation(self) -> str:
        """The name and what it is set to."""
        unit = "" if self.unit == "-" else f" {self.unit}"
        return f"{self.name} from k" if math.isnan(self.value) else f"{self.name} = {self.value:g}{unit}"

    def __str__(self) -> str:
        return f"{self.equation}: {self.meaning}; {self.reason}"


@cache
def default_assumptions() -> dict[str, Assumption]:
    """Read the declared assumptions, by name, in the order of the data file."""
    file = resources.files("plyflow") / "data" / "assumptions.toml"
    entries = tomllib.loads(file.read_text(encoding="utf-8"))
    return {name: Assumption(name=name, **entry) for name, entry in entries.items()}


def assume(settings: Mapping[str, float], k: float | None = None) -> dict[str, Assumption]:
    """Declare the assumptions, with the values in `settings` in place of the declared ones, and what follows from k [-].

    Raises
    ------
    InputError
        A value is not a finite number, or Eq. A.1 has no solution for k.
    """
    assumed = dict(default_assumptions())
    for name, value in settings.items():
        if not math.isfinite(value):
            raise InputError(f"{name} = {value} must be a finite number")
        if name in assumed:
            assumed[name] = replace(assumed[name], value=value, reason="set for this run")
    rule, fraction = assumed["gamma_lock"], assumed["fibre_fraction_initial"].value
    if math.isnan(rule.value) and "eps_lock" in settings:
        assumed["gamma_lock"] = replace(rule, reason="not used, eps_lock is set")
    elif math.isnan(rule.value) and k is not None:
        reason = f"Eq. A.1 read with arctan, with k = {k:.6g} and V0 = {fraction:g}"
        assumed["gamma_lock"] = replace(rule, value=edge_shear(k, fraction), reason=reason)
    return assumed


def assumed_lock(settings: Mapping[str, float], k: float, h0: float, w0: float) -> float:
    """Compaction eps_lock [-] at which a ply of thickness h0 and width w0 [mm] locks: as set, else by Eq. 6.

    Raises
    ------
    InputError
        A value is outside its bounds, or Eq. A.1 has no solution for k [-].
    """
    check_limit(k, assume(settings)["chi_ratio"].value)
    assumed = assume(settings, k)
    bulk = settings.get("eps_lock_bulk", bulk_lock_strain(assumed["fibre_fraction_initial"].value))
    if "eps_lock" in settings and "gamma_lock" not in settings:
        return settings["eps_lock"]
    return settings.get("eps_lock", lock_strain(h0, w0, assumed["gamma_lock"].value, bulk))
