"""What a finished laminate says: JSON, history, VTU series for ParaView, figures."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pandas as pd

from plyflow.case.case import assumption_lines, law_parameters, state_place
from plyflow.hosts.laminate.element import Array
from plyflow.hosts.laminate.equilibrium import SLIP, State
from plyflow.hosts.laminate.run import LaminateRun
from plyflow.law import LawHistory, integrate
from plyflow.show.figure import BLUE, LAW_LINE, TWO, panels, svg

INEXTENSIBLE = "fibre inextensible, edge free"


def law_history(run: LaminateRun) -> LawHistory:
    """The one-dimensional law at the times of the run."""
    case = run.model.specimen.case
    times = np.minimum(run.course.table[:, 0], case.load_programme.end)
    return integrate(law_parameters(run.model.values), case.load_programme, times)


def assumptions(run: LaminateRun) -> list[str]:
    """List what the result rests on, one sentence each."""
    model, specimen = run.model, run.model.specimen
    case, friction = specimen.case, model.coefficient
    lines = assumption_lines(case, model.values)
    ours = [
        "plate pressure of the law = force / (width x width); the plates press the force on the plies as wide as they have become",
        f"fibre directions bottom to top: {', '.join(f'{angle:g}' for angle in specimen.angles)} degrees; "
        + ("a quarter by symmetry" if specimen.quarter else "the whole square, its layers kept from drifting and turning"),
        f"{specimen.cells} elements along half the width, one through each block, C3D8 with the volume ratio averaged",
        "blocks of different directions share the normal displacement and slide freely, blocks of the same are tied",
        f"plates rigid, in contact everywhere; Coulomb friction {friction:g}"
        + (
            f", elastic up to a slip of {SLIP * case.width:g} mm, under the normal forces of the last increment scaled by the load"
            if friction
            else ""
        ),
        "fibre extensible with E_L, edges free",
        f"arms of {specimen.arms:g} mm beyond the plates along the fibres, free" if specimen.arms else "no arms beyond the plates",
    ]
    return [line for line in lines if INEXTENSIBLE not in line] + ours


def summary(run: LaminateRun) -> dict[str, Any]:
    """Plain data of the result, ready for JSON: ratios [-], times [s], work [N mm], counts."""
    case, course, law = run.model.specimen.case, run.course, law_history(run)
    last, work = course.rows[-1], works(run)
    return {
        "material": case.material,
        "temperature": case.temperature,
        "layup": case.layup,
        "width": case.width,
        "load": case.load,
        "angles": list(run.model.specimen.angles),
        "cells": run.model.specimen.cells,
        "arms": run.model.specimen.arms,
        "friction": run.model.coefficient,
        "thickness_ratio_final": last[1],
        "width_ratio_final": float(np.mean(last[4:])),
        "width_ratio_of_blocks": last[4:],
        "thickness_ratio_1d": float(law.thickness_ratio[-1]),
        "width_ratio_1d": float(law.width_ratio[-1]),
        "lock_time": course.first_lock,
        "lock_time_last": course.last_lock,
        "lock_time_1d": law.lock_time,
        "locked_share": last[2],
        "increments": course.increments,
        "iterations": course.iterations,
        "cutbacks": course.rejections,
        "shortened": course.shortened,
        "cutbacks_by_reason": course.reasons,
        "degrees_of_freedom": run.model.unknowns,
        "work": work,
        "cpu_s": course.cpu,
        "assumptions": assumptions(run),
        "provenance": run.model.umat.provenance.as_dict()
        | {"inputs": run.model.values},
    }


def works(run: LaminateRun) -> dict[str, float]:
    """Work of the plate and what became of it, N mm of the meshed part."""
    volumes = run.model.volumes.ravel()
    dissipated = run.state.statev[:, state_place(run.model.umat.manifest, "dissipation")]
    return {
        "plate": run.course.rows[-1][3],
        "stored": float(volumes @ run.state.energies[:, 0]),
        "dissipated": float(volumes @ dissipated),
        "friction": run.course.rubbed,
    }


def history_table(run: LaminateRun) -> pd.DataFrame:
    """Time [s], thickness ratio, locked share, plate work [N mm], width of each block, the law's ratios: a row an increment."""
    law, blocks = law_history(run), len(run.model.specimen.angles)
    names = ["time_s", "thickness_ratio", "locked_share", "plate_work_Nmm", *(f"width_ratio_{i + 1}" for i in range(blocks))]
    table = pd.DataFrame(run.course.table, columns=names)
    return table.assign(thickness_ratio_1d=law.thickness_ratio, width_ratio_1d=law.width_ratio)


def vtu_series(run: LaminateRun) -> dict[str, Any]:
    """VTU files of the states kept and the PVD file that gives their times, by name."""
    files: dict[str, Any] = {f"laminate_{i:03d}.vtu": _vtu(run, state) for i, state in enumerate(run.states)}
    sets = [f'<DataSet timestep="{s.time!r}" file="{name}"/>' for s, name in zip(run.states, files, strict=True)]
    files["laminate.pvd"] = f'<VTKFile type="Collection"><Collection>{"".join(sets)}</Collection></VTKFile>\n'
    return files


def _vtu(run: LaminateRun, state: State) -> bytes:
    model, mesh = run.model, run.model.specimen.mesh
    points = model.volumes.shape
    cell = {
        name: state.statev[:, state_place(model.umat.manifest, name)].reshape(points).mean(axis=1)
        for name in ("eps", "width", "fibre_fraction", "locked", "pressure")
    }
    stress = state.stress.reshape(*points, 6).mean(axis=1)
    cell["thickness_stretch"] = np.exp(cell.pop("eps"))
    data = {name: [values] for name, values in (cell | {"stress_in_ply_axes": stress}).items()}
    displacement = model.displacement(state.unknowns)
    grid = meshio.Mesh(mesh.points, [("hexahedron", mesh.cells)], {"displacement": displacement}, data)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "grid.vtu"
        grid.write(path)
        return path.read_bytes()


def thickness_map(run: LaminateRun) -> tuple[Array, Array]:
    """Places (c, 2) [mm] of the element columns in the plane, and thickness stretch (blocks, c) of the blocks there."""
    specimen = run.model.specimen
    eps = run.model.of_blocks(run.state.statev[:, state_place(run.model.umat.manifest, "eps")])
    centres = specimen.mesh.points[specimen.mesh.cells[: specimen.columns]].mean(axis=1)
    return centres[:, :2], np.exp(eps.reshape(len(specimen.angles), specimen.columns, -1).mean(axis=2))


def figure_svg(run: LaminateRun) -> str:
    """Thickness over time beside the law, and the map of the thickness of the block that varies most."""
    figure, (left, right) = panels(2, TWO)
    law, table = law_history(run), run.course.table
    left.plot(table[:, 0], table[:, 1], color=BLUE, label=f"laminate, {run.model.specimen.cells} cells")
    left.plot(table[:, 0], law.thickness_ratio, label="one-dimensional law", **LAW_LINE)
    left.set(xlabel="time [s]", ylabel="thickness h/h0 [-]", title=run.model.specimen.case.label)
    left.legend()
    places, stretch = thickness_map(run)
    block = int(np.ptp(stretch, axis=1).argmax())
    n = round(len(places) ** 0.5)
    grid = [values.reshape(n, n) for values in (*places.T, stretch[block])]
    shown = right.pcolormesh(*grid, cmap="viridis", shading="nearest")
    right.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]", title=f"h/h0 of block {block + 1}")
    right.grid(visible=False)
    figure.colorbar(shown, ax=right)
    return svg(figure)


def result_files(run: LaminateRun) -> dict[str, Any]:
    """Files of a run, by name."""
    own = {"result.json": summary(run), "history.csv": history_table(run), "thickness.svg": figure_svg(run)}
    return own | vtu_series(run)
