"""What a user asks of the driver: steps and the settings of their solution."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from plyflow.errors import InputError

FloatArray = npt.NDArray[np.float64]
Kind = Literal["F", "S", "P"]

COMPONENTS = ("11", "22", "33", "12", "13", "23", "21", "31", "32")
CONTROLLED = COMPONENTS[:6]
# The numbers of driver_kinds.f90 for kinds of control.
_KIND_NUMBER = {"F": 1, "S": 2, "P": 2}


class DriverError(InputError):
    """A step, control or argument outside its bounds; the message names value, bound and remedy."""


@dataclass(frozen=True)
class Step:
    """One step of a programme.

    Parameters
    ----------
    duration
        In s, positive.
    targets
        Value at the end of the step by component: "11", "22", "33", "12", "13", "23" of the upper
        triangular deformation gradient, and "21", "31", "32", which are always prescribed. A component that
        is not mentioned is held at its value at the start of the step.
    kinds
        "F" deformation gradient component (-), "S" Cauchy stress (MPa), "P" plate pressure (MPa), that is
        Cauchy stress = -value. A target without a kind is "F".
    instant
        The targets hold from the first increment on; else they are reached by a linear ramp that starts at
        the value of the step's start.
    temperature
        TEMP at the end of the step, degC, reached by a linear ramp; by default that of its start.

    Raises
    ------
    DriverError
        Unknown component or kind, a stress on 21, 31 or 32, a kind without a target, a value that is not
        finite, a duration that is not positive.
    """

    duration: float
    targets: Mapping[str, float] = field(default_factory=dict)
    kinds: Mapping[str, Kind] = field(default_factory=dict)
    instant: bool = False
    temperature: float | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite(self.duration) and self.duration > 0):
            raise DriverError(f"step duration is {self.duration} s; it must be positive and finite")
        if self.temperature is not None and not np.isfinite(self.temperature):
            raise DriverError(f"step temperature is {self.temperature} degC; it must be finite")
        for component in {**self.targets, **self.kinds}:
            _check_component(component, self.targets, self.kinds.get(component, "F"))

    def numbers(self) -> tuple[npt.NDArray[np.int32], FloatArray]:
        """Kinds (9,) and targets (9,) as the Fortran driver reads them."""
        kinds = np.zeros(9, dtype=np.int32)
        targets = np.zeros(9)
        for index, component in enumerate(COMPONENTS):
            if component in self.targets:
                kind = self.kinds.get(component, "F")
                kinds[index] = _KIND_NUMBER[kind]
                targets[index] = -self.targets[component] if kind == "P" else self.targets[component]
        return kinds, targets


def _check_component(component: str, targets: Mapping[str, float], kind: str) -> None:
    if component not in COMPONENTS:
        raise DriverError(f"unknown component {component!r}; use one of {', '.join(COMPONENTS)}")
    if kind not in _KIND_NUMBER:
        raise DriverError(f"component {component} has kind {kind!r}; use 'F', 'S' or 'P'")
    if component not in targets:
        raise DriverError(f"component {component} has kind {kind!r} but no target; give one")
    if not np.isfinite(targets[component]):
        raise DriverError(f"target of {component} is {targets[component]}; it must be finite")
    if component not in CONTROLLED and kind != "F":
        raise DriverError(f"component {component} cannot take a stress; prescribe {component[::-1]} instead")
    if kind == "P" and component[0] != component[1]:
        raise DriverError(f"component {component} is a shear; a plate pressure acts on 11, 22 or 33: use 'S'")


@dataclass(frozen=True)
class Controls:
    """Settings of increments and iterations.

    Parameters
    ----------
    initial_increment, minimum_increment, maximum_increment
        In s, for every step; `None`: a hundredth, 1e-9 and all of the step's duration. All three equal:
        fixed increments.
    growth, easy_iterations, easy_in_a_row
        The increment grows by `growth` after so many increments in a row with at most `easy_iterations`.
    cut, max_iterations, max_attempts
        Factor after a failed attempt; iterations per attempt; attempts per increment, those that the UMAT
        ended through PNEWDT included, as Abaqus counts with IA.
    max_increments
        Of the whole analysis. Storage grows with the increments done.
    residual_tolerance, load_scale
        Converged when every stress residual is below `residual_tolerance * load_scale`. `None`: the largest
        stress target of the whole history (without any, the largest current stress).
    rounding_tolerance
        Residual that is accepted once a Newton correction is below the rounding of F (0: never).
    largest_correction
        Bound on the change of a component of F in one iteration.
    newton
        "power" inverts the power law along the last increment; "plain" is Abaqus's.
    extrapolation
        "linear": the last increment of F, scaled, is the first guess (not in a step's first increment).
    strain_tolerance, reject_factor
        Like CETOL of Abaqus's *VISCO: `next = dt * clamp(0.9 sqrt(tolerance / error), 0.25, growth)` with
        the error of predicting the strain increment by the last rate; an increment is rejected only if the
        error exceeds `reject_factor * strain_tolerance` (0: never). `None`: off.
    incompressible, constraint_release_statev
        Exact multiplier: the pressure is an unknown, det F = 1 an equation, while that state variable
        (counted from 1) is below 0.5 at both ends of the increment; 0: for good.
    tangent_check
        Compare DDSDDE with differences at every so many increments; 0: never.

    Raises
    ------
    DriverError
        A value outside its bounds.
    """

    initial_increment: float | None = None
    minimum_increment: float | None = None
    maximum_increment: float | None = None
    growth: float = 1.5
    cut: float = 0.25
    easy_iterations: int = 4
    easy_in_a_row: int = 2
    max_iterations: int = 16
    max_attempts: int = 5
    max_increments: int = 100_000
    residual_tolerance: float = 1e-6
    load_scale: float | None = None
    rounding_tolerance: float = 1e-3
    largest_correction: float = 0.5
    strain_tolerance: float | None = None
    reject_factor: float = 0.0
    newton: Literal["power", "plain"] = "power"
    extrapolation: Literal["linear", "none"] = "linear"
    incompressible: bool = False
    constraint_release_statev: int = 0
    tangent_check: int = 0

    def __post_init__(self) -> None:
        for name, (low, high) in _CONTROL_BOUNDS.items():
            value = getattr(self, name)
            if value is not None and not low <= value <= high:
                raise DriverError(f"{name} is {value}; it must lie between {low} and {high}")
        for name, choices in _CONTROL_CHOICES.items():
            if getattr(self, name) not in choices:
                raise DriverError(f"{name} is {getattr(self, name)!r}; use one of {', '.join(choices)}")
        sizes = [self.minimum_increment, self.initial_increment, self.maximum_increment]
        given = [size for size in sizes if size is not None]
        if given != sorted(given):
            raise DriverError(
                f"increments minimum, initial, maximum are {sizes} s; they must not decrease in this order"
            )


_TINY = float(np.finfo(float).tiny)
_CONTROL_BOUNDS: dict[str, tuple[float, float]] = {
    **dict.fromkeys(("initial_increment", "minimum_increment", "maximum_increment"), (_TINY, np.inf)),
    **dict.fromkeys(("load_scale", "strain_tolerance"), (_TINY, np.inf)),
    **dict.fromkeys(("easy_in_a_row", "max_iterations", "max_attempts"), (1, 1_000_000)),
    **dict.fromkeys(("easy_iterations", "constraint_release_statev"), (0, 1_000_000)),
    **{"max_increments": (1, 100_000_000), "tangent_check": (0, 1_000_000_000)},
    **{"growth": (1.0, 1e6), "cut": (1e-6, 0.99), "residual_tolerance": (1e-15, 1.0), "rounding_tolerance": (0.0, 1.0)},
    **{"largest_correction": (1e-12, np.inf), "reject_factor": (0.0, np.inf)},
}
_CONTROL_CHOICES = {"newton": ("power", "plain"), "extrapolation": ("linear", "none")}
