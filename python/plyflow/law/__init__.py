"""The one-dimensional compaction law: Eqs. 1 to 6, load programmes, integration."""

from plyflow.law.equations import (
    LawBatch,
    LawParameters,
    Stage,
    batch,
    bulk_lock_strain,
    compaction_stress,
    edge_shear,
    lock_strain,
    log_viscosity,
)
from plyflow.law.integration import LawHistory, integrate, integrate_batch
from plyflow.law.load import LoadClock, LoadProgramme

__all__ = [
    "LawBatch",
    "LawHistory",
    "LawParameters",
    "LoadClock",
    "LoadProgramme",
    "Stage",
    "batch",
    "bulk_lock_strain",
    "compaction_stress",
    "edge_shear",
    "integrate",
    "integrate_batch",
    "lock_strain",
    "log_viscosity",
]
