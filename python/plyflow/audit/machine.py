"""Compiled blocks against the registered equations: each emitted procedure called by itself, and the UMAT as a whole."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from plyflow.errors import RunError
from plyflow.umat import compile as compiling
from plyflow.umat.library import CallResult, UmatLibrary
from umataudit import BlockCall, State, block_calls, property_symbol, random_states
from umataudit.whole import Whole, expected_call
from umatgen.scene import Scene

TOLERANCE = 1.0e-12
"""Largest relative difference that counts as agreement: rounding of a few hundred operations, with room."""
STATES, WHOLE_STATES = 12, 6
_SCALE = {"dlnq": 1.0}
"""Where a number all but cancels: what it counts against. The rate measure is 1 within some percent, its logarithm's slope small."""
Array = NDArray[np.float64]


@dataclass(frozen=True)
class BlockResult:
    """A block (or the whole UMAT) compared.

    Parameters
    ----------
    difference : largest relative difference over all states; of an array relative to its largest component.
    output : the output in which it occurs.
    calls : number of states.
    """

    name: str
    equation: str
    difference: float
    output: str
    calls: int

    @property
    def agrees(self) -> bool:
        """Whether machine code and registered equations agree to rounding."""
        return self.difference <= TOLERANCE


def compare_scene(scene: Scene) -> list[BlockResult]:
    """Generate a scene with callable blocks, compile it and compare every block; then the whole UMAT as shipped.

    Raises
    ------
    RunError
        The compiled library lacks a block.
    """
    source, manifest, _ = compiling.generate_cached(replace(scene, procedures="external"))
    shipped, its_manifest, _ = compiling.generate_cached(scene)
    return [*compare_blocks(source, manifest), compare_whole(shipped, its_manifest)]


def registered_calls(manifest: Mapping[str, Any]) -> list[BlockCall]:
    """Every block at every random state, with what it must return: from the registered equations alone."""
    return list(block_calls(manifest, random_states(manifest, STATES)))


def compare_blocks(
    source: str, manifest: Mapping[str, Any], calls: Sequence[BlockCall] | None = None
) -> list[BlockResult]:
    """Largest difference of each block of a source whose procedures are external.

    Parameters
    ----------
    source, manifest : what the generator gave.
    calls : what to call; by default `registered_calls` of the manifest.
    """
    library = ctypes.CDLL(str(compiling.compile_umat(source)))
    worst: dict[str, BlockResult] = {}
    for call in calls if calls is not None else registered_calls(manifest):
        known = worst.get(call.name, BlockResult(call.name, call.equation, 0.0, "", 0))
        found = _call_difference(library, f"pf_{manifest['name']}_{call.name}_", call)
        difference, output = found if found[0] >= known.difference else (known.difference, known.output)
        worst[call.name] = replace(known, difference=difference, output=output, calls=known.calls + 1)
    return list(worst.values())


def _call_difference(library: ctypes.CDLL, symbol: str, call: BlockCall) -> tuple[float, str]:
    """Largest relative difference of one call, and in which output; not a number counts as infinite."""
    try:
        procedure = getattr(library, symbol)
    except AttributeError as error:
        raise RunError(
            f"the compiled library has no procedure {symbol}; compile with procedures = 'external'"
        ) from error
    inputs = [_array(value) for value in call.inputs.values()]
    outputs = {name: np.zeros(_array(value).shape, order="F") for name, value in call.expected.items()}
    procedure(*(array.ctypes.data_as(ctypes.c_void_p) for array in (*inputs, *outputs.values())))
    differences = [(relative_difference(outputs[name], value, _SCALE.get(name, 0.0)), name) for name, value in call.expected.items()]
    return max(differences)


def _array(value: Any) -> Array:
    """Double-precision array in Fortran's order of a number or nested lists."""
    return np.array(value, dtype=np.float64, order="F")


def relative_difference(computed: Array, expected: Any, least: float = 0.0) -> float:
    """Largest difference over the largest expected component, or `least`, in 30 digits; infinite for what is not a number."""
    if not np.all(np.isfinite(computed)):
        return float("inf")
    wanted = np.array(expected, dtype=object)
    largest, scale = np.max(np.abs(wanted - computed.tolist())), max(least, np.max(np.abs(wanted)))
    return float(largest / scale) if scale else float(largest)


def compare_whole(source: str, manifest: Mapping[str, Any]) -> BlockResult:
    """Stress and DDSDDE of whole calls against the potentials, DDSDDE against differentiated stress."""
    library = UmatLibrary(compiling.compile_umat(source))
    worst = (0.0, "")
    for state in random_states(manifest, WHOLE_STATES):
        stress, tangent = expected_call(state, manifest["scene"])
        result = call(library, state, manifest)
        pairs = {"stress": (result.stress, stress)} | ({"ddsdde": (result.ddsdde, tangent)} if tangent else {})
        worst = max(worst, *((relative_difference(got, want), name) for name, (got, want) in pairs.items()))
    return BlockResult("umat", "8-10, 13-17", worst[0], worst[1], WHOLE_STATES)


def call(library: UmatLibrary, state: State, manifest: Mapping[str, Any]) -> CallResult:
    """The state as the UMAT gets it: a zero STATEV but for the stage of flow and what the last increment left."""
    props = [float(state.properties[property_symbol(entry["name"])]) for entry in manifest["props"]]
    left: dict[str, Any] = {"locked": state.flow == "bleed"}
    whole = Whole(state, manifest["scene"])
    if whole.stress_last is not None and state.past is not None:
        left |= {"mean_stress": whole.stress_last, "dt_last": state.past[1], "eps_rate": whole.eps_rate}
    statev = [float(left.get(entry["name"], 0.0)) for entry in manifest["statev"]]
    return library.call(
        _array(state.f0), _array(state.f1), float(state.dt), props, statev,
        temperature=state.temperature, ntens=manifest["ntens"], increment=1 if state.past is None else 2,
    )  # fmt: skip
