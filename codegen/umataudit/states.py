"""Random admissible states for the comparison with machine code, and the chain of block calls at each of them."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath as mp

from umataudit.numbers import WORKING_DIGITS, Number, Value, invariants, rounded
from umataudit.printed.tables import COLUMNS
from umataudit.stress_blocks import REFERENCES as TO_THE_STRESS
from umataudit.stress_blocks import Inputs, Outputs, Reference
from umataudit.tangent_blocks import REFERENCES as OF_THE_TANGENT

Manifest = Mapping[str, Any]
_LETTERS = {"k": "k_gap", "a": "a_rate", "E_L": "e_l", "E_T": "e_t", "nu_LT": "nu_lt", "nu_TT": "nu_tt", "G_LT": "g_lt"}
_CLEAR = 0.003
PROPERTIES = {
    "w0": (10.0, 30.0), "h0": (0.1, 0.7), "l0_over_d": (3000.0, 5000.0), "eps_lock": (-0.1, -0.05),
    "chi_ratio": (0.65, 0.75), "e_l": (20.0, 30.0), "e_t": (0.5, 2.0), "nu_lt": (0.05, 0.3), "nu_tt": (0.1, 0.4),
    "g_lt": (0.5, 2.0), "kappa": (1.0e2, 1.0e4), "rate_floor": (1.0e-12, 1.0e-9), "strain_floor": (1.0e-13, 1.0e-11),
}  # fmt: skip
_REFERENCES = TO_THE_STRESS | OF_THE_TANGENT


class SceneNotComparableError(ValueError):
    """The blocks of a scene have no registered equations; says why."""


class UnknownBlockError(KeyError):
    """An emitted block has no registered equations."""


@dataclass(frozen=True)
class BlockCall:
    """One call of an emitted block.

    Parameters
    ----------
    name, equation : of the block, from the manifest.
    inputs : in the order of the argument list; double-precision numbers held exactly.
    expected : outputs in the order of the argument list, 30 digits.
    """

    name: str
    equation: str
    inputs: Inputs
    expected: Outputs


@dataclass(frozen=True)
class State:
    """Deformation gradients (3x3), time increment and constants; `flow` is the stage of flow."""

    f0: Value
    f1: Value
    dt: Number
    properties: Mapping[str, Number]
    flow: str

    @property
    def given(self) -> dict[str, Value]:
        """What the point routine knows before its blocks, and the choices it makes between them, by symbol name."""
        p, squeezing = self.properties, self.flow == "squeeze"
        return {
            "f0": self.f0, "f1": self.f1, "dt_rate": self.dt, "per_time": 1 / self.dt, **p,
            "widening": mp.mpf(1 if squeezing else "1.03125"),  # as in an increment that passes the lock
            "b_log": p["b_squeeze"] if squeezing else p["b_bleed"],
            "kappa_eff": p["kappa"] if squeezing else mp.mpf(0),
            "p_start": mp.mpf("0.25") if squeezing else mp.mpf(0),
            "j2_floor": max(p["rate_floor"], p["strain_floor"] / self.dt) ** 2,
        }  # fmt: skip


def random_states(manifest: Manifest, count: int) -> list[State]:
    """`count` states, squeezing and bleeding in turn, the same on every run.

    Raises
    ------
    SceneNotComparableError
        The scene's blocks have no registered equations.

    Notes
    -----
    Stretches around 1 along the fibre and compaction by a few percent; shears up to 0.1, or 0.02 where the printed
    invariants must be real.
    """
    scene = manifest["scene"]
    if reason := not_comparable(scene):
        raise SceneNotComparableError(reason)
    source = random.Random(f"states/{manifest['name']}")
    shear = 0.02 if scene.get("compaction") == "printed" else 0.1
    kept = scene.get("regimes", "both")
    flows = ("squeeze", "bleed") if kept == "both" else (kept,)
    baked = {property_symbol(name): float(value) for name, value in scene.get("baked", ())}
    states: list[State] = []
    while len(states) < count:
        state = _state(source, shear, flows[len(states) % len(flows)], baked)
        if _on_its_side_of_the_lock(state):
            states.append(state)
    return states


def _on_its_side_of_the_lock(state: State) -> bool:
    """Whether both ends of the increment lie clearly before (squeeze) or after (bleed) the lock."""
    strains = [mp.log(invariants(mp.matrix(f))["stretch"]) for f in (state.f0, state.f1)]
    distance = [strain - state.properties["eps_lock"] for strain in strains]
    return bool(min(distance) > _CLEAR if state.flow == "squeeze" else max(distance) < -_CLEAR)


def property_symbol(name: str) -> str:
    """Symbol name of a constant given by its name in the manifest."""
    return _LETTERS.get(name, name)


def not_comparable(scene: Mapping[str, Any]) -> str:
    """Why the blocks of a scene have no registered equations here; "" when they have."""
    said = f"scene '{scene.get('name')}' is not audited block by block: its"
    axes = (scene.get("fibre", "1"), scene.get("normal", "3"))
    if scene.get("stress_state", "3d") != "3d" or axes != ("1", "3"):
        return (
            f"{said} blocks are those of a three-dimensional scene with the fibre along axis 1 and the ply normal along "
            "axis 3, permuted or reduced; audit scene 'default'"
        )
    if scene.get("compaction") == "smallest":
        return f"{said} compaction is that of the smallest transverse stretch; audit scene 'default'"
    if scene.get("integrator", "bdf1") != "bdf1":
        return (
            f"{said} rate of C (integrator '{scene['integrator']}') "
            "rests on the last increment, the paper's on the present one alone; audit scene 'default'"
        )
    return ""


def _state(source: random.Random, shear: float, flow: str, baked: Mapping[str, float]) -> State:
    column = source.choice(COLUMNS)
    values = {name: source.uniform(*bounds) for name, bounds in PROPERTIES.items()}
    values |= {"k_gap": float(column.k), "a_rate": float(column.a)}
    values |= {"b_squeeze": float(column.b_squeeze), "b_bleed": float(column.b_bleed), **baked}
    middle = (1.0, 1.08, 0.97) if flow == "squeeze" else (1.0, 1.08, 0.90)
    f0 = [
        [middle[i] * (i == j) + source.uniform(-1, 1) * (shear / 4 if i == j else shear) for j in range(3)]
        for i in range(3)
    ]
    step = [[(i == j) + source.uniform(-1, 1) * 1e-3 for j in range(3)] for i in range(3)]
    with mp.workdps(WORKING_DIGITS):
        end = rounded((mp.matrix(step) * mp.matrix(f0)).tolist())
        properties = {name: mp.mpf(value) for name, value in values.items()}
        return State(rounded(f0), end, mp.mpf(source.uniform(0.01, 10.0)), properties, flow)


def reference(name: str) -> Reference:
    """What a block must return: a function of its inputs and of the scene's kind of tangent.

    Raises
    ------
    UnknownBlockError
        Names the block.
    """
    if name not in _REFERENCES:
        raise UnknownBlockError(f"block '{name}' has no registered equations; add a reference in umataudit")
    return _REFERENCES[name]


def block_calls(manifest: Manifest, states: Sequence[State]) -> Iterator[BlockCall]:
    """All blocks of a scene at all states; what a block's equations give, rounded, is what later blocks are given."""
    kind = str(manifest["scene"]["tangent"])
    with mp.workdps(WORKING_DIGITS):
        for state in states:
            known = state.given | {name: rounded(state.given[name]) for name in ("j2_floor", "per_time")}
            other = "bleed" if state.flow == "squeeze" else "squeeze"
            for entry in (entry for entry in manifest["blocks"] if not entry["name"].endswith(other)):
                inputs = {name: known[name] for name in entry["inputs"]}
                outputs = reference(entry["name"])(inputs, kind)
                expected = {name: outputs[name] for name in entry["outputs"]}
                yield BlockCall(entry["name"], entry["equation"], inputs, expected)
                known |= {name: rounded(value) for name, value in outputs.items() if name not in inputs}
                known["j2_eff"] = rounded(known.get("j2", 0) + known["j2_floor"])
