"""What the cells are about: compiled scenes, materials, what is run on them, and the account of it all."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar, TypeVarTuple

import numpy as np
from numpy.typing import ArrayLike

from plyflow.case.case import PLY_KINDS, Case, driver_steps, property_values, props_vector
from plyflow.case.materials import known_materials
from plyflow.driver.drive import Controls, History, Step, drive
from plyflow.evidence.stability.ledger import Ledger
from plyflow.evidence.stability.tensors import Array
from plyflow.run.case_run import case_controls
from plyflow.umat import compile as compiling
from plyflow.umat.library import CallResult, QuadLibrary, UmatLibrary
from umatgen.scene import SCENES, Scene

LOCKED = 4
SEED = 20160301
ALL_SCENES = {
    **SCENES,
    "floor": Scene(name="floor", first_tangent="floor"),
    "bdf1 augmented": Scene(name="bdf1aug", integrator="bdf1", incompressibility="augmented"),
}
NOTHING = dict.fromkeys(("11", "22", "33", "12", "13", "23"), 0.0)
Values = dict[str, float]
T = TypeVar("T")
Ts = TypeVarTuple("Ts")


class RefusedError(Exception):
    """A programme that did not end; the text is the message."""


@dataclass(frozen=True)
class Column:
    """One material [name] at one temperature [degC]."""

    material: str
    temperature: float

    @property
    def label(self) -> str:
        """Name of the column in the table."""
        return f"{self.material} {self.temperature:g}"

    def case(self, layup: str = "BP", width: float = 15.0, load: str = "ramp-dwell") -> Case:
        """Case of the programme; the thickest block unless told."""
        return Case(self.material, self.temperature, layup, width, load)

    @property
    def peak(self) -> float:
        """Largest pressure [MPa] of the ramp-dwell programme."""
        return self.case().load_programme.peak


@dataclass(frozen=True)
class Run:
    """PROPS by name and what the driver made of a programme with them."""

    values: Values
    history: History

    def ended(self) -> Run:
        """Refuse a run that did not end (`RefusedError`, with its message)."""
        if not self.history.completed:
            raise RefusedError(self.history.message)
        return self

    @property
    def locked(self) -> Array:
        """Lock indicator (n,)."""
        return self.history.statev[:, LOCKED]

    @property
    def thickness(self) -> float:
        """h/h0 [-] at the end."""
        return float(self.history.deformation_gradient[-1, 2, 2])

    @property
    def width_error(self) -> float:
        """Relative error of the final width beside exp(-eps_lock); infinite where the ply has not locked."""
        if self.locked[-1] == 0.0:
            return float("inf")
        return float(abs(self.history.deformation_gradient[-1, 1, 1] * np.exp(self.values["eps_lock"]) - 1.0))

    @property
    def volume_change(self) -> float:
        """Largest |J - 1| up to the lock [-]."""
        squeezing = self.history.deformation_gradient[self.locked < 1.0]
        return float(np.abs(np.linalg.det(squeezing) - 1.0).max())

    @property
    def worst(self) -> int:
        """Most iterations of an increment."""
        return int(self.history.iterations[1:].max())

    @property
    def failed(self) -> int:
        """Attempts given up, for whatever reason."""
        return sum(self.history.cutbacks_by_reason.values())


class Subject:
    """Compiled scenes by name, made when first asked for, and the account of everything run on them.

    Parameters
    ----------
    quick : bool
        A reduced matrix: fewer cases and fewer random states, the same checks.
    edit : callable, optional
        Change made to every generated source before it is compiled; the tests plant errors with it.
    """

    def __init__(self, quick: bool = False, edit: Callable[[str], str] | None = None) -> None:
        self.quick = quick
        self.ledger = Ledger()
        self.sources: dict[str, str] = {}
        self._edit = edit or (lambda source: source)
        self._kept: dict[tuple[Any, ...], Any] = {}

    def once(self, make: Callable[[Subject, *Ts], T], *arguments: *Ts) -> T:
        """Result of `make` for this subject and some arguments, kept from the first time on."""
        key = (make, *arguments)
        if key not in self._kept:
            self._kept[key] = make(self, *arguments)
        result: T = self._kept[key]
        return result

    def scene(self, name: str = "default") -> tuple[UmatLibrary, dict[str, Any]]:
        """Library and manifest of a scene."""
        return self.once(Subject._compiled, name)

    def _compiled(self, name: str) -> tuple[UmatLibrary, dict[str, Any]]:
        source, manifest, _ = compiling.generate_cached(ALL_SCENES[name])
        self.sources[name] = self._edit(source)
        return UmatLibrary(compiling.compile_umat(self.sources[name])), manifest

    def quad(self, name: str = "default") -> QuadLibrary:
        """The same source with every number in quadruple precision."""
        return self.once(Subject._compiled_quad, name)

    def _compiled_quad(self, name: str) -> QuadLibrary:
        self.scene(name)
        return QuadLibrary(compiling.compile_umat(self.sources[name], compiling.QUAD_FLAGS))

    @property
    def columns(self) -> list[Column]:
        """Both materials at all temperatures of their tables."""
        return [Column(name, at) for name, material in known_materials().items() for at in material.table.temperature]

    def few(self, items: Sequence[T], kept: int) -> list[T]:
        """All items, or in the quick matrix `kept` of them evenly spaced."""
        if not self.quick or len(items) <= kept:
            return list(items)
        return [items[round(i)] for i in np.linspace(0, len(items) - 1, kept)]

    def generator(self, salt: int) -> np.random.Generator:
        """Seeded random numbers, a stream of its own for each salt."""
        return np.random.default_rng([SEED, salt])

    def values(self, column: Column, layup: str = "BP", width: float = 15.0, /, **settings: float) -> Values:
        """PROPS by name for a material, temperature and layup, with what is given replaced."""
        return self.once(Subject._case_values, column, layup, width) | settings

    def _case_values(self, column: Column, layup: str, width: float) -> Values:
        return property_values(column.case(layup, width), self.scene()[1])

    def props(self, values: Mapping[str, float]) -> Array:
        """PROPS in the scene's order."""
        return np.array(props_vector(values, self.scene()[1]))

    def statev(self, locked: bool | Array = False, scene: str = "default") -> Array:
        """State variables of a start without history in a regime, or those given."""
        if isinstance(locked, np.ndarray):
            return locked
        statev = np.zeros(len(self.scene(scene)[1]["statev"]))
        statev[LOCKED] = float(locked)
        return statev

    def call(
        self,
        start: ArrayLike,
        end: ArrayLike,
        dt: float,
        values: Mapping[str, float],
        locked: bool | Array = False,
        scene: str = "default",
    ) -> CallResult:
        """Call the UMAT once and enter the answer in the account; `locked` as in `statev`."""
        before = np.arange(1.0, 7.0)
        ends = (np.array(start, dtype=float), np.array(end, dtype=float))
        library, _ = self.scene(scene)
        statev = self.statev(locked, scene)
        result = library.call(*ends, dt, self.props(values), statev, before)
        self.ledger.audit_call(result, ends, values, before, statev)
        return result

    def drive(self, values: Values, steps: Sequence[Step], controls: Controls, scene: str = "default") -> Run:
        """Run a programme and enter it in the account."""
        library, manifest = self.scene(scene)
        history = drive(library, self.props(values), len(manifest["statev"]), steps, controls)
        self.ledger.audit_history(history, values)
        return Run(values, history)

    def drive_case(self, case: Case, values: Values, scene: str = "default", controls: Controls | None = None) -> Run:
        """Run the load programme of a case, with the increments of the demo unless told."""
        return self.drive(values, driver_steps(case.load_programme), controls or case_controls(), scene)


def plate(value: float, duration: float, driven: bool = False, instant: bool = False) -> Step:
    """Step with the fibre held and the edge free under a pressure [MPa], or with the plate driven to a position F33."""
    kinds = {**PLY_KINDS, "33": "F"} if driven else PLY_KINDS
    return Step(duration, {**NOTHING, "11": 1.0, "33": value}, kinds, instant)
