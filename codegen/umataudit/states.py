"""Random admissible states for the comparison with machine code, and the chain of block calls at each of them."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath as mp

from umataudit.blocks import Inputs, Outputs, reference
from umataudit.numbers import WORKING_DIGITS, Number, Value, product, rounded
from umataudit.printed.tables import COLUMNS

Manifest = Mapping[str, Any]
_LETTERS = {"k": "k_gap", "a": "a_rate", "E_L": "e_l", "E_T": "e_t", "nu_LT": "nu_lt", "nu_TT": "nu_tt", "G_LT": "g_lt"}
_CLEAR = 0.003
PROPERTIES = {
    "w0": (10.0, 30.0), "h0": (0.1, 0.7), "l0_over_d": (3000.0, 5000.0), "eps_lock": (-0.1, -0.05),
    "chi_ratio": (0.65, 0.75), "e_l": (20.0, 30.0), "e_t": (0.5, 2.0), "nu_lt": (0.05, 0.3), "nu_tt": (0.1, 0.4),
    "g_lt": (0.5, 2.0), "kappa": (1.0e2, 1.0e4), "rate_floor": (1.0e-12, 1.0e-9), "strain_floor": (1.0e-13, 1.0e-11),
}  # fmt: skip


class SceneNotComparableError(ValueError):
    """The blocks of a scene have no registered equations; says why."""


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
    shear = 0.02 if scene.get("invariants") == "printed" else 0.1
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
    strains = [mp.log(reference("start")({"f0": f}, "")["x_start"]) / 2 for f in (state.f0, state.f1)]
    distance = [strain - state.properties["eps_lock"] for strain in strains]
    return bool(min(distance) > _CLEAR if state.flow == "squeeze" else max(distance) < -_CLEAR)


def property_symbol(name: str) -> str:
    """Symbol name of a constant given by its name in the manifest."""
    return _LETTERS.get(name, name)


def not_comparable(scene: Mapping[str, Any]) -> str:
    """Why the blocks of a scene have no registered equations here; "" when they have."""
    if scene.get("stress_state", "3d") != "3d" or scene.get("fibre", "1") != "1":
        return (
            f"scene '{scene.get('name')}' is not audited block by block: its blocks are those of a three-dimensional scene with "
            "the fibre along axis 1, permuted or reduced; audit scene 'default'"
        )
    if scene.get("integrator", "bdf1") != "bdf1":
        return (
            f"scene '{scene.get('name')}' is not audited block by block: its rate of C (integrator '{scene['integrator']}') "
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
        start = rounded([[mp.mpf(v) for v in row] for row in f0])
        end = rounded(product([[mp.mpf(v) for v in row] for row in step], start))
        properties = {name: mp.mpf(value) for name, value in values.items()}
        return State(start, end, mp.mpf(source.uniform(0.01, 10.0)), properties, flow)


def block_calls(manifest: Manifest, states: Sequence[State]) -> Iterator[BlockCall]:
    """All blocks of a scene at all states; what a block's equations give, rounded, is what later blocks are given."""
    kind = str(manifest["scene"]["tangent"])
    with mp.workdps(WORKING_DIGITS):
        for state in states:
            known = _given(state)
            for entry in manifest["blocks"]:
                if not _in_flow(entry["name"], state.flow, manifest):
                    continue
                inputs = {name: _lookup(known, name, entry["name"]) for name in entry["inputs"]}
                outputs = reference(entry["name"])(inputs, kind)
                expected = {name: outputs[name] for name in entry["outputs"]}
                yield BlockCall(entry["name"], entry["equation"], inputs, expected)
                fresh = {name: rounded(value) for name, value in outputs.items() if name not in inputs}
                _take_over(known, entry["name"], fresh)


def _in_flow(name: str, flow: str, manifest: Manifest) -> bool:
    """A block of the other stage of flow is left out, unless the scene blends them."""
    if manifest["scene"].get("lock") == "blend":
        return True
    other = "bleed" if flow == "squeeze" else "squeeze"
    return not name.endswith(other)


def _given(state: State) -> dict[str, Value]:
    """What the point routine knows before its blocks, and the choices it makes between them."""
    p = state.properties
    squeezing = state.flow == "squeeze"
    known: dict[str, Value] = {"f0": state.f0, "f1": state.f1, "dt": state.dt, **p}
    known["b_log"] = p["b_squeeze"] if squeezing else p["b_bleed"]
    known["kappa_eff"] = p["kappa"] if squeezing else mp.mpf(0)
    known["p_start"] = mp.mpf("0.25") if squeezing else mp.mpf(0)
    known |= {"s_lock": mp.mpf("0.375"), "ds_dstretch": mp.mpf(-12)}
    known["j2_floor"] = rounded(max(p["rate_floor"], p["strain_floor"] / state.dt) ** 2)
    return known


def _lookup(known: Mapping[str, Value], name: str, stage: str) -> Value:
    if name == "j2_eff":
        return rounded(known["j2"] + known["j2_floor"])
    if name == "b_log" and stage in {"squeeze", "bleed"}:
        return known[f"b_{stage}"]
    return known[name]


def _take_over(known: dict[str, Value], stage: str, outputs: Outputs) -> None:
    """Keep outputs under the names that later blocks use for them."""
    known |= outputs
    if stage in {"squeeze", "bleed"}:
        known[f"g_{stage}"] = outputs["g_visc"]
        known |= {f"dlng{stage[0]}_{n[5:]}": value for n, value in outputs.items() if n.startswith("dlng_")}
