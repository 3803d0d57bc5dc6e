"""What every group of cells works with: compiled scenes, materials, the account, and what is run on them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from plyflow.case.case import Case, property_values, props_vector
from plyflow.case.materials import known_materials
from plyflow.driver.drive import Controls, History, Step, drive
from plyflow.evidence.stability.ledger import Ledger
from plyflow.evidence.stability.tensors import Array
from plyflow.provenance import source_hash
from plyflow.umat import compile as compiling
from plyflow.umat.library import CallResult, QuadLibrary, UmatLibrary
from umatgen.scene import SCENES, Scene

N_STATEV = 8
LOCKED = 4
SEED = 20160301
FLOOR_SCENE = Scene(name="floor", first_tangent="floor")
ALL_SCENES = {**SCENES, FLOOR_SCENE.name: FLOOR_SCENE}
Values = dict[str, float]


@dataclass(frozen=True)
class Column:
    """One material [name] at one temperature [degC]."""

    material: str
    temperature: float

    @property
    def label(self) -> str:
        """Name of the column in the table."""
        return f"{self.material} {self.temperature:g}"


@dataclass(frozen=True)
class Compiled:
    """One scene ready to run."""

    library: UmatLibrary
    source: str
    manifest: dict[str, Any]


class Bench:
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
        self._edit = edit or (lambda source: source)
        self._compiled: dict[str, Compiled] = {}
        self._quad: dict[str, QuadLibrary] = {}
        self._values: dict[tuple[Column, str, float], Values] = {}

    def scene(self, name: str = "default") -> Compiled:
        """Generate, compile and load a scene, once."""
        if name not in self._compiled:
            source, manifest, _ = compiling.generate_cached(ALL_SCENES[name])
            source = self._edit(source)
            self._compiled[name] = Compiled(UmatLibrary(compiling.compile_umat(source)), source, manifest)
        return self._compiled[name]

    def quad(self, name: str = "default") -> QuadLibrary:
        """Compile the same source with every number in quadruple precision."""
        if name not in self._quad:
            path = compiling.compile_umat(self.scene(name).source, compiling.QUAD_FLAGS)
            self._quad[name] = QuadLibrary(path)
        return self._quad[name]

    def source_hashes(self) -> dict[str, str]:
        """SHA-256 of the source of every scene used so far."""
        return {name: source_hash(compiled.source) for name, compiled in sorted(self._compiled.items())}

    @property
    def columns(self) -> list[Column]:
        """Both materials at all temperatures of their tables."""
        return [
            Column(name, temperature)
            for name, material in known_materials().items()
            for temperature in material.table.temperature
        ]

    def few(self, items: Sequence[Any], kept: int) -> list[Any]:
        """All items, or in the quick matrix `kept` of them evenly spaced."""
        if not self.quick or len(items) <= kept:
            return list(items)
        return [items[round(i)] for i in np.linspace(0, len(items) - 1, kept)]

    def generator(self, salt: int) -> np.random.Generator:
        """Seeded random numbers, a stream of its own for each salt."""
        return np.random.default_rng([SEED, salt])

    def values(self, column: Column, layup: str = "BP", width: float = 15.0, /, **settings: float) -> Values:
        """PROPS by name for a material, temperature and layup, with what is given replaced."""
        key = (column, layup, width)
        if key not in self._values:
            case = Case(column.material, column.temperature, layup, width)
            self._values[key] = property_values(case, self.scene().manifest)
        return self._values[key] | settings

    def props(self, values: Mapping[str, float]) -> Array:
        """PROPS in the scene's order."""
        return np.array(props_vector(values, self.scene().manifest))

    def call(
        self,
        start: ArrayLike,
        end: ArrayLike,
        dt: float,
        values: Mapping[str, float],
        locked: bool | Array = False,
        scene: str = "default",
    ) -> CallResult:
        """Call the UMAT once and enter the answer in the account.

        `locked` is the regime of a start without history, or the state variables at the start.
        """
        statev = locked if isinstance(locked, np.ndarray) else statev_at_start(locked)
        before = np.arange(1.0, 7.0)
        ends = (np.array(start, dtype=float), np.array(end, dtype=float))
        result = self.scene(scene).library.call(*ends, dt, self.props(values), statev, before)
        self.ledger.audit_call(result, ends, values, before)
        return result

    def drive(
        self,
        values: Mapping[str, float],
        steps: Sequence[Step],
        controls: Controls,
        scene: str = "default",
        **start: Any,
    ) -> History:
        """Run a programme and enter it in the account."""
        compiled = self.scene(scene)
        history = drive(
            compiled.library, self.props(values), len(compiled.manifest["statev"]), steps, controls, **start
        )
        self.ledger.audit_history(history, values)
        return history


def statev_at_start(locked: bool) -> Array:
    """State variables of a start without history, (8,)."""
    statev = np.zeros(N_STATEV)
    statev[LOCKED] = float(locked)
    return statev
