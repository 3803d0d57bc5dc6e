"""Running one case and what comes out: the UMAT driven under the load, beside the one-dimensional law."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from plyflow.case.case import (
    Case,
    assumption_lines,
    driver_steps,
    law_parameters,
    property_values,
    props_vector,
    state_place,
)
from plyflow.driver.drive import Controls, History, drive
from plyflow.errors import InputError, OutputError, RunError
from plyflow.files import json_text, write_files
from plyflow.law import LawHistory, integrate
from plyflow.umat.prepare import Umat

INITIAL_INCREMENT = 1e-2  # s
MAXIMUM_INCREMENT = 20.0  # s
GROWTH = 1.5
SMALLEST_REFINEMENT = 0.1


@dataclass(frozen=True)
class RunResult:
    """One finished case.

    values: every PROPS by name; history: the driver's; law: the one-dimensional law at the driver's times;
    locked: whether the ply has locked, by the UMAT, at the same times.
    """

    case: Case
    values: Mapping[str, float]
    history: History
    law: LawHistory
    assumptions: list[str]
    provenance: dict[str, Any]
    locked: NDArray[np.bool_]

    @property
    def thickness_ratio(self) -> NDArray[np.float64]:
        """h/h0 (n,) from the UMAT: the stretch F33."""
        return np.asarray(self.history.deformation_gradient[:, 2, 2], dtype=float)

    @property
    def width_ratio(self) -> NDArray[np.float64]:
        """w/w0 (n,) from the UMAT: the stretch F22."""
        return np.asarray(self.history.deformation_gradient[:, 1, 1], dtype=float)

    @property
    def lock_time(self) -> float | None:
        """Time [s] at which the UMAT locked, None if it did not."""
        return float(self.history.time[np.argmax(self.locked)]) if self.locked.any() else None

    def summary(self) -> dict[str, Any]:
        """Plain data of the result, ready for JSON: ratios [-], times [s], counts."""
        case, history, law = self.case, self.history, self.law
        return {
            "material": case.material,
            "temperature": case.temperature,
            "layup": case.layup,
            "width": case.width,
            "load": case.load,
            "thickness_ratio_final": float(self.thickness_ratio[-1]),
            "width_ratio_final": float(self.width_ratio[-1]),
            "thickness_ratio_1d": float(law.thickness_ratio[-1]),
            "width_ratio_1d": float(law.width_ratio[-1]),
            "lock_time": self.lock_time,
            "lock_time_1d": law.lock_time,
            "increments": int(history.increments),
            "iterations": int(history.total_iterations),
            "cutbacks": int(history.cutbacks),
            "cutbacks_by_reason": {why: int(count) for why, count in history.cutbacks_by_reason.items()},
            "run_time_s": float(history.run_time_s),
            "assumptions": self.assumptions,
            "provenance": self.provenance,
        }

    def to_json(self) -> str:
        """`summary` as one JSON object."""
        return json_text(self.summary())

    def history_table(self) -> pd.DataFrame:
        """Time [s], pressure [MPa], thickness and width ratios [-] of UMAT and law, a row an increment."""
        return pd.DataFrame(
            {
                "time_s": self.history.time,
                "pressure_MPa": self.law.pressure,
                "thickness_ratio": self.thickness_ratio,
                "width_ratio": self.width_ratio,
                "thickness_ratio_1d": self.law.thickness_ratio,
                "width_ratio_1d": self.law.width_ratio,
            }
        )


def case_controls(refinement: float = 1.0) -> Controls:
    """Increments for the compaction programme, all shorter by the factor `refinement`.

    Increments grow geometrically from the start of each step, because the creep decays like a power of
    time, up to a largest one. At refinement 1 every case of the programme ends within 1e-3 of the
    one-dimensional law's thickness; the error falls in proportion to 1/refinement.

    Raises
    ------
    InputError
        The refinement is not a finite number of at least 0.1.
    """
    if not (math.isfinite(refinement) and refinement >= SMALLEST_REFINEMENT):
        raise InputError(f"refinement {refinement:g} must be a finite number of at least {SMALLEST_REFINEMENT}")
    return Controls(
        initial_increment=INITIAL_INCREMENT / refinement,
        maximum_increment=MAXIMUM_INCREMENT / refinement,
        growth=GROWTH ** (1.0 / refinement),
    )


def run_case(case: Case, umat: Umat, controls: Controls | None = None, replay: Path | None = None) -> RunResult:
    """Drive the UMAT through a case and integrate the one-dimensional law at the same times.

    Without `controls` the increments are those of `case_controls`. Where an increment fails, `replay` is the file that
    repeats it (`plyflow.run.replay`); without it none is written.

    Raises
    ------
    InputError
        The case cannot be set up: unknown material or setting, temperature or value outside its bounds.
    RunError
        The driver could not finish.
    """
    values = property_values(case, umat.manifest)
    with TemporaryDirectory() as scratch:
        failed = Path(scratch) / "increment.txt"
        history = drive(
            umat.library,
            np.array(props_vector(values, umat.manifest)),
            len(umat.manifest["statev"]),
            driver_steps(case.load_programme),
            controls if controls is not None else case_controls(),
            temperature=case.temperature,
            replay=failed if replay is not None else None,
        )
        end = case.load_programme.end
        if not history.completed:
            stopped = f"{case.label}: stopped at {history.time[-1]:g} s of {end:g} s: {history.message}"
            raise RunError(stopped + _kept(failed, replay))
    return RunResult(
        case=case,
        values=values,
        history=history,
        law=integrate(law_parameters(values), case.load_programme, np.minimum(history.time, end)),
        assumptions=assumption_lines(case, values),
        provenance=umat.provenance.as_dict() | {"inputs": dict(values)},
        locked=history.statev[:, state_place(umat.manifest, "locked")] >= 0.5,
    )


def _kept(failed: Path, replay: Path | None) -> str:
    """Keep the file of the increment that failed, and say how to repeat it; a folder that cannot be written is said too."""
    if replay is None or not failed.is_file():
        return ""
    try:
        write_files(replay.parent, {replay.name: failed.read_text(encoding="utf-8")})
    except OutputError as error:
        return f"; the increment is not kept: {error}"
    return f"; the increment is kept, see it again with: plyflow replay {replay}"
