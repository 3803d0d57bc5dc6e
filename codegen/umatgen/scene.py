"""A scene: what the generated UMAT keeps. Frozen and validated; everything not kept is left out of the source."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from difflib import get_close_matches
from importlib import resources
from itertools import pairwise
from typing import Any


class SceneError(ValueError):
    """A scene asks for something that is not known or does not fit together."""


@dataclass(frozen=True)
class Scene:
    """Description of one UMAT.

    Parameters
    ----------
    name : name of the scene, of the file and (prefixed with pf_) of every procedure in it.
    regimes : flow stages kept: "both", "squeeze" or "bleed"; a state of the other stage is refused.
    after_lock : "free" (the bleed law alone) or "held" (no wider than at the lock: the paper's "no further transverse expansion",
        as a one-sided penalty).
    elastic : whether the elastic potential of Eq. 10 is kept.
    stress_state : "3d" (NTENS = 6) or "plane" (plane strain, generalised plane strain, axisymmetric: NTENS = 4).
    fibre, normal : material axes of the fibre and of the ply normal, the compaction direction: "1", "2", "3", or "free"
        (appends n1, n2, n3 and m1, m2, m3 to PROPS).
    compaction : what counts as compaction: "normal" (stretch of the thickness along the ply normal), "smallest" (smallest
        transverse stretch) or "printed" (Eqs. 13-14 in I1 and I3 as printed: not real in general states).
    tangent : "consistent" (everything differentiated, not symmetric), "paper" (Eq. 16 as meant, f frozen)
        "symmetric" (symmetric part of the consistent one) or "none" (stress only, DDSDDE is not touched).
    incompressibility : "penalty", "augmented" (pressure carried over in a state variable) or "none"
        (the host enforces J = 1, or the material may change its volume).
    integrator : "creep" (the power mean of the viscosity over the strain path of the increment: exact for creep under constant
        load, of second order else; keeps the last mean stress in STATEV) or "bdf1" (the paper's backward difference).
    first_tangent : tangent at vanishing rate: "last_rate" (the secant viscosity at the last converged rate, so that a
        first iteration without extrapolation lands near the solution) or "floor" (that of the rate floor).
    energies : whether SSE, SCD and the dissipation are computed.
    outputs : state variables: "full", or "minimal" (only those the law itself needs).
    checks : whether constants, time increment, start state and the finiteness of the stress are checked; J > 0 and the
        compaction limit at the end always are.
    baked : material constants by manifest name that are written into the source in place of PROPS; all or none.
    table : k, a, b_squeeze and b_bleed over temperature in place of those PROPS: (name, values) pairs with "temperature" [degC]
        first. The UMAT interpolates at TEMP + DTEMP as `umatgen.model.temperature` does, and fills DDSDDT.
    procedures : "internal" (inside the point routine, so that compilers inline them) or "external" (each stage a symbol of
        its own that a test or an audit can call; the same text otherwise).
    form : "fixed" (plain fixed form of 72 columns, also valid where a site extends lines to 132, as Abaqus does by default) or
        "free" (free form, NAME.f90).
    include : "none" (self-contained) or "aba_param" (the line INCLUDE 'ABA_PARAM.INC' in UMAT, for sites that ask for it).
    entry : name of the routine with the 37 arguments; two scenes in one executable need two names and a UMAT that calls them.
    fibre_fraction : fibre volume fraction V0 of the undeformed ply, for the state variable of that name.

    Raises
    ------
    SceneError
        Names the field, the value, what is allowed.
    """

    name: str = "default"
    regimes: str = "both"
    after_lock: str = "free"
    elastic: bool = True
    stress_state: str = "3d"
    fibre: str = "1"
    normal: str = "3"
    compaction: str = "normal"
    tangent: str = "consistent"
    incompressibility: str = "penalty"
    integrator: str = "creep"
    first_tangent: str = "last_rate"
    energies: bool = True
    outputs: str = "full"
    checks: bool = True
    baked: tuple[tuple[str, float], ...] = ()
    table: tuple[tuple[str, tuple[float, ...]], ...] = ()
    procedures: str = "internal"
    form: str = "fixed"
    include: str = "none"
    entry: str = "UMAT"
    fibre_fraction: float = 0.5

    def __post_init__(self) -> None:
        if not re.fullmatch(r"[a-z][a-z0-9_]{0,11}", self.name):
            raise SceneError(
                f"scene name '{self.name}': use a lower-case letter followed by at most 11 lower-case letters, digits or '_'"
            )
        if not re.fullmatch(r"[A-Z][A-Z0-9_]{0,30}", self.entry):
            raise SceneError(
                f"entry '{self.entry}': use a capital letter followed by at most 30 capital letters, digits or '_'"
            )
        for field, choices in _CHOICES.items():
            if getattr(self, field) not in choices:
                raise SceneError(f"{field} '{getattr(self, field)}' is not known; choose one of {', '.join(choices)}")
        if self.fibre == self.normal != "free":
            raise SceneError(f"normal '{self.normal}' is the fibre's axis; the ply normal is another one")
        if self.stress_state == "plane" and "free" in (self.fibre, self.normal):
            raise SceneError("stress_state 'plane' goes with a fibre and a normal along axes: a free one would leave the plane")
        if self.stress_state == "plane" and self.normal == "3":
            raise SceneError("stress_state 'plane' goes with normal '1' or '2': along axis 3 nothing can be compacted in a plane")
        if self.creep and self.compaction == "printed":
            raise SceneError("integrator 'creep' does not go with compaction 'printed'; choose integrator 'bdf1'")
        if self.holds_width and (self.regimes == "squeeze" or self.compaction != "normal"):
            other = "regimes 'squeeze'" if self.regimes == "squeeze" else f"compaction '{self.compaction}'"
            raise SceneError(f"after_lock 'held' does not go with {other}; choose after_lock 'free'")
        if self.table:
            self._check_table()
        if not 0.0 < self.fibre_fraction < 1.0:
            raise SceneError(f"fibre_fraction = {self.fibre_fraction:g} must lie in (0, 1)")

    def _check_table(self) -> None:
        columns = dict(self.table)
        if tuple(columns) != TABLE_COLUMNS:
            raise SceneError(f"table has the columns {', '.join(columns)}; it takes {', '.join(TABLE_COLUMNS)}, in this order")
        temperatures = columns["temperature"]
        for name, values in columns.items():
            if len(values) != len(temperatures) or len(values) < 2:
                raise SceneError(f"table: {name} has {len(values)} values for {len(temperatures)} temperatures; give two or more")
            if not all(math.isfinite(value) for value in values):
                raise SceneError(f"table: {name} has a value that is not finite")
        if any(later <= earlier for earlier, later in pairwise(temperatures)):
            raise SceneError("table: the temperatures must rise from each to the next")
        for name, low, high in (("k", 0.0, math.inf), ("a", -1.0, 0.0)):
            bad = [v for v in columns[name] if not (low < v <= high)]
            if bad:
                raise SceneError(f"table: {name} = {bad[0]:g} must lie in ({low:g}, {high:g}]")
        for field, fits in (("baked", not self.baked), ("tangent", self.tangent != "none"),
                            ("compaction", self.compaction != "printed"), ("integrator", not self.creep)):  # fmt: skip
            if not fits:
                raise SceneError(f"a temperature table does not go with {field} '{getattr(self, field)}'; choose the default there")

    @property
    def both_regimes(self) -> bool:
        """Whether both flow stages are kept."""
        return self.regimes == "both"

    @property
    def kept_regimes(self) -> tuple[str, ...]:
        """Flow stages kept."""
        return ("squeeze", "bleed") if self.both_regimes else (self.regimes,)

    @property
    def has_volume(self) -> bool:
        """Whether a volumetric term exists: none after locking."""
        return self.incompressibility != "none" and self.regimes != "bleed"

    @property
    def holds_width(self) -> bool:
        """Whether the ply is held at the width it has at the lock."""
        return self.after_lock == "held"

    @property
    def free(self) -> bool:
        """Whether the material frame is turned so that the fibre lies along axis 1 and the normal along axis 3."""
        return "free" in (self.fibre, self.normal)

    @property
    def axes(self) -> tuple[int, int, int]:
        """Material axes n of the fibre, t across and N of the ply normal."""
        if self.free:
            return 1, 2, 3
        fibre, normal = int(self.fibre), int(self.normal)
        return fibre, 6 - fibre - normal, normal

    @property
    def augmented(self) -> bool:
        """Whether the pressure of the constraint is carried along."""
        return self.incompressibility == "augmented" and self.has_volume

    @property
    def device(self) -> str:
        """The constraint in force before the lock: "penalty", "augmented" or "none"."""
        return self.incompressibility if self.has_volume else "none"

    @property
    def keeps_last_rate(self) -> bool:
        """Whether the tangent at vanishing rate looks back at the last rate."""
        return self.first_tangent == "last_rate" and self.tangent != "none"

    @property
    def creep(self) -> bool:
        """Whether the viscosity is averaged over the strain path and the last mean stress is carried along."""
        return self.integrator == "creep"

    @property
    def without_batch(self) -> str:
        """Why the scene has no batch routine; empty where it has one."""
        if self.compaction != "normal":
            return f"compaction '{self.compaction}' has no batch routine: points go one by one"
        return "a temperature table has no batch routine: points go one by one" if self.table else ""

    @property
    def ntens(self) -> int:
        """Number of stress components."""
        return 4 if self.stress_state == "plane" else 6

    def as_dict(self) -> dict[str, object]:
        """The scene as plain data for the manifest."""
        return asdict(self) | {
            "baked": [list(pair) for pair in self.baked],
            "table": [[name, list(values)] for name, values in self.table],
        }


_CHOICES: dict[str, tuple[str, ...]] = {
    "regimes": ("both", "squeeze", "bleed"),
    "stress_state": ("3d", "plane"),
    "fibre": ("1", "2", "3", "free"),
    "normal": ("1", "2", "3", "free"),
    "compaction": ("normal", "smallest", "printed"),
    "outputs": ("full", "minimal"),
    "tangent": ("consistent", "paper", "symmetric", "none"),
    "incompressibility": ("penalty", "augmented", "none"),
    "after_lock": ("free", "held"),
    "integrator": ("creep", "bdf1"),
    "form": ("fixed", "free"),
    "include": ("none", "aba_param"),
    "procedures": ("internal", "external"),
    "first_tangent": ("last_rate", "floor"),
}

TABLE_COLUMNS = ("temperature", "k", "a", "b_squeeze", "b_bleed")


def scene_of(name: str, entries: Mapping[str, Any]) -> Scene:
    """The scene that a table of keys describes, in the spelling of a scene file: `baked` and `table` as tables."""
    values = dict(entries)
    if "baked" in values:
        values["baked"] = tuple((key, float(value)) for key, value in values["baked"].items())
    if "table" in values:
        values["table"] = tuple((key, tuple(map(float, column))) for key, column in values["table"].items())
    return Scene(name=name, **values)


def _shipped() -> dict[str, Scene]:
    text = (resources.files("umatgen") / "scenes.toml").read_text(encoding="utf-8")
    known: dict[str, dict[str, Any]] = tomllib.loads(text)
    for name, entries in known.items():
        if "like" in entries:
            known[name] = known[entries.pop("like")] | entries
    return {name: scene_of(name, entries) for name, entries in known.items()}


SCENES = _shipped()


def scene_by_name(name: str) -> Scene:
    """The shipped scene called `name`.

    Raises
    ------
    SceneError
        Lists the shipped scenes when there is none of that name.
    """
    if name not in SCENES:
        near = get_close_matches(name, SCENES, 1)
        meant = f", did you mean '{near[0]}'?" if near else ";"
        raise SceneError(f"scene '{name}' is not known{meant} the shipped scenes are {', '.join(sorted(SCENES))}")
    return SCENES[name]
