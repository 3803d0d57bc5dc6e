"""Does a scene run in OpenGeoSys as it runs in the driver? Blocks, gliding or held, driven or pressed, F-bar on and off."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import metadata
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from plyflow.diagnose.mistakes import VOIGT
from plyflow.driver.drive import Controls, Step, drive
from plyflow.driver.points import call_points
from plyflow.errors import RunError
from plyflow.hosts.mgis.behaviour import FLAGS, behaviour_of, compiled
from plyflow.hosts.mgis.opengeosys import DURATION, Block, BlockResult, run_block
from plyflow.provenance import package_version
from plyflow.show.table import Column, Table
from plyflow.umat.compile import compiler_version
from plyflow.umat.prepare import Umat, prepare_umat

Array = NDArray[np.float64]
SMOOTH = 2  # the behaviour's KINC: no increment is known to be the first of a step
STIFF, SOFT = 1e3, 1.0  # kappa [MPa]; soft where plates hold the block, so that it can move without F-bar too
# Allowed differences. At the points rounding, times the condition of F-bar's cube root; of the width the tolerance of both
# iterations (1e-11 of the displacement, 1e-12 of the stress) through the slope of a stress that goes as rate^0.13.
POINT, WIDTH, LOAD = 1e-11, 1e-9, 1e-6

ELEMENT = Block("element")
PRESSED = Block("pressed", pressure=0.2)
QUICK = (ELEMENT, PRESSED, replace(ELEMENT, name="element F-bar", f_bar=True))
FULL = (
    *QUICK,
    *(Block(f"4x4x4{text}", (4, 4, 4), f_bar=on) for on, text in ((False, ""), (True, " F-bar"))),
    *(Block(f"8x8x4{text}", (8, 8, 4), f_bar=on) for on, text in ((False, ""), (True, " F-bar"))),
    replace(PRESSED, name="pressed 4x4x4 F-bar", cells=(4, 4, 4), f_bar=True),
    *(
        Block(f"held 3x3x3{text}", (3, 3, 3), (1.0, 1.0, 1.0), 0.1, f_bar=on, sticking=True)
        for on, text in ((False, ""), (True, " F-bar"))
    ),
)  # fmt: skip


@dataclass(frozen=True)
class BlockRow:
    """One block beside the driver.

    Parameters
    ----------
    increments, rejected, iterations, most_iterations : accepted, failed, mean and largest number of the accepted.
    thickness, width : ratios at the end, of the block or of its mean point where plates hold it.
    width_driver : that of the driver in as many increments with both sides free; None for blocks pressed or held.
    difference : largest of stress and state at the points from the driver's, relative to the largest of each quantity.
    remark : what missed its mark; empty if nothing.
    """

    job: str
    increments: int
    rejected: int
    iterations: float
    most_iterations: int
    thickness: float
    width: float
    width_driver: float | None
    difference: float
    remark: str


def check_scene(scene: str, folder: Path, full: bool = False) -> Iterator[BlockRow]:
    """Run the blocks of a scene with its default constants, kappa apart.

    Raises
    ------
    InputError
        Unknown scene, or one that does not fit.
    ToolError
        OpenGeoSys, meshio or a compiler is missing.
    RunError
        A block or the driver did not finish.
    """
    umat = prepare_umat(scene)
    for block in FULL if full else QUICK:
        yield check_block(block, umat, scene, folder)


def check_block(block: Block, umat: Umat, scene: str, folder: Path) -> BlockRow:
    """One block in OpenGeoSys and, point by point in the same increments, in the driver."""
    behaviour = behaviour_of(scene)
    constants = {row["name"]: float(row["default"]) for row in umat.manifest["props"]}
    constants["kappa"] = SOFT if block.sticking else STIFF
    job = folder / block.name.replace(" ", "_")
    result = run_block(block, behaviour, compiled(behaviour), constants, job)
    width = float(result.gradient[-1, :, 1, 1].mean())
    driver = None if block.sticking or block.pressure else _free_width(block, umat, constants)
    missed = {"stress or state": (point_difference(result, umat, constants), POINT)}
    difference = missed["stress or state"][0]
    if driver is not None:
        missed["width"] = abs(width - driver), WIDTH
    if block.pressure:
        nominal = np.einsum("pi,pi->p", result.gradient[-1, :, 2], result.stress[-1, :, :, 2])
        missed["pressure"] = float(np.abs(nominal / block.pressure + 1.0).max()), LOAD
    remark = "; ".join(f"{what} differs by {by:.1e} > {bound:.0e}" for what, (by, bound) in missed.items() if not by <= bound)
    iterations, thickness = result.iterations, float(result.gradient[-1, :, 2, 2].mean())
    return BlockRow(
        block.name, len(iterations), result.rejected, float(iterations.mean()), int(iterations.max()), thickness, width, driver,
        difference, remark,
    )  # fmt: skip


def point_difference(result: BlockResult, umat: Umat, constants: Mapping[str, float]) -> float:
    """Largest difference of stress and state from the driver's, all points taken through the deformations they had."""
    n, rows = result.gradient.shape[1], umat.manifest["statev"]
    state, sizes, apart = np.zeros((n, len(rows))), np.diff(result.time), []
    largest = float(np.abs(result.stress).max())
    scales = [largest if row["unit"] == "MPa" else np.abs(result.state[row["name"]]).max() or 1.0 for row in rows]
    for step, dt in enumerate(sizes):
        f0, f1 = result.gradient[step : step + 2]
        own = call_points(umat.library, list(constants.values()), f0, f1, float(dt), state, increment=SMOOTH)
        state = own.statev
        apart.append(np.abs(second_piola(f1, own.stress) - result.stress[step + 1]).max() / largest)
        host = np.stack([result.state[row["name"]][step + 1] for row in rows], axis=1)
        apart.append((np.abs(state - host) / scales).max())
    return float(np.max(apart))


def _free_width(block: Block, umat: Umat, constants: Mapping[str, float]) -> float:
    """Width of the driver in as many equal increments, both sides free."""
    size = DURATION / block.increments
    controls = Controls(
        initial_increment=size, minimum_increment=size, maximum_increment=size, residual_tolerance=1e-12, extrapolation="none"
    )  # fmt: skip
    targets = {"33": 1.0 - block.compaction, "11": 0.0, "22": 0.0}
    step = Step(DURATION, targets, {"11": "S", "22": "S"})
    history = drive(umat.library, list(constants.values()), len(umat.manifest["statev"]), [step], controls)
    if not history.completed:
        raise RunError(f"the driver did not finish {block.name}: {history.message}")
    return float(history.deformation_gradient[-1, 1, 1])


def second_piola(gradient: Array, stress: Array) -> Array:
    """Second Piola-Kirchhoff stress (n, 3, 3) of deformation gradients (n, 3, 3) and Cauchy stress (n, 6), MPa."""
    cauchy = np.zeros_like(gradient)
    for k, (i, j) in enumerate(VOIGT):
        cauchy[:, i, j] = cauchy[:, j, i] = stress[:, k]
    inverse = np.linalg.inv(gradient)
    return np.asarray(np.linalg.det(gradient)[:, None, None] * (inverse @ cauchy @ inverse.transpose(0, 2, 1)))


def made_with(scene: str) -> dict[str, str]:
    """What rows were made with."""
    return {
        "scene": scene,
        "plyflow": package_version(),
        "OpenGeoSys": metadata.version("ogs"),
        "compiler": f"{compiler_version()} {' '.join(FLAGS)}",
        "constants": f"the scene's defaults, kappa = {STIFF:g} MPa ({SOFT:g} in held blocks); {DURATION:g} s, increments of at most "
        f"{DURATION / Block('').increments:g} s",
    }


KEY = (
    "inc. and rej.: increments accepted and rejected; it. and most: iterations of an increment, mean and largest; off: width of the "
    "driver less that of the block; points: largest difference of stress or state from the driver's"
)


def table(scene: str, rows: Sequence[BlockRow]) -> Table:
    """The rows as a table."""
    columns = (
        Column("block"), Column("inc.", "d"), Column("rej.", "d"), Column("it.", ".1f"), Column("most", "d"),
        Column("h/h0", ".4f"), Column("width", ".6f"), Column("off", ".0e"), Column("points", ".0e"),
    )  # fmt: skip
    shown = [
        (r.job, r.increments, r.rejected, r.iterations, r.most_iterations, r.thickness, r.width,
         None if r.width_driver is None else r.width_driver - r.width, r.difference)
        for r in rows
    ]  # fmt: skip
    return Table(columns, shown, f"{scene} in OpenGeoSys")
