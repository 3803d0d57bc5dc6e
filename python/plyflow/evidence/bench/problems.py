"""What is solved in the bench: programmes of the plate's load, and a plate of prescribed speed, with their exact answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from plyflow.case.case import Case, driver_steps, law_parameters, property_values
from plyflow.driver.drive import Controls, History, Step
from plyflow.law import integrate
from plyflow.law.equations import Stage, log_viscosity
from plyflow.run.case_run import case_controls

Array = NDArray[np.float64]
SPEED_DURATION = 600.0  # s
SPEED_THICKNESS = 0.8  # thickness over initial thickness at the end
REFINEMENTS = (0.3, 1.0, 3.0, 10.0)
LARGEST = (240.0, 120.0, 60.0, 40.0, 20.0, 10.0, 5.0)  # s
TOLERANCES = (1e-2, 1e-3, 1e-4)
FIRST_INCREMENT, EASY = 1.0, {"easy_in_a_row": 1, "easy_iterations": 8}  # s
# Wide enough that every scheme is seen at its best: the creep-exact one with few increments as long as the load allows, the
# backward difference with even ones on a slow ramp and graded ones in a dwell, the paper's tangent where it has no far way to go.
FAMILIES = {
    "growth": "grown by a factor from 0.01 s to 20 s, all shorter by the refinement that is named",
    "largest": "grown fourfold from 1 s up to the named largest increment in s",
    "jump": "one increment of 1 s, then the named largest one in s",
    "tolerance": "by a strain tolerance, from 1 s",
    "equal": "as many equal ones",
}
MOST_INCREMENTS = 5000  # a run that needs more has lost its way
COUNTS = (10, 30, 100, 300, 1000)
QUANTITIES = {
    "thickness": "final thickness, relative",
    "history": "whole history of h/h0, root mean square over time",
    "width": "final width, relative",
    "stress": "plate stress, relative, root mean square over time",
}


@dataclass(frozen=True)
class Control:
    """A step control at one level: family (how it steps), label, the driver's settings."""

    family: str
    level: float
    controls: Controls

    @property
    def label(self) -> str:
        """Family and level."""
        return f"{self.family} {self.level:g}"


@dataclass(frozen=True)
class Problem:
    """A case under its load ("load"), or compacted at constant plate speed ("speed")."""

    name: str
    case: Case
    kind: str = "load"

    @property
    def label(self) -> str:
        """For titles."""
        how = self.case.load if self.kind == "load" else f"constant plate speed to h/h0 = {SPEED_THICKNESS:g}"
        return f"{self.case.material} {self.case.temperature:g} degC {self.case.layup} {self.case.width:g} mm, {how}"

    @property
    def quantities(self) -> tuple[str, ...]:
        """Errors that this problem measures."""
        return ("thickness", "history", "width") if self.kind == "load" else ("stress", "width")

    def steps(self) -> list[Step]:
        """The driver's steps."""
        if self.kind == "load":
            return driver_steps(self.case.load_programme)
        targets = {"11": 1.0, "22": 0.0, "33": SPEED_THICKNESS, "12": 0.0, "13": 0.0, "23": 0.0}
        return [Step(SPEED_DURATION, targets, {"22": "S"})]

    def step_controls(self, **more: Any) -> list[Control]:
        """Every step control and level."""
        more = {"max_increments": MOST_INCREMENTS, **more}
        if self.kind == "speed":
            sizes = {n: SPEED_DURATION / n for n in COUNTS}
            equal = {"growth": 1e6, "easy_in_a_row": 1, **more}
            return [Control("equal", n, Controls(initial_increment=size, maximum_increment=size, **equal))
                    for n, size in sizes.items()]  # fmt: skip
        from_one = {"initial_increment": FIRST_INCREMENT, **EASY, **more}
        return [
            *(Control("growth", r, replace(case_controls(r), **more)) for r in REFINEMENTS),
            *(Control("largest", size, Controls(maximum_increment=size, growth=4.0, **from_one)) for size in LARGEST),
            *(Control("jump", size, Controls(maximum_increment=size, growth=1e3, **from_one)) for size in LARGEST[:4]),
            *(Control("tolerance", t, Controls(strain_tolerance=t, growth=10.0, **from_one)) for t in TOLERANCES),
        ]

    def errors(self, history: History, locked: NDArray[np.bool_], reference: Reference) -> dict[str, float]:
        """Errors of a finished run; `locked` (n,) is the state variable of that name at each row."""
        thickness, width = (np.asarray(history.deformation_gradient[:, i, i], dtype=float) for i in (2, 1))
        width_off = abs(float(width[-1] / reference.width_end) - 1.0)
        if self.kind == "speed":
            exact = reference.plate_stress(thickness, locked)
            square = (history.stress[1:, 2] / exact[1:] - 1.0) ** 2
            return {"stress": float(np.sqrt(np.sum(square * history.increment[1:]) / history.time[-1])), "width": width_off}
        exact = reference.thickness(history.time)
        square = (thickness - exact) ** 2
        return {
            "thickness": abs(float(thickness[-1] / exact[-1]) - 1.0),
            "history": float(np.sqrt(np.trapezoid(square, history.time) / history.time[-1])),
            "width": width_off,
        }


class Reference:
    """The one-dimensional law (by quadrature, exact to about 1e-13) of a problem.

    Parameters
    ----------
    problem : the problem.
    values : PROPS by name.
    times : every time [s] at which it will be asked.
    """

    def __init__(self, problem: Problem, values: Mapping[str, float], times: Array) -> None:
        self._law = law_parameters(values)
        self.width_end = float(np.exp(-self._law.eps_lock))  # ratio [-]; at a plate speed the lock is passed
        self._times, self._thickness = np.zeros(1), np.ones(1)
        if problem.kind == "load":
            load = problem.case.load_programme
            self._times = np.unique(np.clip(times, 0.0, load.end))
            history = integrate(self._law, load, self._times)
            self._thickness, self.width_end = np.asarray(history.thickness_ratio, dtype=float), float(history.width_ratio[-1])

    def thickness(self, times: Array) -> Array:
        """h/h0 (n,) at times announced before."""
        places = np.searchsorted(self._times, np.clip(times, 0.0, self._times[-1]))
        return np.asarray(self._thickness[places], dtype=float)

    def plate_stress(self, thickness: Array, locked: NDArray[np.bool_]) -> Array:
        """Cauchy stress (n,) in MPa at constant plate speed (Eqs. 1 to 5); the stage is that of the row."""
        eps = np.log(thickness)
        rate = (1.0 - SPEED_THICKNESS) / SPEED_DURATION / thickness
        stages = [log_viscosity(eps, self._law, stage) for stage in (Stage.SQUEEZE, Stage.BLEED)]
        return np.asarray(-np.exp(np.where(locked, stages[1], stages[0])) * rate ** (self._law.a + 1.0), dtype=float)


def problems(quick: bool) -> list[Problem]:
    """The chosen cases: a blocked stack with a fast start, a thin ply under a slow ramp, a cold one, a plate speed.

    A quick session has the programmes only.
    """
    blocked = Case("IM7-8552", 70, "BP", 15)
    slow, cold = Case("IMA-M21", 70, "CP", 30, "monotonic"), Case("IM7-8552", 30, "CP", 15)
    loads = [Problem("blocked", blocked), Problem("slow", slow), Problem("cold", cold)]
    return loads if quick else [*loads, Problem("speed", blocked, "speed")]


def values_for(problem: Problem, manifest: Mapping[str, Any]) -> dict[str, float]:
    """PROPS by name for a scene; a multiplier scene is let through, because the bench solves with one.

    Raises
    ------
    InputError
        The scene cannot carry the problem.
    """
    device = manifest["scene"]["incompressibility"].replace("none", "penalty")
    return property_values(problem.case, {**manifest, "scene": {**manifest["scene"], "incompressibility": device}})
