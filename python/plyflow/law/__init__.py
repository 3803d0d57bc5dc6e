"""The one-dimensional compaction law: Eqs. 1 to 6, load programmes, integration."""

from plyflow.law.equations import (
    LawParameters,
    Stage,
    bulk_lock_strain,
    compaction_stress,
    creep_rate,
    eta_micro,
    eta_ply,
    lock_strain,
    log_viscosity,
)
from plyflow.law.load import LoadClock, LoadProgramme
from plyflow.law.ode import LawHistory, integrate

__all__ = [
    "LawHistory",
    "LawParameters",
    "LoadClock",
    "LoadProgramme",
    "Stage",
    "bulk_lock_strain",
    "compaction_stress",
    "creep_rate",
    "eta_micro",
    "eta_ply",
    "integrate",
    "lock_strain",
    "log_viscosity",
]
