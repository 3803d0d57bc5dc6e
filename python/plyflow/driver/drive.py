"""A material point under mixed control: the Python face of the Fortran driver."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, fields
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from plyflow.driver.history import OUTCOMES, FailedIncrement, History, TangentCheck, collect, text_of
from plyflow.driver.steps import COMPONENTS, Controls, DriverError, FloatArray, Kind, Step
from plyflow.errors import ToolError

__all__ = [
    "COMPONENTS",
    "OUTCOMES",
    "Controls",
    "DriverError",
    "FailedIncrement",
    "History",
    "Kind",
    "Library",
    "Step",
    "TangentCheck",
    "UmatAddress",
    "drive",
    "run_case_file",
]

_ONE_CASE_AT_A_TIME = threading.Lock()


class Library(Protocol):
    """What the driver needs of a compiled UMAT; `plyflow.umat.library.UmatLibrary` has it."""

    @property
    def address(self) -> int:
        """Address of the UMAT's entry point."""

    @property
    def standin_address(self) -> int:
        """Address of the accessor of its messages; 0 if there is none."""


@dataclass(frozen=True)
class UmatAddress:
    """The address of any UMAT, for callers without a `UmatLibrary`."""

    address: int
    standin_address: int = 0
    path: str = ""


def drive(
    library: Library,
    props: Sequence[float] | FloatArray,
    n_statev: int,
    steps: Sequence[Step],
    controls: Controls | None = None,
    *,
    temperature: float = 0.0,
    statev: Sequence[float] | FloatArray | None = None,
    deformation_gradient: FloatArray | None = None,
    stress: Sequence[float] | FloatArray | None = None,
    material_name: str = "PLYFLOW",
    ntens: int = 6,
    corotated: bool = False,
    replay: Path | None = None,
) -> History:
    """Take a material point through a programme with the UMAT's own tangent.

    Parameters
    ----------
    library
        The compiled UMAT.
    props, n_statev
        Its constants (n_props,) and number of state variables.
    steps, controls
        The programme and the settings of its solution.
    temperature
        TEMP at the start, degC; it stays but for steps with a temperature of their own.
    statev, deformation_gradient, stress
        Start: (n_statev,) default 0; (3, 3) default identity; Cauchy stress (6,) in MPa, default 0.
    material_name
        CMNAME, at most 80 characters.
    ntens
        6, or 4: the UMAT is called with NDI = 3, NSHR = 1 as in plane strain and axisymmetric elements.
    corotated
        Call the UMAT in the basis that turns with the material, as Abaqus does with *ORIENTATION.
    replay
        If an increment fails, write the case file that repeats it here; `run_case_file` and the executable
        plyflow-driver read it. The library must know its `path`.

    Returns
    -------
    History
        Also if the programme could not be finished: see `completed`, `message` and `failure`.

    Raises
    ------
    DriverError
        An argument outside its bounds.
    """
    controls = controls or Controls()
    constants = _vector("props", props)
    start = _start(n_statev, statev, deformation_gradient, stress)
    _check_call(library, n_statev, steps, controls, material_name, ntens)
    _check_deformations(start[0], steps)
    library_path = str(getattr(library, "path", ""))
    if replay is not None and not library_path:
        raise DriverError("a replay file needs the library's path; use a UmatLibrary, or UmatAddress(path=...)")
    with _ONE_CASE_AT_A_TIME:
        driver = binding("driver_binding")
        driver.begin_case(
            library.address, library.standin_address, material_name, len(constants), constants, n_statev, ntens,
            int(corotated), temperature,
        )  # fmt: skip
        _pass_controls(driver, controls)
        gradient, start_stress, start_statev = start
        driver.set_start(np.asfortranarray(gradient), start_stress, n_statev, start_statev)
        for step in steps:
            kinds, targets = step.numbers()
            heated = step.temperature is not None
            driver.add_step(step.duration, kinds, targets, int(step.instant), int(heated), step.temperature or 0.0)
        return _run(driver, replay, library_path)


def run_case_file(path: Path | str) -> History:
    """Run a case file of the executable plyflow-driver (a replay file is one) in this process.

    Parameters
    ----------
    path
        The case; driver/README.md describes the format. Of its outputs nothing is written.

    Raises
    ------
    DriverError
        The case cannot be read, or its UMAT cannot be loaded: file, line, what is wrong.
    """
    with _ONE_CASE_AT_A_TIME:
        driver = binding("driver_binding")
        if not driver.load_case_file(str(path)):
            message, _ = driver.get_message()
            raise DriverError(text_of(message))
        return _run(driver, None, "")


def binding(module: str) -> Any:
    """A module of the Fortran library, driver_binding or driver_batch.

    Raises
    ------
    ToolError
        The library is not built.
    """
    try:
        return import_module(f"plyflow.driver_library.{module}")
    except ImportError as error:
        raise ToolError(
            f"the Fortran driver is not built ({error}); install the package with pip, which compiles it"
        ) from error


def _run(binding: Any, replay: Path | None, library_path: str) -> History:
    begin = time.process_time()
    completed = bool(binding.run_case())
    history = collect(binding, completed, time.process_time() - begin)
    if (
        replay is not None
        and history.failure is not None
        and not binding.write_replay_file(str(replay), library_path, "umat_")
    ):
        raise DriverError(f"the replay file {replay} cannot be written; name a file in a writable folder")
    return history


def _vector(name: str, values: Sequence[float] | FloatArray, size: int | None = None) -> FloatArray:
    array = np.ascontiguousarray(values, dtype=float).reshape(-1)
    if size is not None and array.size != size:
        raise DriverError(f"{name} has {array.size} values; {size} are needed")
    if not np.all(np.isfinite(array)):
        raise DriverError(f"{name}[{int(np.argmin(np.isfinite(array)))}] is not finite; give finite numbers")
    return array


def _start(
    n_statev: int,
    statev: Sequence[float] | FloatArray | None,
    deformation_gradient: FloatArray | None,
    stress: Sequence[float] | FloatArray | None,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    if not 0 <= n_statev <= 100_000:
        raise DriverError(f"n_statev is {n_statev}; it must lie between 0 and 100000")
    gradient = np.eye(3) if deformation_gradient is None else np.array(deformation_gradient, dtype=float)
    if gradient.shape != (3, 3) or not np.all(np.isfinite(gradient)) or np.linalg.det(gradient) <= 0:
        raise DriverError("deformation_gradient at the start must be a finite (3, 3) matrix with det > 0")
    return (
        gradient,
        _vector("stress", np.zeros(6) if stress is None else stress, 6),
        _vector("statev", np.zeros(n_statev) if statev is None else statev, n_statev),
    )


def _check_call(
    library: Library, n_statev: int, steps: Sequence[Step], controls: Controls, material_name: str, ntens: int
) -> None:
    if not library.address:
        raise DriverError("the UMAT's address is 0; load its library first")
    if not steps:
        raise DriverError("the programme has 0 steps; give at least one Step")
    if len(material_name) > 80:
        raise DriverError(f"material_name has {len(material_name)} characters; at most 80 fit in CMNAME")
    if ntens not in (4, 6):
        raise DriverError(f"ntens is {ntens}; use 6, or 4 for plane strain and axisymmetric calls")
    if controls.constraint_release_statev > n_statev:
        raise DriverError(
            f"constraint_release_statev is {controls.constraint_release_statev}; there are {n_statev} state variables"
        )
    for number, step in enumerate(steps, start=1):
        stressed = [component for component, kind in step.kinds.items() if kind != "F"]
        if controls.incompressible and not stressed:
            raise DriverError(
                f"step {number} prescribes no stress; the incompressibility multiplier needs a component free"
            )
        if ntens == 4 and {"13", "23"} & set(stressed):
            raise DriverError(f"step {number} prescribes a stress on 13 or 23, which ntens = 4 does not have")


def _check_deformations(start: FloatArray, steps: Sequence[Step]) -> None:
    """Refuse a step that ends at a singular or inverted F, where all of F is prescribed."""
    gradient = start.copy()
    for number, step in enumerate(steps, start=1):
        for component, target in step.targets.items():
            known = step.kinds.get(component, "F") == "F"
            gradient[int(component[0]) - 1, int(component[1]) - 1] = target if known else np.nan
        if np.isnan(gradient).any():
            continue
        determinant = float(np.linalg.det(gradient))
        if determinant <= 0.0:
            raise DriverError(
                f"step {number} ends at det F = {determinant:.3g}; it must be positive: check the targets"
            )


def _pass_controls(binding: Any, controls: Controls) -> None:
    """By name and as text, as in a case file: repr gives every digit."""
    values = {f.name: getattr(controls, f.name) or 0 for f in fields(controls)}
    switches = {
        "power_newton": values.pop("newton") == "power",
        "extrapolate": values.pop("extrapolation") == "linear",
        "incompressible": values.pop("incompressible"),
    }
    texts = {name: repr(min(float(value), 1e300)) for name, value in values.items()}
    for name, text in (texts | {name: "yes" if on else "no" for name, on in switches.items()}).items():
        if not binding.set_one_control(name, text):
            raise DriverError(text_of(binding.get_message()[0]))
