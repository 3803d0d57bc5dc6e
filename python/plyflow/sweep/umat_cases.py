"""A part of a sweep by the UMAT under the driver, the one-dimensional law beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from plyflow.case.case import (
    LAW_MANIFEST,
    Case,
    driver_steps,
    property_values,
    props_vector,
    setting_names,
    state_place,
)
from plyflow.case.loads import find_load
from plyflow.case.programme import LOADS
from plyflow.driver.drive import History, drive
from plyflow.errors import RunError, ToolError
from plyflow.law import LoadProgramme
from plyflow.run.case_run import case_controls
from plyflow.run.lock_time import case_lock_time
from plyflow.sweep.law_cases import NO_SETTINGS, failed, law_case, run_law_rows
from plyflow.umat.prepare import Umat, prepare_umat

BESIDE = {"thickness_ratio": "thickness_ratio_1d", "width_ratio": "width_ratio_1d", "lock_time_s": "lock_time_1d_s"}


def run_umat_rows(
    rows: Sequence[dict[str, Any]], umats: Mapping[str, Mapping[str, Any]], extrapolate: bool = False
) -> list[dict[str, Any]]:
    """Results of cases (n) by name, in order; a case that cannot be set up or finished says why.

    Parameters
    ----------
    rows : sequence of dict
        Cases.
    umats : mapping
        Provenance of the UMAT of each scene; the one compiled here must have the same source.
    extrapolate : bool
        Allow temperatures outside the material's table.
    """
    of_the_law = {*NO_SETTINGS, *setting_names(LAW_MANIFEST)}
    results = run_law_rows(
        [{name: value for name, value in row.items() if name in of_the_law} for row in rows], extrapolate
    )
    for place, (row, law) in enumerate(zip(rows, results, strict=True)):
        if law["status"] == "failed":
            continue
        try:
            umat = prepared(row["scene"], umats[row["scene"]]["source_sha256"])
            results[place] = _run(row, umat, law, extrapolate)
        except ToolError:
            raise
        except Exception as error:
            results[place] = failed(error)
    return results


@cache
def prepared(scene: str, source_sha256: str) -> Umat:
    """The UMAT of a scene, made once in each process.

    Raises
    ------
    ToolError
        This process generates another source than the one the sweep was planned with.
    """
    umat = prepare_umat(scene)
    if umat.provenance.source_sha256 != source_sha256:
        raise ToolError(
            f"scene '{scene}' generates another source here than where the sweep was started: "
            "install the same plyflow on every worker"
        )
    return umat


def driven(case: Case, load: LoadProgramme, umat: Umat, refine: float = 1.0) -> tuple[dict[str, float], History]:
    """PROPS by name and history of a case under any load; as `plyflow.run.case_run.run_case` without the law.

    Raises
    ------
    InputError
        The case cannot be set up.
    RunError
        The driver could not finish.
    """
    values = property_values(case, umat.manifest, follows=True)
    history = drive(
        umat.library,
        np.array(props_vector(values, umat.manifest)),
        len(umat.manifest["statev"]),
        driver_steps(load),
        case_controls(refine, umat.manifest["scene"]["integrator"]),
        temperature=case.temperature,
    )
    if not history.completed:
        raise RunError(f"stopped at {history.time[-1]:g} s of {load.end:g} s: {history.message}")
    return values, history


def _run(row: dict[str, Any], umat: Umat, law: Mapping[str, Any], extrapolate: bool) -> dict[str, Any]:
    load = find_load(row["load"], float(row["width"]))
    case = law_case(row, extrapolate, row["load"] if load.temperatures else LOADS[0])
    values, history = driven(case, load, umat, row.get("refine", 1.0))
    beside = {name: law[source] for source, name in BESIDE.items()}
    return dict(law) | beside | _final_state(history, load, umat, values, case, law)


def _final_state(
    history: History, load: LoadProgramme, umat: Umat, values: Mapping[str, float], case: Case, law: Mapping[str, Any]
) -> dict[str, Any]:
    width, thickness = (float(history.deformation_gradient[-1, axis, axis]) for axis in (1, 2))
    locked = history.statev[:, state_place(umat.manifest, "locked")] >= 0.5
    # J of the law at its end is known through its fibre fraction; the initial one is the same for the UMAT.
    initial = law["fibre_fraction"] * law["thickness_ratio"] * law["width_ratio"]
    if not (math.isfinite(thickness) and math.isfinite(width)):
        raise RunError(f"the driver ended with thickness {thickness:g}, width {width:g}")
    return {
        "thickness_ratio": thickness,
        "thickness_mm": case.blocks * values["h0"] * thickness,
        "width_ratio": width,
        "width_mm": values["w0"] * width,
        "fibre_fraction": initial / float(np.linalg.det(history.deformation_gradient[-1])),
        "lock_time_s": case_lock_time(case.of_law, values, load, history, locked),
        "increments": int(history.increments),
        "iterations": int(history.total_iterations),
        "cutbacks": int(history.cutbacks),
    }
