"""Does a scene run in CalculiX as it runs in the driver? The jobs of `scenarios`, with what they must meet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from plyflow.driver.drive import Controls, History, Step, drive
from plyflow.errors import RunError
from plyflow.hosts.abaqus.deck import MaterialCard
from plyflow.hosts.calculix import compare, scenarios
from plyflow.hosts.calculix.faces import Face, adapter_face, library_name, native_face
from plyflow.hosts.calculix.job import JobResult, run_job
from plyflow.umat.library import UmatLibrary
from plyflow.umat.prepare import prepare_umat
from plyflow.umat.scenes import find_scene

Array = NDArray[np.float64]
PRINTED_DIGITS = 6e-7  # CalculiX prints seven digits
FIRST_INCREMENT = 3e-5
FROM_PRINTED_DISPLACEMENTS = 3e-5  # the driver is then fed with displacements of seven digits
ACROSS_THE_LOCK = 1e-3
NARROWEST_BLEND = 5e-3  # of which an increment of 1e-3 sees enough
MOST_ITERATIONS = 5


@dataclass(frozen=True)
class Material:
    """What the checks need of a scene: manifest, values of the constants in its order, compiled UMAT."""

    manifest: Mapping[str, Any]
    values: Sequence[float]
    library: UmatLibrary

    @property
    def n_statev(self) -> int:
        """Number of state variables."""
        return len(self.manifest["statev"])

    def card(self, face: Face) -> str:
        """The material card for CalculiX."""
        manifest = self.manifest
        return MaterialCard(face.material, self.values, manifest["props"], manifest["statev"], False).text("calculix")

    def with_values(self, **changes: float) -> Material:
        """The same material with some constants changed."""
        names = [row["name"] for row in self.manifest["props"]]
        values = [changes.get(name, value) for name, value in zip(names, self.values, strict=True)]
        return Material(self.manifest, values, self.library)


@dataclass(frozen=True)
class CheckRow:
    """One job: iterations of its worst increment, cutbacks, difference from the driver, what failed if anything."""

    job: str
    door: str
    iterations: int
    cutbacks: int
    difference: float | None
    remark: str
    passed: bool


def check_scene(name: str, folder: Path) -> Iterator[CheckRow]:
    """Run all jobs of a scene through both doors, with the manifest's default constants.

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
    defaults = [float(row["default"]) for row in umat.manifest["props"]]
    material = Material(umat.manifest, defaults, umat.library)
    yield from check_face(material, native_face(scene), "native", folder)
    adapter = adapter_face(umat.source, f"{library_name(scene)}NL")
    yield from check_face(material, adapter, "adapter", folder)


def check_face(material: Material, face: Face, door: str, folder: Path) -> Iterator[CheckRow]:
    """Run all jobs of one face; the laminate only through the native door, which alone knows *ORIENTATION.

    Parameters
    ----------
    door
        "native", or "adapter". Every increment is held to `MOST_ITERATIONS` iterations; behind the adapter the first
        one of a step is not: CalculiX does not tell its linear guess apart there, and the tangent at rest is stiff.
    """
    times = [float(t) for t in range(1, 21)]
    for scenario, steps in _homogeneous(times):
        result = _run(scenario, material, face, folder)
        history = compare.drive_increments(material.library, material.values, material.n_statev, steps)
        histories = {(1, point): history for point in range(1, 9)}
        yield _row(scenario.name, door, result, _compared(result, material, histories), PRINTED_DIGITS)
    scene = material.manifest["scene"]
    if scene["lock"] == "blend" and scene["blend_width"] >= NARROWEST_BLEND:
        yield check_locking(material, face, door, folder)
    softer = material.with_values(kappa=100.0)
    for scenario in (scenarios.twist(), scenarios.bend()):
        result = _run(scenario, softer, face, folder)
        mesh = scenario.make(softer.card(face), face.material).mesh
        histories = compare.histories_of_mesh(result, mesh, softer.library, softer.values, softer.n_statev)
        yield _row(scenario.name, door, result, _compared(result, softer, histories), FROM_PRINTED_DISPLACEMENTS)
    if door == "native":
        yield check_laminate(softer, face, folder)


def check_locking(material: Material, face: Face, door: str, folder: Path) -> CheckRow:
    """Across a blended lock in 100 increments; there the stress follows the smallest change of the width."""
    times = [0.2 * n for n in range(1, 101)]
    pressed = np.array([np.diag([1.0, 1.0, 1.0 - 0.1 * time / times[-1]]) for time in times])
    steps = compare.mixed_steps(times, pressed, {"22": 0.0}, ("11", "33"))
    softer = material.with_values(kappa=100.0)
    result = _run(scenarios.locking(-0.1, times[-1], len(times)), softer, face, folder)
    history = compare.drive_increments(softer.library, softer.values, softer.n_statev, steps)
    difference = _compared(result, softer, {(1, point): history for point in range(1, 9)})
    return _row("locking", door, result, difference, ACROSS_THE_LOCK)


def _homogeneous(times: Sequence[float]) -> list[tuple[scenarios.Scenario, list[Step]]]:
    parts = [time / times[-1] for time in times]
    pressed = np.array([np.diag([1.0, 1.0, 1.0 - 0.05 * part]) for part in parts])
    sheared = np.array([np.eye(3) + 0.1 * part * np.outer([0, 1, 0], [0, 0, 1]) for part in parts])
    turned = np.array([scenarios.turned_gradient(0.97, 90.0, part) for part in parts])
    return [
        (scenarios.uniaxial(-0.05), compare.mixed_steps(times, pressed, {"22": 0.0}, ("11", "33"))),
        (scenarios.shear(0.1), compare.mixed_steps(times, sheared, {"33": 0.0}, ("11", "22", "23"))),
        (scenarios.rotation(0.97, 90.0), compare.prescribed_steps(times, turned)),
    ]


def _run(scenario: scenarios.Scenario, material: Material, face: Face, folder: Path) -> JobResult:
    deck = scenario.make(material.card(face), face.material)
    return run_job(scenario.name, deck.text(), [face], folder / face.library)


def _compared(
    result: JobResult, material: Material, histories: Mapping[tuple[int, int], History]
) -> compare.Difference:
    stresses = [
        int(row["index"]) for row in material.manifest["statev"] if row["unit"] == "MPa" and "pressure" in row["name"]
    ]
    return compare.compare_points(result, "BODY", histories, stresses)


def _row(job: str, door: str, result: JobResult, difference: compare.Difference, allowed: float) -> CheckRow:
    remarks = []
    if difference.stress > allowed or difference.statev > allowed:
        remarks.append(f"differs from the driver by {max(difference.stress, difference.statev):.1e} > {allowed:.0e}")
    if difference.first_increment > max(allowed, FIRST_INCREMENT):
        remarks.append(f"first increment differs by {difference.first_increment:.1e} > {FIRST_INCREMENT:.0e}")
    counted = result.most_iterations if door == "native" else result.most_iterations_later
    if counted > MOST_ITERATIONS:
        remarks.append(f"{counted} iterations > {MOST_ITERATIONS}")
    said = "; ".join(remarks)
    if not remarks and result.most_iterations > MOST_ITERATIONS:
        said = f"{counted} iterations after the first increment"
    worst = max(difference.stress, difference.statev)
    return CheckRow(job, door, result.most_iterations, result.cutbacks, worst, said, not remarks)


def check_laminate(material: Material, face: Face, folder: Path) -> CheckRow:
    """Force and widths of the laminate against a slab that slides at its faces, and the driver for its core.

    Without friction every point is compacted as in the driver; with the coefficient m the pressure of a slab of
    thickness h rises from its edge inwards as exp(2 m y / h), so that the mean over the half width a is
    (exp(c) - 1)/c times that at the edge, c = 2 m a / h. The stack's blocks slide in crossed directions, so the
    slab is an estimate: the force has to lie between the driver's and 1.5 times the slab's.
    """
    scenario = scenarios.laminate()
    result = _run(scenario, material, face, folder)
    core = compacted(material, 0.96, 240.0)
    free = -core.stress[-1, 2] * 7.5 * 7.5 * core.deformation_gradient[-1, 1, 1]
    hill = 2 * 0.05 * 7.5 / 0.5
    force = -float(result.tables["TOTAL", "NTOP"].values[-1, 0, 2])
    widths = [
        1.0 + result.tables["U", edge].values[-1, :, axis].mean() / 7.5 for edge, axis in (("AEDGE", 1), ("BEDGE", 0))
    ]
    remarks = []
    if not free < force < 1.5 * free * (np.exp(hill) - 1.0) / hill:
        remarks.append(f"force {force:.4g} N is not between {free:.4g} N and 1.5 times the sliding slab's")
    if max(abs(width - core.deformation_gradient[-1, 1, 1]) for width in widths) > 0.005:
        remarks.append(f"widths {widths[0]:.4f}, {widths[1]:.4f} are not within 0.005 of the driver's")
    if result.most_iterations > MOST_ITERATIONS:
        remarks.append(f"{result.most_iterations} iterations > {MOST_ITERATIONS}")
    said = "; ".join(remarks) or f"force {force / free:.2f} of the frictionless, widths {widths[0]:.4f} {widths[1]:.4f}"
    return CheckRow("laminate", "native", result.most_iterations, result.cutbacks, None, said, not remarks)


def compacted(material: Material, thickness: float, duration: float) -> History:
    """The driver, compacting one point with a free edge."""
    step = Step(duration, {"11": 1.0, "22": 0.0, "33": thickness}, {"22": "S"})
    controls = Controls(initial_increment=1e-2, maximum_increment=duration / 50)
    history = drive(material.library, material.values, material.n_statev, [step], controls)
    if not history.completed:
        raise RunError(f"the driver did not compact the core of the laminate: {history.message}")
    return history
