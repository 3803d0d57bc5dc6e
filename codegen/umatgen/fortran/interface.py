"""The fixed order of PROPS and STATEV (names, units, defaults), for the manifest and for the comments in the source."""

from __future__ import annotations

from dataclasses import dataclass

from umatgen.notation import TABLE


@dataclass(frozen=True)
class Property:
    """A material constant: manifest name, Fortran name and a default for a first run (IM7-8552, 70 C, BP, 15 mm)."""

    name: str
    fortran: str
    default: float


@dataclass(frozen=True)
class StateVariable:
    """A solution-dependent state variable."""

    name: str
    unit: str
    meaning: str


PROPERTIES = (
    Property("w0", "w0", 15.0),
    Property("h0", "h0", 0.5),
    Property("l0_over_d", "l0_over_d", 4294.0),
    Property("k", "k_gap", 0.813),
    Property("a", "a_rate", -0.866),
    Property("b_squeeze", "b_squeeze", -14.93),
    Property("b_bleed", "b_bleed", -31.66),
    Property("eps_lock", "eps_lock", -0.05934),
    Property("chi_ratio", "chi_ratio", 0.7),
    Property("E_L", "e_l", 25.0),
    Property("E_T", "e_t", 1.0e-6),
    Property("nu_LT", "nu_lt", 0.01),
    Property("nu_TT", "nu_tt", 0.01),
    Property("G_LT", "g_lt", 0.495e-6),
    Property("kappa", "kappa", 1.0e5),
    Property("rate_floor", "rate_floor", 1.0e-12),
    Property("strain_floor", "strain_floor", 1.0e-12),
)

STATE = (
    StateVariable("eps", "-", "compaction strain ln(stretch), negative in compaction"),
    StateVariable("width", "-", "transverse stretch across the compaction"),
    StateVariable("J", "-", "volume ratio"),
    StateVariable("fibre_fraction", "-", "fibre volume fraction 0.5/J"),
    StateVariable("locked", "-", "0 squeezing, 1 bleeding (fixed for the next increment)"),
    StateVariable("pressure", "MPa", "pressure of the incompressibility constraint, compression positive"),
    StateVariable("eps_rate", "1/s", "rate of the compaction strain"),
    StateVariable("dissipation", "MPa", "viscous dissipation so far, per reference volume"),
)


def property_rows() -> list[dict[str, object]]:
    """PROPS for the manifest."""
    return [
        {
            "index": i,
            "name": p.name,
            "unit": TABLE[p.fortran].unit,
            "default": p.default,
            "meaning": TABLE[p.fortran].meaning,
        }
        for i, p in enumerate(PROPERTIES, 1)
    ]


def state_rows() -> list[dict[str, object]]:
    """STATEV for the manifest."""
    return [{"index": i, "name": s.name, "unit": s.unit, "meaning": s.meaning} for i, s in enumerate(STATE, 1)]
