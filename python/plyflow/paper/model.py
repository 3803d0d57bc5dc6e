"""What the figures draw: tables of the programme by law and UMAT, made once for all figures of a call."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from plyflow.case.case import Case
from plyflow.case.materials import known_materials
from plyflow.case.programme import paper_programme
from plyflow.errors import RunError
from plyflow.law import integrate
from plyflow.paper.claims import programme_table
from plyflow.paper.creep_lines import CreepLines, creep_lines
from plyflow.sweep.law_cases import run_law_rows
from plyflow.sweep.umat_cases import driven, run_umat_rows
from plyflow.umat.prepare import Umat, prepare_umat

LOAD = "ramp-dwell"
LAYUPS = ("CP", "SB", "BP")
BASELINE, SCALE_UP = 15.0, 30.0
SIZES = {BASELINE: "baseline, 15 mm", SCALE_UP: "scale-up, 30 mm"}
EARLIEST = 1e-3  # s after a load level is reached, the first time drawn


@dataclass(frozen=True)
class Model:
    """The model with the settings of a call (assumptions and constants of the law by name)."""

    settings: Mapping[str, float] = field(default_factory=dict)

    @property
    def marks(self) -> str:
        """What the marks of a figure are."""
        return "UMAT"

    @property
    def words(self) -> str:
        """How the cases were run, in a sentence."""
        return "One material point a case in the place of the finite element model: no friction, no contact between blocks."

    @property
    def measured(self) -> pd.DataFrame:
        """Measured points given: none."""
        return pd.DataFrame(columns=["material", "temperature", "layup", "width", "thickness_mm", "width_ratio"])

    @cached_property
    def umat(self) -> Umat:
        """The default scene's UMAT."""
        return prepare_umat()

    @cached_property
    def backward(self) -> Umat:
        """The paper's backward difference, for the lines of section 3.2: it takes increments enough for a line."""
        return prepare_umat("bdf1")

    @cached_property
    def programme(self) -> pd.DataFrame:
        """The 84 cases by the law; see `programme_table`."""
        return programme_table(self.settings)

    @property
    def locking_angles(self) -> list[float]:
        """The angles gamma_lock [deg] that the cases have; none where eps_lock is set."""
        rows = _rows(tuple, {})
        cases = [Case(row["material"], row["temperature"], "CP", BASELINE, LOAD, self.settings) for row in rows]
        angles = {case.assumed()["gamma_lock"].value for case in cases}
        return sorted(angle for angle in angles if np.isfinite(angle))

    @cached_property
    def smooth(self) -> pd.DataFrame:
        """Final state by the law each degree from the first to the last column; as `run_law_rows`."""
        rows = _rows(lambda temperatures: np.arange(temperatures[0], temperatures[-1] + 0.5), self.settings)
        return _table(rows, run_law_rows(rows), self.settings)

    @cached_property
    def driven(self) -> pd.DataFrame:
        """Final state of the 84 cases by the UMAT, the law beside; as `run_umat_rows`."""
        rows = [row | {"scene": "default"} for row in _rows(tuple, self.settings)]
        made = {"default": self.umat.provenance.as_dict()}
        table = _table(rows, run_umat_rows(rows, made), self.settings)
        stack = table["thickness_mm"] / table["thickness_ratio"]
        return table.assign(thickness_mm_1d=stack * table["thickness_ratio_1d"])

    @cached_property
    def lines(self) -> dict[tuple[float, str], CreepLines]:
        """Section 3.2 on UMAT runs of IM7-8552, baseline, by temperature [degC] and layup."""
        temperatures = known_materials()["IM7-8552"].table.temperature
        return {key: self.creep_lines(*key) for key in itertools.product(temperatures, LAYUPS)}

    def creep_lines(self, temperature: float, layup: str) -> CreepLines:
        """Section 3.2 on one UMAT run of IM7-8552, baseline."""
        case = Case("IM7-8552", temperature, layup, BASELINE, LOAD, self.settings)
        return creep_lines(case, self.backward)

    def law_history(self, material: str, temperature: float, layup: str, width: float) -> pd.DataFrame:
        """Time [s], pressure [MPa], thickness ratio [-] and thickness of the specimen [mm] by the law."""
        case = Case(material, temperature, layup, width, LOAD, self.settings)
        solution = integrate(case.law(), case.load_programme, drawn_times())
        ratio = solution.thickness_ratio
        columns: dict[str, Any] = {"time_s": solution.time, "pressure_MPa": solution.pressure, "thickness_ratio": ratio}
        return pd.DataFrame(columns | {"thickness_mm": case.blocks * case.block_thickness * ratio})

    def umat_history(self, material: str, temperature: float, layup: str, width: float) -> pd.DataFrame:
        """The same at the increments of the UMAT's run, with the law's ratio beside."""
        case = Case(material, temperature, layup, width, LOAD, self.settings)
        values, history = driven(case, case.load_programme, self.umat)
        beside = integrate(case.law(), case.load_programme, np.minimum(history.time, case.load_programme.end))
        ratio = history.deformation_gradient[:, 2, 2]
        return pd.DataFrame(
            {
                "time_s": history.time,
                "pressure_MPa": beside.pressure,
                "thickness_ratio": ratio,
                "thickness_mm": case.blocks * values["h0"] * ratio,
                "thickness_ratio_1d": beside.thickness_ratio,
                "thickness_mm_1d": case.blocks * values["h0"] * beside.thickness_ratio,
            }
        )


def drawn_times() -> np.ndarray[Any, Any]:
    """Times (t,) [s] over the ramp-dwell test, dense where a level begins."""
    programme = paper_programme()
    level, levels = programme.dwell_level_time, len(programme.specimen[0].levels)
    steps = np.concatenate([[0.0], np.geomspace(EARLIEST, level, 120)])
    return np.unique(np.concatenate([place * level + steps for place in range(levels)]))


def _rows(chosen: Any, settings: Mapping[str, float]) -> list[dict[str, Any]]:
    """Cases of the programme with the temperatures that `chosen` picks of the columns."""
    rows = []
    for name, material in known_materials().items():
        temperatures = [float(value) for value in chosen(material.table.temperature)]
        for width, layup, temperature in itertools.product(SIZES, LAYUPS, temperatures):
            case = {"material": name, "temperature": temperature, "layup": layup, "width": width, "load": LOAD}
            rows.append(case | dict(settings))
    return rows


def _table(
    rows: Sequence[dict[str, Any]], results: Sequence[dict[str, Any]], settings: Mapping[str, float]
) -> pd.DataFrame:
    """Cases and results side by side; settings, the same in every row, left out.

    Raises
    ------
    RunError
        A case could not be finished.
    """
    for row, result in zip(rows, results, strict=True):
        if result["status"] == "failed":
            label = f"{row['material']} {row['temperature']:g} degC {row['layup']} {row['width']:g} mm"
            raise RunError(f"{label}: {result['reason']}")
    kept = [{name: value for name, value in row.items() if name not in settings} for row in rows]
    return pd.DataFrame([row | result for row, result in zip(kept, results, strict=True)]).drop(columns="status")
