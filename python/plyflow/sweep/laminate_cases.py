"""A part of a sweep by laminates of finite elements, the one-dimensional law beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from plyflow.case.case import LAW_MANIFEST, setting_names, state_place
from plyflow.case.stack import stack_angles
from plyflow.errors import InputError, ToolError
from plyflow.hosts.laminate.equilibrium import Equilibrium
from plyflow.hosts.laminate.run import LaminateRun
from plyflow.hosts.laminate.specimen import Specimen
from plyflow.sweep.law_cases import NO_SETTINGS, failed, law_case, run_law_rows
from plyflow.sweep.umat_cases import BESIDE, prepared


def run_laminate_rows(
    rows: Sequence[dict[str, Any]], umats: Mapping[str, Mapping[str, Any]], extrapolate: bool = False
) -> list[dict[str, Any]]:
    """Results of cases (n) by name, in order; a case that cannot be set up or finished says why.

    As `run_umat_rows`; beside them the widths of the innermost and the outermost blocks and the thickness ratio over time.
    """
    of_the_law = {*NO_SETTINGS, *setting_names(LAW_MANIFEST)}
    results = run_law_rows([{k: v for k, v in row.items() if k in of_the_law} for row in rows], extrapolate)
    for place, (row, law) in enumerate(zip(rows, results, strict=True)):
        if law["status"] == "failed":
            continue
        try:
            results[place] = law | _run(row, umats[row["scene"]]["source_sha256"], law, extrapolate)
        except ToolError:
            raise
        except Exception as error:
            results[place] = failed(error)
    return results


def _run(row: Mapping[str, Any], source_sha256: str, law: Mapping[str, Any], extrapolate: bool) -> dict[str, Any]:
    if row["cells"] != int(row["cells"]):
        raise InputError(f"cells = {row['cells']:g} must be a whole number")
    given = {name: value for name, value in row.items() if name not in ("cells", "friction")}
    case = law_case(given, extrapolate, str(row["load"]))
    specimen = Specimen(case, stack_angles(None, case.layup), int(row["cells"]))
    run = LaminateRun(Equilibrium(specimen, prepared(row["scene"], source_sha256), row["friction"]), None, row.get("refine", 1.0))
    run.finish()
    return {name: law[source] for source, name in BESIDE.items()} | _final_state(run, law)


def _final_state(run: LaminateRun, law: Mapping[str, Any]) -> dict[str, Any]:
    case, course, table = run.model.specimen.case, run.course, run.course.table
    thickness, locked_share, widths = table[-1, 1], table[-1, 2], table[-1, 4:]
    volume = run.state.statev[:, state_place(run.model.umat.manifest, "J")]
    middle = len(widths) // 2
    return {
        "thickness_ratio": thickness,
        "thickness_mm": run.height * thickness,
        "width_ratio": float(widths.mean()),
        "width_mm": case.width * float(widths.mean()),
        "fibre_fraction": law["fibre_fraction"] * law["thickness_ratio"] * law["width_ratio"] / float(volume.mean()),
        "lock_time_s": course.first_lock,
        "lock_time_last_s": course.last_lock,
        "locked_share": locked_share,
        "width_ratio_inner": float(widths[[middle - 1, middle]].mean()),
        "width_ratio_outer": float(widths[[0, -1]].mean()),
        "increments": course.increments,
        "iterations": course.iterations,
        "cutbacks": course.rejections,
        **{name: " ".join(f"{x:.7g}" for x in np.ravel(table[:, at])) for at, name in enumerate(("times_s", "thickness_ratios"))},
    }
