"""Does a scene run in CalculiX as it runs in the driver? The jobs of `cubes` and the laminate, with what they must meet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from plyflow.driver.drive import Controls, History, Step, drive
from plyflow.errors import RunError
from plyflow.hosts.calculix.compare import compare_points, drive_increments, histories_of_mesh
from plyflow.hosts.calculix.cubes import DURATION, HOMOGENEOUS, INHOMOGENEOUS, CubeJob
from plyflow.hosts.calculix.faces import Face, native_face
from plyflow.hosts.calculix.job import JobResult, run_job
from plyflow.hosts.deck import laminate_deck, material_card
from plyflow.umat.library import UmatLibrary
from plyflow.umat.prepare import Umat, prepare_umat
from plyflow.umat.scenes import find_scene

PRINTED_DIGITS = 6e-7  # CalculiX prints seven digits
FIRST_INCREMENT = 3e-5
FROM_PRINTED_DISPLACEMENTS = 3e-5  # the driver is then fed with displacements of seven digits
MOST_ITERATIONS = 5


@dataclass(frozen=True)
class Material:
    """What the checks need of a scene: manifest, values of the constants in its order, compiled UMAT."""

    manifest: Mapping[str, Any]
    values: Sequence[float]
    library: UmatLibrary

    @classmethod
    def of(cls, umat: Umat) -> Material:
        """A scene with the default constants of its manifest."""
        return cls(umat.manifest, [float(row["default"]) for row in umat.manifest["props"]], umat.library)

    @property
    def n_statev(self) -> int:
        """Number of state variables."""
        return len(self.manifest["statev"])

    @property
    def pressures(self) -> list[int]:
        """State variables, counted from 1, that are a pressure in MPa."""
        rows = self.manifest["statev"]
        return [int(row["index"]) for row in rows if row["unit"] == "MPa" and "pressure" in row["name"]]

    def card(self, face: Face) -> str:
        """The material card for CalculiX."""
        return material_card("calculix", face.material, self.values, self.manifest)

    def with_values(self, **changes: float) -> Material:
        """The same material with some constants changed."""
        names = [row["name"] for row in self.manifest["props"]]
        values = [changes.get(name, value) for name, value in zip(names, self.values, strict=True)]
        return Material(self.manifest, values, self.library)


@dataclass(frozen=True)
class CheckRow:
    """One job: iterations of its worst increment, cutbacks, difference from the driver, what failed if anything."""

    job: str
    iterations: int
    cutbacks: int
    difference: float | None
    remark: str
    passed: bool


def check_scene(name: str, folder: Path) -> Iterator[CheckRow]:
    """Run all jobs of a scene, with the manifest's default constants.

    Raises
    ------
    InputError
        Unknown scene, or one that has no face for CalculiX.
    ToolError
        No compiler, or no CalculiX with external materials.
    RunError
        A job or the driver did not finish.
    """
    scene, umat = find_scene(name), prepare_umat(name)
    yield from check_face(Material.of(umat), native_face(scene), folder)


def check_face(material: Material, face: Face, folder: Path) -> Iterator[CheckRow]:
    """Run all jobs of one face."""
    softer = material.with_values(kappa=100.0)
    for job in HOMOGENEOUS:
        yield check_cube(job, material, face, folder, PRINTED_DIGITS)
    for job in INHOMOGENEOUS:
        yield check_cube(job, softer, face, folder, FROM_PRINTED_DISPLACEMENTS)
    yield check_laminate(softer, face, folder)


def check_cube(job: CubeJob, material: Material, face: Face, folder: Path, allowed: float) -> CheckRow:
    """One job on a cube, every point beside the driver; `allowed` relative difference from the second increment on."""
    result = run_job(job.name, job.deck(material.card(face), face.material), [face], folder / face.library)
    umat = material.library, material.values, material.n_statev
    if job.gradient is None:
        histories = histories_of_mesh(result, job.mesh, *umat)
    else:
        times = np.linspace(0.0, DURATION, job.increments + 1)[1:]
        history = drive_increments(*umat, times, np.array([job.gradient(time) for time in times]), job.free)
        histories = {(1, point): history for point in range(1, 9)}
    difference = compare_points(result, "BODY", histories, material.pressures)
    remarks = []
    if difference.later > allowed:
        remarks.append(f"differs from the driver by {difference.later:.1e} > {allowed:.0e}")
    if difference.first_increment > max(allowed, FIRST_INCREMENT):
        remarks.append(f"first increment differs by {difference.first_increment:.1e} > {FIRST_INCREMENT:.0e}")
    return _row(job.name, result, difference.later, remarks, "")


def _row(job: str, result: JobResult, difference: float | None, remarks: list[str], passed: str) -> CheckRow:
    """Row of a job with what it missed, too many iterations included, or with what is said of one that passed."""
    if result.most_iterations > MOST_ITERATIONS:
        remarks = [*remarks, f"{result.most_iterations} iterations > {MOST_ITERATIONS}"]
    said = "; ".join(remarks) or passed
    return CheckRow(job, result.most_iterations, result.cutbacks, difference, said, not remarks)


def check_laminate(material: Material, face: Face, folder: Path) -> CheckRow:
    """Force and widths of the laminate against a slab that slides at its faces, and the driver for its core.

    Without friction every point is compacted as in the driver; with the coefficient m the pressure of a slab of
    thickness h rises from its edge inwards as exp(2 m y / h), so that the mean over the half width a is
    (exp(c) - 1)/c times that at the edge, c = 2 m a / h. The stack's blocks slide in crossed directions, so the
    slab is an estimate: the force has to lie between the driver's and 1.5 times the slab's.
    """
    deck = laminate_deck("calculix", material.card(face), face.material, cells=(3, 3, 1))
    result = run_job("laminate", deck, [face], folder / face.library)
    core = compacted(material, 0.96, 240.0)
    widened = core.deformation_gradient[-1, 1, 1]
    free = -core.stress[-1, 2] * 7.5 * 7.5 * widened
    hill = 2 * 0.05 * 7.5 / 0.5
    force, widths = force_and_widths(result)
    remarks = []
    if not free < force < 1.5 * free * (np.exp(hill) - 1.0) / hill:
        remarks.append(f"force {force:.4g} N is not between {free:.4g} N and 1.5 times the sliding slab's")
    if max(abs(width - widened) for width in widths) > 0.005:
        remarks.append(f"widths {widths[0]:.4f}, {widths[1]:.4f} are not within 0.005 of the driver's")
    said = f"force {force / free:.2f} of the frictionless, widths {widths[0]:.4f} {widths[1]:.4f}"
    return _row("laminate", result, None, remarks, said)


def force_and_widths(result: JobResult) -> tuple[float, list[float]]:
    """Force of the plate on a quarter of the laminate in N, and the width ratios of both blocks."""
    edges = (("AEDGE", 1), ("BEDGE", 0))
    widths = [1.0 + float(result.tables["U", edge].values[-1, :, axis].mean()) / 7.5 for edge, axis in edges]
    return -float(result.tables["TOTAL", "NTOP"].values[-1, 0, 2]), widths


def compacted(material: Material, thickness: float, duration: float) -> History:
    """The driver, compacting one point with a free edge."""
    step = Step(duration, {"11": 1.0, "22": 0.0, "33": thickness}, {"22": "S"})
    controls = Controls(initial_increment=1e-2, maximum_increment=duration / 50)
    history = drive(material.library, material.values, material.n_statev, [step], controls)
    if not history.completed:
        raise RunError(f"the driver did not compact the core of the laminate: {history.message}")
    return history
