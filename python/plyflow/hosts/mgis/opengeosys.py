"""One block in OpenGeoSys: its meshes and project file, the run, and what came out at the integration points."""

from __future__ import annotations

import os
import re
import subprocess
import sysconfig
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from plyflow.errors import RunError, ToolError
from plyflow.files import write_files
from plyflow.hosts.deck import render
from plyflow.hosts.mesh import Cells, Mesh, Point
from plyflow.hosts.mgis.behaviour import Behaviour
from plyflow.provenance import package_version

Array = NDArray[np.float64]
DURATION = 240.0  # s
TOLERANCE = 1e-11  # of the last correction, relative to the displacements
F_BAR = "element_average"
_SIDES = {f"{'xyz'[axis]}{end}": (axis, side) for axis in range(3) for side, end in enumerate(("low", "high"))}
PIP = "pip install 'plyflow[hosts]'"


@dataclass(frozen=True)
class Block:
    """A block, fibre along x, ply normal along z, its planes x = 0, y = 0 and z = 0 planes of symmetry.

    Parameters
    ----------
    name : of the job.
    cells, size : elements and edges in mm.
    compaction : part of the thickness by which the top comes down at constant speed, or
    pressure : MPa on the undeformed top that grows at constant rate, the top's nodes free; zero: the compaction counts.
    f_bar : whether the volume ratio is averaged over each element.
    sticking : whether top and bottom are held in their plane; else they glide.
    increments : longest increment is `DURATION` by this.
    shortest : part of the longest increment below which OpenGeoSys gives up.
    """

    name: str
    cells: Cells = (1, 1, 1)
    size: Point = (7.5, 7.5, 0.5)
    compaction: float = 0.24
    pressure: float = 0.0
    f_bar: bool = False
    sticking: bool = False
    increments: int = 40
    shortest: float = 1e-6

    @property
    def mesh(self) -> Mesh:
        """The mesh, a block BODY."""
        made = Mesh()
        made.add_block("BODY", self.cells, self.size)
        return made

    @property
    def boundaries(self) -> list[tuple[str, int, str, str]]:
        """Side, component, type and parameter of each boundary condition."""
        held = [("xlow", 0), ("ylow", 1), ("zlow", 2)]
        held += [(side, axis) for side in ("zlow", "zhigh") for axis in (0, 1)] if self.sticking else []
        top = ("zhigh", 2, "Neumann" if self.pressure else "Dirichlet", "ramp")
        return [*((side, axis, "Dirichlet", "zero") for side, axis in held), top]


@dataclass(frozen=True)
class BlockResult:
    """What OpenGeoSys left; row 0 is the start, then a row an increment, p integration points.

    Parameters
    ----------
    time : (n,) s.
    gradient : (n, p, 3, 3) deformation gradients as the material got them; stress : (n, p, 3, 3) second Piola-Kirchhoff, MPa.
    state : by name (n, p).
    iterations : (n - 1,) of the accepted increments; rejected : attempts that failed.
    """

    time: Array
    gradient: Array
    stress: Array
    state: Mapping[str, Array]
    iterations: NDArray[np.int64]
    rejected: int


def find_ogs() -> Path | None:
    """The program that the wheel `ogs` brings, None if the wheel is not installed."""
    program = Path(sysconfig.get_path("scripts")) / "ogs"
    return program if find_spec("ogs") and program.is_file() else None


def require_ogs() -> Path:
    """`find_ogs`, or an error that says how to get it; meshio is looked for too.

    Raises
    ------
    ToolError
        One of them is missing.
    """
    program = find_ogs()
    for name, found in (("OpenGeoSys (ogs)", program), ("meshio", find_spec("meshio"))):
        if found is None:
            raise ToolError(f"{name} is not installed, which runs of MGIS behaviours need; install it with: {PIP}")
    return Path(str(program))


def run_block(
    block: Block, behaviour: Behaviour, library: Path, constants: Mapping[str, float], folder: Path, timeout: float = 900.0
) -> BlockResult:
    """Write a block's files into a folder and run OpenGeoSys on them.

    Raises
    ------
    ToolError
        OpenGeoSys or meshio is not installed.
    RunError
        OpenGeoSys gave up or took more than `timeout` seconds; the message quotes its last words and names the log.
    """
    program = require_ogs()
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("out*"):
        old.unlink()
    _write_meshes(block, folder)
    write_files(folder, {"block.prj": project(block, behaviour, library, constants)})
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    log = folder / "block.log"
    try:
        with log.open("w") as stream:
            ended = subprocess.run(
                [str(program), "block.prj", "-o", "."], cwd=folder, stdout=stream, stderr=subprocess.STDOUT, check=False,
                timeout=timeout, env=environment,
            )  # fmt: skip
    except subprocess.TimeoutExpired as error:
        raise RunError(f"OpenGeoSys took more than {timeout:g} s for {block.name} and was stopped; its log is {log}") from error
    text = log.read_text(errors="replace")
    if ended.returncode != 0:
        said = [line for line in text.splitlines() if re.match(r"(critical|error)|\S+ UMAT:", line)]
        raise RunError(f"OpenGeoSys did not finish {block.name}: {' | '.join(said[-3:])}; its log is {log}")
    return _read(folder, text, behaviour)


def project(block: Block, behaviour: Behaviour, library: Path, constants: Mapping[str, float]) -> str:
    """Text of the project file."""
    return render(
        "ogs.prj.j2",
        version=package_version(),
        meshes=["block", *_SIDES],
        behaviour=behaviour.name,
        library=library.resolve(),
        f_bar=F_BAR if block.f_bar else "none",
        constants=constants,
        statev=behaviour.manifest["statev"],
        tolerance=TOLERANCE,
        duration=DURATION,
        increment=DURATION / block.increments,
        shortest=block.shortest * DURATION / block.increments,
        final=block.pressure or block.compaction * block.size[2],
        boundaries=block.boundaries,
    )


def _write_meshes(block: Block, folder: Path) -> None:
    """The block and its six sides, which OpenGeoSys wants with the numbers they have in the block, from 0."""
    import meshio  # noqa: PLC0415 - part of an extra

    mesh = block.mesh
    points = np.array([mesh.nodes[node] for node in sorted(mesh.nodes)])
    cells = np.array([mesh.elements[element] for element in sorted(mesh.elements)]) - 1
    materials = {"MaterialIDs": [np.zeros(len(cells), dtype=np.int32)]}
    meshio.write(folder / "block.vtu", meshio.Mesh(points, [("hexahedron", cells)], cell_data=materials))
    for name, (axis, side) in _SIDES.items():
        grid = np.take(mesh.grids["BODY"], -side, axis=2 - axis) - 1
        corners = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], axis=-1).reshape(-1, 4)
        nodes = np.sort(grid.ravel())
        made = meshio.Mesh(
            points[nodes],
            [("quad", np.searchsorted(nodes, corners))],
            point_data={"bulk_node_ids": nodes.astype(np.uint64)},
            cell_data={"bulk_element_ids": [np.array(mesh.face("BODY", axis, side)[0], dtype=np.uint64) - np.uint64(1)]},
        )
        meshio.write(folder / f"{name}.vtu", made)


def _read(folder: Path, log: str, behaviour: Behaviour) -> BlockResult:
    import meshio  # noqa: PLC0415

    listed = re.findall(r'timestep="([^"]+)"[^>]*file="([^"]+)"', (folder / "out.pvd").read_text())
    fields = [meshio.read(folder / name).field_data for _, name in listed]
    time = np.array([float(at) for at, _ in listed])
    attempts = re.split(r"Time step #\d+ started", log)[2:]
    steps = [part.count("] Iteration #") for part in attempts]
    accepted = ["Output of timestep" in part for part in attempts]
    gradient = _at_points(fields, "deformation_gradient").reshape(len(time), -1, 3, 3)
    gradient[0] = np.eye(3)  # the start is written before any point was looked at
    state = {row["name"]: _at_points(fields, f"material_state_variable_{row['name']}") for row in behaviour.manifest["statev"]}
    return BlockResult(
        time, gradient, _tensors(_at_points(fields, "sigma")), state, np.array(steps)[accepted], accepted.count(False)
    )


def _at_points(fields: Sequence[Mapping[str, Array]], name: str) -> Array:
    """A quantity over time at all points; of the start, where some are not yet numbers, zero."""
    values = np.array([field[f"{name}_ip"] for field in fields])
    values[0] = 0.0
    return values


def _tensors(components: Array) -> Array:
    """(..., 3, 3) from OpenGeoSys's six components 11 22 33 12 23 13."""
    result = np.zeros((*components.shape[:-1], 3, 3))
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))):
        result[..., i, j] = result[..., j, i] = components[..., k]
    return result
