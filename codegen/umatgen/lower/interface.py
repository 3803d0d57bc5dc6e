"""PROPS and STATEV of a scene: the fixed order, less what the scene leaves out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from umatgen.model.temperature import QUANTITIES
from umatgen.notation import TABLE
from umatgen.scene import Scene


@dataclass(frozen=True)
class Property:
    """A material constant: manifest name, Fortran name and a default for a first run (IM7-8552, 70 C, BP, 15 mm)."""

    name: str
    fortran: str
    default: float


@dataclass(frozen=True)
class StateVariable:
    """A solution-dependent state variable and the Fortran text of its value at the end of the increment."""

    name: str
    unit: str
    meaning: str
    value: str


PROPERTIES = (
    Property("w0", "w0", 15.0),
    Property("h0", "h0", 0.5),
    Property("l0_over_d", "l0_over_d", 4294.0),
    Property("k", "k_gap", 0.813),
    Property("a", "a_rate", -0.866),
    Property("b_squeeze", "b_squeeze", -14.93),
    Property("b_bleed", "b_bleed", -31.66),
    Property("eps_lock", "eps_lock", -0.140253),
    Property("chi_ratio", "chi_ratio", 0.7),
    Property("E_L", "e_l", 25.0),
    Property("E_T", "e_t", 1.0e-6),
    Property("nu_LT", "nu_lt", 0.01),
    Property("nu_TT", "nu_tt", 0.01),
    Property("G_LT", "g_lt", 0.495e-6),
    Property("kappa", "kappa", 1.0e5),
    Property("rate_floor", "rate_floor", 1.0e-12),
    Property("strain_floor", "strain_floor", 1.0e-12),
    Property("n1", "dir_1", 1.0),
    Property("n2", "dir_2", 0.0),
    Property("n3", "dir_3", 0.0),
    Property("m1", "nor_1", 0.0),
    Property("m2", "nor_2", 0.0),
    Property("m3", "nor_3", 1.0),
)

STATE = (
    StateVariable("eps", "-", "compaction strain along the ply normal, negative in compaction", "eps"),
    StateVariable("width", "-", "stretch of the ply across the fibre (in-plane area over fibre stretch)", "width"),
    StateVariable("J", "-", "volume ratio", "det_f"),
    StateVariable("fibre_fraction", "-", "fibre volume fraction V0/J", ""),
    StateVariable("locked", "-", "0 squeezing, 1 bleeding: for good once the lock is passed", ""),
    StateVariable("pressure", "MPa", "pressure of the incompressibility constraint, compression positive", "pressure"),
    StateVariable("eps_rate", "1/s", "rate of the compaction strain", "eps_rate"),
    StateVariable("dissipation", "MPa", "viscous dissipation so far, per reference volume", ""),
)
HISTORY = (
    StateVariable("mean_stress", "MPa", "mean effective viscous stress over the last increment", "mean_stress"),
    StateVariable("dt_last", "s", "length of the last increment; 0: the next one starts anew", "dt"),
)


def table_quantities(scene: Scene) -> list[str]:
    """Names of the quantities that a scene takes from its temperature table."""
    absent = {f"b_{name}" for name in ("squeeze", "bleed") if name not in scene.kept_regimes}
    return [name for name in QUANTITIES if name not in absent] if scene.table else []


def state_variables(scene: Scene) -> list[StateVariable]:
    """The state variables that a scene keeps, in the fixed order."""
    needed = {"locked"} if scene.both_regimes else set()
    needed |= {"pressure"} if scene.incompressibility == "augmented" and scene.has_volume else set()
    needed |= {"eps_rate"} if scene.keeps_last_rate or scene.creep else set()
    if scene.outputs == "full":
        needed |= {"eps", "width", "J", "fibre_fraction", "eps_rate"}
        needed |= {"pressure"} if scene.has_volume else set()
        needed |= {"dissipation"} if scene.energies else set()
    return [*(s for s in STATE if s.name in needed), *(HISTORY if scene.creep else ())]


def state_place(scene: Scene, name: str) -> int:
    """Number of a state variable, 0 where the scene does not keep it."""
    names = [s.name for s in state_variables(scene)]
    return names.index(name) + 1 if name in names else 0


def property_rows(used: Sequence[Property] = PROPERTIES[:17]) -> list[dict[str, object]]:
    """PROPS for the manifest."""
    return [
        {
            "index": i,
            "name": p.name,
            "unit": TABLE[p.fortran].unit,
            "default": p.default,
            "meaning": TABLE[p.fortran].meaning,
        }
        for i, p in enumerate(used, 1)
    ]


def state_rows(kept: Sequence[StateVariable] = STATE) -> list[dict[str, object]]:
    """STATEV for the manifest."""
    return [{"index": i, "name": s.name, "unit": s.unit, "meaning": s.meaning} for i, s in enumerate(kept, 1)]
